//! From MaterialX 1.38 to 1.39: what the last step of MaterialX's own upgrade does to nodes that a
//! texture can have.

use crate::element::{Element, Id, Tree};

/// Inputs that are called otherwise: the node, the old name and the new one.
const RENAMED: [(&str, &str, &str); 2] = [("atan2", "in1", "iny"), ("atan2", "in2", "inx")];

/// Rewrites a document of 1.38.
pub(super) fn upgrade(tree: &mut Tree) {
    // What is added is new already.
    let count = tree.elements.len();
    for index in 0..count {
        let id = Id(u32::try_from(index).unwrap_or(u32::MAX));
        if tree.get(id).attribute("channels").is_some() {
            channels(tree, id);
        }
    }
    for index in 0..count {
        let id = Id(u32::try_from(index).unwrap_or(u32::MAX));
        let tag = tree.get(id).tag.clone();
        for (_, old, new) in RENAMED.iter().filter(|(node, ..)| *node == tag) {
            if let Some(input) = tree.input(id, old) {
                tree.rename_input(id, input, new);
            }
        }
        match tag.as_str() {
            "swizzle" => swizzle(tree, id),
            "switch" => small_choice(tree, id),
            "normalmap" => object_space(tree, id),
            _ => {}
        }
    }
}

/// `which` of five inputs: a literal beyond them meant the first.
fn small_choice(tree: &mut Tree, id: Id) {
    let Some(which) = tree.input(id, "which") else {
        return;
    };
    let value = tree.get(which).attribute("value");
    let beyond = value
        .and_then(|value| value.trim().parse::<f64>().ok())
        .is_some_and(|x| x >= 5.0);
    if beyond {
        tree.get_mut(which).set("value", "0");
    }
}

/// A normal map in object space is only unpacked.
fn object_space(tree: &mut Tree, id: Id) {
    let Some(space) = tree.input(id, "space") else {
        return;
    };
    let is_object = tree.get(space).attribute("value") == Some("object");
    tree.rename_input(id, space, "space_of_1_38");
    if !is_object {
        return;
    }
    let Some(graph) = tree.get(id).parent else {
        return;
    };
    let name = tree.get(id).name.clone();
    let doubled = node_like(
        tree,
        graph,
        id,
        "multiply",
        "vector3",
        &format!("{name}__doubled"),
    );
    if let Some(source) = tree.input(id, "in") {
        copy_input(tree, source, doubled, "in1", "vector3");
    }
    literal_input(tree, doubled, "in2", "float", "2");
    let moved = node_like(
        tree,
        graph,
        id,
        "subtract",
        "vector3",
        &format!("{name}__moved"),
    );
    linked_input(tree, moved, "in1", "vector3", &format!("{name}__doubled"));
    literal_input(tree, moved, "in2", "float", "1");
    let node = tree.get_mut(id);
    "normalize".clone_into(&mut node.tag);
    node.remove("nodedef");
    tree.clear(id);
    linked_input(tree, id, "in", "vector3", &format!("{name}__moved"));
}

/// An input or output with `channels` reads a `swizzle` of its own.
fn channels(tree: &mut Tree, id: Id) {
    let element = tree.get(id).clone();
    let Some(channels) = element.attribute("channels").map(str::to_owned) else {
        return;
    };
    tree.get_mut(id).remove("channels");
    let to = element.attribute("type").unwrap_or("float").to_owned();
    // The graph that the node of the input, or the output, stands in.
    let owner = match element.tag.as_str() {
        "input" => element.parent.and_then(|node| tree.get(node).parent),
        _ => element.parent,
    };
    let Some(graph) = owner else {
        return;
    };
    let upstream = element
        .attribute("nodename")
        .and_then(|name| tree.child(graph, name));
    let from = upstream.and_then(|node| tree.get(node).attribute("type").map(str::to_owned));
    let from = match from.as_deref() {
        Some(from) if from != "multioutput" => from.to_owned(),
        _ => guessed(&channels, &to).to_owned(),
    };
    if from == "float" && to == "float" {
        return;
    }
    let name = format!(
        "{}_{}__swizzle",
        element
            .parent
            .map_or("", |parent| tree.get(parent).name.as_str()),
        element.name
    );
    let swizzle = node_like(tree, graph, id, "swizzle", &to, &name);
    copy_input(tree, id, swizzle, "in", &from);
    literal_input(tree, swizzle, "channels", "string", &channels);
    self::swizzle(tree, swizzle);
    let element = tree.get_mut(id);
    for key in ["output", "interfacename", "nodegraph"] {
        element.remove(key);
    }
    element.set("nodename", &name);
}

/// The type that is read where the document does not say.
fn guessed(channels: &str, to: &str) -> &'static str {
    match channels {
        "xx" | "xxx" | "xxxx" => "float",
        "xyz" | "x" | "y" | "z" => "vector3",
        "rgba" | "a" => "color4",
        _ if to == "color3" => "color4",
        _ => "color3",
    }
}

