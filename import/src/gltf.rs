//! glTF documents with `KHR_texture_procedurals`: MaterialX's nodes in JSON, where links are indices
//! and values are lists. They become the tree that MaterialX's own documents become.

use crate::build::Refusal;
use crate::element::{Element, Id, Tree};
use crate::json::{Content, Json};
use crate::materialx;
use crate::place::{Findings, Place, Source};
use crate::{Imported, Options};
use mipless_graph::Diagnostic;

/// The extension, and those that fix its nodes.
const EXTENSION: &str = "KHR_texture_procedurals";

/// Reads a document.
pub(crate) fn import(name: &str, text: &str, options: &Options<'_>) -> Imported {
    let mut findings = Findings::default();
    findings
        .sources
        .push(Source::new(name.to_owned(), text.to_owned()));
    let json = match Json::parse(text) {
        Ok(json) => json,
        Err((offset, refusal)) => {
            say(&mut findings, offset, "", &refusal);
            return Imported::nothing(findings);
        }
    };
    let mut reader = Reader {
        tree: Tree::new(),
        findings,
        json: &json,
    };
    reader.tree.get_mut(Tree::ROOT).set("version", "1.39");
    let Some(graphs) = json.at(&["extensions", EXTENSION, "procedurals"]) else {
        let message =
            format!("the document has no `{EXTENSION}`, so that there is no texture to read");
        let refusal = Refusal::new("import-empty", message);
        say(&mut reader.findings, json.offset, "", &refusal);
        return Imported::nothing(reader.findings);
    };
    let names = names(graphs.items(), "GRAPH");
    for (graph, name) in graphs.items().iter().zip(&names) {
        reader.graph(graph, name);
    }
    reader.materials(&names);
    materialx::of_tree(reader.tree, reader.findings, options)
}

fn say(findings: &mut Findings, offset: usize, path: &str, refusal: &Refusal) {
    let place = Place {
        file: 0,
        offset,
        path: path.to_owned(),
    };
    findings.say(
        &place,
        Diagnostic::error(refusal.code, refusal.message.clone()),
    );
}

/// The names of things in a list, each another one.
fn names(items: &[Json], nameless: &str) -> Vec<String> {
    let mut names: Vec<String> = Vec::with_capacity(items.len());
    let mut seen = rustc_hash::FxHashSet::default();
    for (index, item) in items.iter().enumerate() {
        let own = item
            .get("name")
            .and_then(Json::text)
            .filter(|name| !name.is_empty());
        let own = own.map_or_else(|| format!("{nameless}_{index}"), str::to_owned);
        let mut name = own.clone();
        let mut count = 1;
        while !seen.insert(name.clone()) {
            count += 1;
            name = format!("{own}_{count}");
        }
        names.push(name);
    }
    names
}

struct Reader<'a> {
    tree: Tree,
    findings: Findings,
    json: &'a Json,
}

