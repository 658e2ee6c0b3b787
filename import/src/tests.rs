//! What the tables say is of their language, and names what is there.

use crate::rule::{Expr, Rules};

/// Every expression inside of one.
fn inside<'e>(expr: &'e Expr, found: &mut Vec<&'e Expr>) {
    found.push(expr);
    match expr {
        Expr::Port(_, Some(at)) => inside(at, found),
        Expr::List(items) => items.iter().for_each(|item| inside(item, found)),
        Expr::Negated(inner) => inside(inner, found),
        Expr::Binary(_, left, right) => {
            inside(left, found);
            inside(right, found);
        }
        Expr::Call { arguments, .. } => {
            arguments
                .iter()
                .for_each(|(_, argument)| inside(argument, found));
        }
        _ => {}
    }
}

/// The parts of Material Maker's rules that read each other.
#[test]
fn no_part_of_a_rule_reads_itself() {
    let rules = Rules::parse(include_str!("materialmaker/rules.txt"));
    for (name, _) in rules.iter() {
        let Some((kind, _)) = name.split_once('.') else {
            continue;
        };
        // Following the parts must end within as many steps as there are rules.
        let mut open = vec![name.clone()];
        let mut steps = 0;
        while let Some(part) = open.pop() {
            steps += 1;
            assert!(steps < 2_000, "`{name}` reads itself");
            let Some(expr) = rules.get(&part) else {
                continue;
            };
            let mut found = Vec::new();
            inside(expr, &mut found);
            for expr in found {
                if let Expr::Port(port, _) = expr {
                    open.push(format!("{kind}.{port}"));
                }
            }
        }
    }
}

/// Words of the language, which are no nodes.
const WORDS: [&str; 20] = [
    "alpha",
    "as",
    "case",
    "channel",
    "determinant",
    "each",
    "entry",
    "fold",
    "given",
    "index",
    "input",
    "invertmatrix",
    "note",
    "part",
    "period",
    "pow",
    "refuse",
    "rgb",
    "rgba",
    "seed",
];
const MORE_WORDS: [&str; 5] = ["space", "sum", "toolseed", "transpose", "type"];

/// The schema of graphs lists every node with its inputs.
#[test]
fn rules_make_nodes_that_are_there_with_inputs_that_they_have() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../graph/graph.schema.json");
    let text = std::fs::read_to_string(path).expect("the schema stands beside the crate");
    let schema: serde_json::Value = serde_json::from_str(&text).expect("the schema is JSON");
    for text in [
        include_str!("materialx/rules.txt"),
        include_str!("materialmaker/rules.txt"),
    ] {
        for (name, rule) in Rules::parse(text).iter() {
            let mut found = Vec::new();
            inside(rule, &mut found);
            for expr in found {
                let Expr::Call {
                    name: node,
                    arguments,
                    ..
                } = expr
                else {
                    continue;
                };
                let is_word = WORDS.contains(&node.as_str()) || MORE_WORDS.contains(&node.as_str());
                let unnamed = arguments.iter().any(|(key, _)| key.is_none());
                if is_word || unnamed {
                    continue;
                }
                let spec = &schema["$defs"][format!("node.{node}")]["properties"];
                assert!(
                    spec.is_object(),
                    "`{name}` makes `{node}`, which is not there"
                );
                for (port, _) in arguments {
                    let port = port.as_deref().unwrap_or("");
                    let ports = &spec["inputs"]["properties"];
                    assert!(
                        ports[port].is_object(),
                        "`{name}`: `{node}` has no `{port}`"
                    );
                }
            }
        }
    }
}

#[test]
fn every_refusal_has_a_known_code() {
    for text in [
        include_str!("materialx/rules.txt"),
        include_str!("materialmaker/rules.txt"),
    ] {
        let rules = Rules::parse(text);
        for (name, rule) in rules.iter() {
            let mut found = Vec::new();
            inside(rule, &mut found);
            for expr in found {
                if let Expr::Call {
                    name: word,
                    arguments,
                    ..
                } = expr
                    && word == "refuse"
                {
                    let Some((_, Expr::Text(code))) = arguments.first() else {
                        panic!("`{name}` refuses without a code");
                    };
                    assert!(
                        crate::eval::REFUSALS.contains(&code.as_str()),
                        "{name}: {code}"
                    );
                }
            }
        }
    }
}