/// A `swizzle` becomes an `extract`, or a combination of them.
fn swizzle(tree: &mut Tree, id: Id) {
    let element = tree.get(id);
    let to = element.attribute("type").unwrap_or("float").to_owned();
    let (name, parent) = (element.name.clone(), element.parent);
    let (Some(graph), Some(count)) = (parent, components(&to)) else {
        return;
    };
    let source = tree.input(id, "in");
    let channels = (tree.input(id, "channels"))
        .and_then(|input| tree.get(input).attribute("value").map(str::to_owned))
        .unwrap_or_default();
    let from = source.and_then(|source| tree.get(source).attribute("type").map(str::to_owned));
    let from = from.unwrap_or_else(|| "float".to_owned());
    tree.clear(id);
    tree.get_mut(id).remove("nodedef");
    let index = |i: usize| match channels.chars().nth(i) {
        Some('0') => Err("0"),
        Some('1') => Err("1"),
        Some('g' | 'y') => Ok(1),
        Some('b' | 'z') => Ok(2),
        Some('a' | 'w') => Ok(3),
        _ => Ok(0),
    };
    if count == 1 {
        match (index(0), source) {
            (Err(value), _) => constant(tree, id, value),
            (Ok(_), None) => constant(tree, id, "0"),
            (Ok(_), Some(source)) if from == "float" => {
                tree.get_mut(id).tag = "dot".to_owned();
                copy_input(tree, source, id, "in", &from);
            }
            (Ok(index), Some(source)) => {
                tree.get_mut(id).tag = "extract".to_owned();
                copy_input(tree, source, id, "in", &from);
                literal_input(tree, id, "index", "integer", &index.to_string());
            }
        }
        return;
    }
    tree.get_mut(id).tag = format!("combine{count}");
    for i in 0..count {
        let port = format!("in{}", i + 1);
        match (index(i), source) {
            (Err(value), _) => literal_input(tree, id, &port, "float", value),
            (Ok(_), None) => literal_input(tree, id, &port, "float", "0"),
            (Ok(_), Some(source)) if from == "float" => {
                copy_input(tree, source, id, &port, "float");
            }
            (Ok(index), Some(source)) => {
                let part = format!("{name}__part{index}");
                if tree.child(graph, &part).is_none() {
                    let extract = node_like(tree, graph, id, "extract", "float", &part);
                    copy_input(tree, source, extract, "in", &from);
                    literal_input(tree, extract, "index", "integer", &index.to_string());
                }
                linked_input(tree, id, &port, "float", &part);
            }
        }
    }
}

fn components(ty: &str) -> Option<usize> {
    mipless_graph::Type::by_name(ty)
        .map(mipless_graph::Type::components)
        .filter(|count| *count > 0)
}

fn constant(tree: &mut Tree, id: Id, value: &str) {
    tree.get_mut(id).tag = "constant".to_owned();
    literal_input(tree, id, "value", "float", value);
}

/// A new node that stands where another one does.
fn node_like(tree: &mut Tree, graph: Id, like: Id, tag: &str, ty: &str, name: &str) -> Id {
    let (file, offset) = (tree.get(like).file, tree.get(like).offset);
    let element = Element {
        tag: tag.to_owned(),
        name: name.to_owned(),
        attributes: vec![
            ("name".to_owned(), name.to_owned()),
            ("type".to_owned(), ty.to_owned()),
        ],
        file,
        offset,
        ..Element::default()
    };
    tree.add(graph, element)
}

fn input_like(tree: &Tree, like: Id, name: &str, ty: &str) -> Element {
    let like = tree.get(like);
    Element {
        tag: "input".to_owned(),
        name: name.to_owned(),
        attributes: vec![
            ("name".to_owned(), name.to_owned()),
            ("type".to_owned(), ty.to_owned()),
        ],
        file: like.file,
        offset: like.offset,
        ..Element::default()
    }
}

/// An input that reads what another one reads.
fn copy_input(tree: &mut Tree, source: Id, node: Id, name: &str, ty: &str) {
    let mut element = input_like(tree, source, name, ty);
    for key in [
        "value",
        "nodename",
        "nodegraph",
        "interfacename",
        "output",
        "colorspace",
        "unit",
    ] {
        if let Some(value) = tree.get(source).attribute(key) {
            element.set(key, value);
        }
    }
    tree.add(node, element);
}

fn literal_input(tree: &mut Tree, node: Id, name: &str, ty: &str, value: &str) {
    let mut element = input_like(tree, node, name, ty);
    element.set("value", value);
    tree.add(node, element);
}

fn linked_input(tree: &mut Tree, node: Id, name: &str, ty: &str, to: &str) {
    let mut element = input_like(tree, node, name, ty);
    element.set("nodename", to);
    tree.add(node, element);
}