impl Reader<'_> {
    fn add(&mut self, parent: Id, tag: &str, name: &str, ty: &str, at: &Json) -> Id {
        let element = Element {
            tag: tag.to_owned(),
            name: name.to_owned(),
            attributes: vec![("type".to_owned(), ty.to_owned())],
            offset: at.offset,
            ..Element::default()
        };
        self.tree.add(parent, element)
    }

    /// A procedural: a nodegraph.
    fn graph(&mut self, graph: &Json, name: &str) {
        let ty = text_of(graph, "type");
        let id = self.add(Tree::ROOT, "nodegraph", name, ty, graph);
        let nodes = graph.get("nodes").map_or(&[][..], Json::items);
        let names = names(nodes, "NODE");
        for (name, input) in members(graph, "inputs") {
            let ty = text_of(input, "type");
            let element = self.add(id, "input", name, ty, input);
            self.link(element, input, &names);
        }
        for (node, name) in nodes.iter().zip(&names) {
            let element = self.add(
                id,
                text_of(node, "nodetype"),
                name,
                text_of(node, "type"),
                node,
            );
            for (name, input) in members(node, "inputs") {
                let port = self.add(element, "input", name, text_of(input, "type"), input);
                self.link(port, input, &names);
            }
        }
        for (name, output) in members(graph, "outputs") {
            // An input and an output of a graph may have one name; they are found by their kind.
            let element = self.add(id, "output", name, text_of(output, "type"), output);
            self.link(element, output, &names);
        }
    }

    /// What an input or output holds or reads.
    fn link(&mut self, element: Id, at: &Json, names: &[String]) {
        if let Some(node) = at.get("node") {
            match node.index().and_then(|index| names.get(index)) {
                Some(name) => self.tree.get_mut(element).set("nodename", name),
                None => {
                    let refusal =
                        Refusal::new("import-reference", "there is no node of this index");
                    let path = self.tree.path(element);
                    say(&mut self.findings, node.offset, &path, &refusal);
                }
            }
        }
        if let Some(input) = at.get("input").and_then(Json::text) {
            self.tree.get_mut(element).set("interfacename", input);
        }
        if let Some(output) = at.get("output").and_then(Json::text) {
            self.tree.get_mut(element).set("output", output);
        }
        if let Some(value) = at.get("value") {
            let text = self.value(value);
            self.tree.get_mut(element).set("value", &text);
        }
        // A file is a texture of the document.
        if let Some(texture) = at.get("texture").and_then(Json::index) {
            let source = self
                .json
                .get("textures")
                .and_then(|textures| textures.items().get(texture)?.get("source")?.index());
            let image = source.and_then(|source| self.json.get("images")?.items().get(source));
            if let Some(uri) = image.and_then(|image| image.get("uri")?.text()) {
                self.tree.get_mut(element).set("value", uri);
            }
        }
        for key in ["colorspace", "unit", "unittype", "defaultgeomprop"] {
            if let Some(text) = at.get(key).and_then(Json::text) {
                self.tree.get_mut(element).set(key, text);
            }
        }
    }

    /// A value as MaterialX's documents write it.
    fn value(&self, value: &Json) -> String {
        match &value.value {
            Content::List(items) => {
                let parts: Vec<String> = items.iter().map(|item| self.scalar(item)).collect();
                parts.join(", ")
            }
            _ => self.scalar(value),
        }
    }

    fn scalar(&self, value: &Json) -> String {
        match &value.value {
            Content::Number(number) => number.to_string(),
            Content::Bool(flag) => flag.to_string(),
            Content::Text(text) => text.clone(),
            _ => String::new(),
        }
    }

    /// The materials that use procedurals, each as a shader that reads them.
    fn materials(&mut self, graphs: &[String]) {
        let materials = self.json.get("materials").map_or(&[][..], Json::items);
        let names = names(materials, "MATERIAL");
        for (material, name) in materials.iter().zip(&names) {
            let used = textures(material);
            if used.is_empty() {
                continue;
            }
            let shader = format!("{name}_shader");
            let id = self.add(Tree::ROOT, "gltf_pbr", &shader, "surfaceshader", material);
            for (port, texture) in used {
                let Some(at) = texture.at(&["extensions", EXTENSION]) else {
                    continue;
                };
                let graph = at
                    .get("index")
                    .and_then(Json::index)
                    .and_then(|i| graphs.get(i));
                let output = at.get("output").and_then(Json::text).unwrap_or("");
                let Some(graph) = graph else {
                    let message = "there is no procedural of this index";
                    let refusal = Refusal::new("import-reference", message);
                    say(&mut self.findings, at.offset, &format!("/{name}"), &refusal);
                    continue;
                };
                let element = self.tree.child(Tree::ROOT, graph);
                let ty = element.and_then(|graph| {
                    (self.tree.tagged(graph, "output"))
                        .find(|id| output.is_empty() || self.tree.get(*id).name == output)
                        .and_then(|id| self.tree.get(id).attribute("type").map(str::to_owned))
                });
                let input = self.add(id, "input", port, ty.as_deref().unwrap_or("color3"), at);
                self.tree.get_mut(input).set("nodegraph", graph);
                self.tree.get_mut(input).set("output", output);
            }
            // What the numbers of a picture are multiplied by.
            for (port, ty, keys) in FACTORS {
                if let Some(factor) = material.at(keys) {
                    let input = self.add(id, "input", port, ty, factor);
                    let value = match &factor.value {
                        Content::List(items) => {
                            let parts = items.iter().take(3).map(|item| self.scalar(item));
                            parts.collect::<Vec<_>>().join(", ")
                        }
                        _ => self.scalar(factor),
                    };
                    self.tree.get_mut(input).set("value", &value);
                }
            }
            let owner = self.add(Tree::ROOT, "surfacematerial", name, "material", material);
            let input = self.add(owner, "input", "surfaceshader", "surfaceshader", material);
            self.tree.get_mut(input).set("nodename", &shader);
        }
    }
}

/// The factors of a material, by the names that the shader has for them.
const FACTORS: [(&str, &str, &[&str]); 4] = [
    (
        "base_color_factor",
        "color3",
        &["pbrMetallicRoughness", "baseColorFactor"],
    ),
    (
        "metallic",
        "float",
        &["pbrMetallicRoughness", "metallicFactor"],
    ),
    (
        "roughness",
        "float",
        &["pbrMetallicRoughness", "roughnessFactor"],
    ),
    ("emissive_factor", "color3", &["emissiveFactor"]),
];

fn text_of<'a>(json: &'a Json, key: &str) -> &'a str {
    json.get(key).and_then(Json::text).unwrap_or("")
}

fn members<'a>(json: &'a Json, key: &str) -> &'a [(String, Json)] {
    json.get(key).map_or(&[], Json::members)
}

/// The textures of a material that are procedurals, by the names that `gltf_pbr` has for them.
fn textures(material: &Json) -> Vec<(&'static str, &Json)> {
    const TEXTURES: [(&str, &[&str]); 6] = [
        ("base_color", &["pbrMetallicRoughness", "baseColorTexture"]),
        (
            "metallic_roughness",
            &["pbrMetallicRoughness", "metallicRoughnessTexture"],
        ),
        ("normal", &["normalTexture"]),
        ("occlusion", &["occlusionTexture"]),
        ("emissive", &["emissiveTexture"]),
        (
            "clearcoat",
            &["extensions", "KHR_materials_clearcoat", "clearcoatTexture"],
        ),
    ];
    let found = TEXTURES.iter().filter_map(|(port, keys)| {
        let texture = material.at(keys)?;
        texture
            .at(&["extensions", EXTENSION])
            .map(|_| (*port, texture))
    });
    found.collect()
}
