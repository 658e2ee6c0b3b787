//! The text of a document.

use super::bind;
use super::expand::{Function, Functions};
use super::network::{Element, Entry, Holds as Held, Network};
use super::shader::{Holds, Written};
use std::fmt::Write as _;

/// A document of one nodegraph, after the definitions that it uses and before the shaders that read it.
pub(super) fn document(
    name: &str,
    main: &Network,
    functions: &Functions,
    shaders: &[Written],
) -> String {
    let mut text = "<?xml version=\"1.0\"?>\n".to_owned();
    text += "<materialx version=\"1.39\" colorspace=\"lin_rec709\">\n";
    for function in &functions.all {
        definition(&mut text, function);
    }
    let name = bind::name(name);
    // What is called as a shader is may not be the nodegraph's name as well.
    let is_taken = shaders.iter().any(|shader| shader.name == name);
    let name = if is_taken {
        format!("{name}_graph")
    } else {
        name
    };
    if !main.outputs.is_empty() {
        graph(&mut text, &name, None, main);
    }
    for shader in shaders {
        material(&mut text, &name, main, shader);
    }
    text += "</materialx>\n";
    text
}

/// A shader with its displacement, and the material that it is of.
fn material(text: &mut String, graph: &str, main: &Network, shader: &Written) {
    let displacement = format!("{}_displacement", shader.name);
    let parts = [
        (
            &shader.name,
            shader.category.as_str(),
            "surfaceshader",
            &shader.inputs,
        ),
        (
            &displacement,
            "displacement",
            "displacementshader",
            &shader.displacement,
        ),
    ];
    let mut used = Vec::new();
    for (name, category, ty, inputs) in parts {
        if inputs.is_empty() && category == "displacement" {
            continue;
        }
        used.push((name, ty));
        line(
            text,
            1,
            &format!(
                "<{category}{}>",
                attributes(&[("name", name), ("type", ty)])
            ),
        );
        for (name, ty, holds) in inputs {
            let mut own = vec![("name", name.as_str())];
            match holds {
                Holds::Value(value) => own.extend([("type", ty.as_str()), ("value", value)]),
                Holds::Output(index) => {
                    let output = &main.outputs[*index];
                    own.extend([
                        ("type", ty.as_str()),
                        ("nodegraph", graph),
                        ("output", &output.name),
                    ]);
                }
            }
            line(text, 2, &format!("<input{} />", attributes(&own)));
        }
        line(text, 1, &format!("</{category}>"));
    }
    let name = format!("{}_material", shader.name);
    let own = [("name", name.as_str()), ("type", "material")];
    line(text, 1, &format!("<surfacematerial{}>", attributes(&own)));
    for (node, ty) in used {
        let own = [("name", ty), ("type", ty), ("nodename", node)];
        line(text, 2, &format!("<input{} />", attributes(&own)));
    }
    line(text, 1, "</surfacematerial>");
}

/// A node that the document defines itself.
fn definition(text: &mut String, function: &Function) {
    let (category, ty) = (&function.category, function.output.name());
    let named = format!("ND_{category}");
    line(
        text,
        1,
        &format!(
            "<nodedef{}>",
            attributes(&[
                ("name", &named),
                ("node", category),
                ("nodegroup", "procedural2d"),
            ])
        ),
    );
    for port in &function.ports {
        let count = port.ty.components();
        let zero = vec!["0"; count].join(", ");
        let holds = if port.surface {
            ("defaultgeomprop", "UV0")
        } else {
            ("value", zero.as_str())
        };
        let own = [
            ("name", port.name.as_str()),
            ("type", port.ty.name()),
            holds,
        ];
        line(text, 2, &format!("<input{} />", attributes(&own)));
    }
    line(
        text,
        2,
        &format!("<output{} />", attributes(&[("name", "out"), ("type", ty)])),
    );
    line(text, 1, "</nodedef>");
    graph(
        text,
        &format!("NG_{category}"),
        Some(&named),
        &function.body,
    );
}

fn graph(text: &mut String, name: &str, nodedef: Option<&str>, network: &Network) {
    let mut own = vec![("name", name)];
    own.extend(nodedef.map(|nodedef| ("nodedef", nodedef)));
    line(text, 1, &format!("<nodegraph{}>", attributes(&own)));
    for input in &network.inputs {
        entry(text, 2, "input", input);
    }
    for element in &network.elements {
        node(text, element);
    }
    for output in &network.outputs {
        entry(text, 2, "output", output);
    }
    line(text, 1, "</nodegraph>");
}

fn node(text: &mut String, element: &Element) {
    let mut own = vec![
        ("name", element.name.as_str()),
        ("type", element.ty.as_str()),
    ];
    own.extend(
        element
            .nodedef
            .as_deref()
            .map(|nodedef| ("nodedef", nodedef)),
    );
    let head = format!("<{}{}", element.category, attributes(&own));
    if element.entries.is_empty() {
        line(text, 2, &format!("{head} />"));
        return;
    }
    line(text, 2, &format!("{head}>"));
    for input in &element.entries {
        entry(text, 3, "input", input);
    }
    line(text, 2, &format!("</{}>", element.category));
}

fn entry(text: &mut String, depth: usize, tag: &str, entry: &Entry) {
    let holds = match &entry.holds {
        Held::Value(value) => ("value", value.as_str()),
        Held::Node(name) => ("nodename", name.as_str()),
        Held::Interface(name) => ("interfacename", name.as_str()),
    };
    let mut own = vec![
        ("name", entry.name.as_str()),
        ("type", entry.ty.as_str()),
        holds,
    ];
    own.extend(
        entry
            .attributes
            .iter()
            .map(|(key, value)| (*key, value.as_str())),
    );
    line(text, depth, &format!("<{tag}{} />", attributes(&own)));
}

fn line(text: &mut String, depth: usize, what: &str) {
    writeln!(text, "{:1$}{what}", "", 2 * depth).expect("a text grows");
}

fn attributes(pairs: &[(&str, &str)]) -> String {
    let mut text = String::new();
    for (key, value) in pairs {
        write!(text, " {key}=\"{}\"", escaped(value)).expect("a text grows");
    }
    text
}

/// Characters that XML does not take in an attribute as they are.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            '\n' => out += "&#10;",
            '\r' => out += "&#13;",
            '\t' => out += "&#9;",
            // Nothing else below the blank is a character of XML.
            c if c < ' ' || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    #[test]
    fn attributes_hold_any_text() {
        assert_eq!(
            super::escaped("a<\"&\">\n\u{1}"),
            "a&lt;&quot;&amp;&quot;&gt;&#10;\u{fffd}"
        );
    }
}
