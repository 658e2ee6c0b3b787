//! What a document is asked for: the inputs of the shaders of its materials, or, where it has no
//! material, the outputs of its nodegraphs.

use super::network::Network;
use crate::build::Refusal;
use crate::element::{Id, Tree};
use mipless_graph::{Diagnostic, Type};
use rustc_hash::FxHashSet;

/// An output of the graph that is to be.
#[derive(Clone, Debug)]
pub(crate) struct Root {
    pub(crate) name: String,
    /// The nodegraph that the element stands in, or the document.
    pub(crate) graph: Id,
    /// An `<input>` of a shader or an `<output>`.
    pub(crate) element: Id,
}

/// Types that shaders have and textures have not.
const OPAQUE: [&str; 12] = [
    "matrix33",
    "matrix44",
    "surfaceshader",
    "displacementshader",
    "volumeshader",
    "lightshader",
    "material",
    "BSDF",
    "EDF",
    "VDF",
    "multioutput",
    "none",
];

/// Everything that is asked for; `material` is the name of a material, a shader or a nodegraph.
pub(crate) fn find(
    network: &mut Network<'_>,
    material: Option<&str>,
) -> Result<Vec<Root>, Refusal> {
    let tree = &network.tree;
    let mut shaders: Vec<(Id, Id)> = Vec::new();
    let mut graphs: Vec<Id> = Vec::new();
    let is_wanted = |id: Id| material.is_none_or(|name| tree.get(id).name == name);
    for id in tree.children(Tree::ROOT) {
        match tree.get(id).tag.as_str() {
            "surfacematerial" | "volumematerial" if is_wanted(id) => {
                for input in tree.tagged(id, "input") {
                    shaders.extend(shader(tree, Tree::ROOT, input));
                }
            }
            "nodegraph" if material.is_some() && is_wanted(id) => graphs.push(id),
            _ => {}
        }
    }
    if let Some(name) = material
        && shaders.is_empty()
        && graphs.is_empty()
    {
        match tree.child(Tree::ROOT, name) {
            Some(id) => shaders.push((Tree::ROOT, id)),
            None => {
                let known: Vec<&str> = (tree.tagged(Tree::ROOT, "surfacematerial"))
                    .map(|id| tree.get(id).name.as_str())
                    .collect();
                let message = format!("there is no material `{name}`: {}", known.join(", "));
                return Err(Refusal::new("import-reference", message));
            }
        }
    }
    shaders.dedup();
    let mut seen = FxHashSet::default();
    shaders.retain(|shader| seen.insert(*shader));
    let several = shaders.len() > 1;
    let mut roots = Vec::new();
    let mut dropped = Vec::new();
    for (graph, id) in shaders {
        for input in tree.tagged(id, "input") {
            let element = tree.get(input);
            let own = &element.name;
            if !is_texture(element.attribute("type").unwrap_or("")) {
                dropped.push((input, format!("`{own}` of a shader is no texture")));
                continue;
            }
            roots.push(Root {
                name: if several {
                    format!("{}_{own}", tree.get(id).name)
                } else {
                    own.clone()
                },
                graph,
                element: input,
            });
        }
    }
    if roots.is_empty() && material.is_none() {
        graphs.extend(shown_graphs(tree));
    }
    let several = graphs.len() > 1;
    for graph in graphs {
        for output in tree.tagged(graph, "output") {
            let element = tree.get(output);
            if !is_texture(element.attribute("type").unwrap_or("")) {
                dropped.push((output, format!("`{}` is no texture", element.name)));
                continue;
            }
            roots.push(Root {
                name: if several && graph != Tree::ROOT {
                    format!("{}_{}", tree.get(graph).name, element.name)
                } else {
                    element.name.clone()
                },
                graph,
                element: output,
            });
        }
    }
    for (id, what) in dropped {
        let place = network.tree.place(id);
        let note = format!("{what} and is left out");
        network
            .findings
            .say(&place, Diagnostic::note("import-left-out", note));
    }
    distinct(&mut roots);
    Ok(roots)
}

/// Nodegraphs that show something by themselves, and the document if it has outputs. Functional ones
/// are shown where there is nothing else.
fn shown_graphs(tree: &Tree) -> Vec<Id> {
    let graphs = tree.tagged(Tree::ROOT, "nodegraph");
    let (plain, functional): (Vec<Id>, Vec<Id>) =
        graphs.partition(|id| tree.get(*id).attribute("nodedef").is_none());
    let document = tree.tagged(Tree::ROOT, "output").next().map(|_| Tree::ROOT);
    let shown: Vec<Id> = plain.into_iter().chain(document).collect();
    if shown.is_empty() { functional } else { shown }
}

/// The shader node that an input of a material, or of a shader, reads, and the graph it stands in.
fn shader(tree: &Tree, graph: Id, input: Id) -> Option<(Id, Id)> {
    let (mut graph, mut at) = (graph, input);
    for _ in 0..64 {
        let element = tree.get(at);
        if let Some(name) = element.attribute("nodegraph") {
            graph = tree.child(Tree::ROOT, name)?;
            let output = element.attribute("output");
            at = (tree.tagged(graph, "output"))
                .find(|id| output.is_none_or(|output| tree.get(*id).name == output))?;
            continue;
        }
        let node = tree.child(graph, element.attribute("nodename")?)?;
        return match tree.get(node).tag.as_str() {
            "nodegraph" => {
                graph = node;
                at = tree.tagged(graph, "output").next()?;
                continue;
            }
            "output" | "input" => {
                at = node;
                continue;
            }
            _ => Some((graph, node)),
        };
    }
    None
}

/// Whether a texture may be of that type; types of a document's own are refused where they are read.
fn is_texture(ty: &str) -> bool {
    !OPAQUE.contains(&ty) && Type::by_name(ty).is_none_or(|ty| ty.components() > 0)
}

/// Gives every output a name of its own.
fn distinct(roots: &mut [Root]) {
    let mut seen = FxHashSet::default();
    for root in roots {
        let wanted = root.name.replace([':', '/'], "_");
        let mut name = wanted.clone();
        let mut count = 1;
        while !seen.insert(name.clone()) {
            count += 1;
            name = format!("{wanted}_{count}");
        }
        root.name = name;
    }
}
