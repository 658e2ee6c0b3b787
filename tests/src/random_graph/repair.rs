//! Random graphs without mistakes: what the check refuses is replaced by what it accepts.

use crate::case::load;
use mipless::{Diagnostic, Texture};
use serde_json::{Value, json};

/// After so many turns a graph is given up.
const TURNS: usize = 24;

/// The graph with its mistakes repaired, and what it was loaded to; `None` if that does not succeed.
pub fn repaired(mut graph: Value) -> Option<(Value, Texture)> {
    for turn in 0..TURNS {
        match load(&graph.to_string()) {
            Ok(texture) => return Some((graph, texture)),
            Err(mistakes) => {
                let mistakes = mistakes.iter().filter(|mistake| mistake.is_error());
                for mistake in mistakes {
                    repair(&mut graph, mistake, turn);
                }
            }
        }
    }
    None
}

/// Takes away the connection that a mistake is about; where it is about a node, the connections of
/// the node, and if that was not enough, all that is said of it.
fn repair(graph: &mut Value, mistake: &Diagnostic, turn: usize) {
    let Some(pointer) = &mistake.pointer else {
        return;
    };
    if let Some((inputs, port)) = pointer.rsplit_once('/')
        && inputs.ends_with("/inputs")
        && let Some(Value::Object(inputs)) = graph.pointer_mut(inputs)
        && inputs.shift_remove(port).is_some()
    {
        return;
    }
    let is_at = |node: &Value| node.get("type").is_some_and(Value::is_string);
    let mut place = pointer.as_str();
    while !graph.pointer(place).is_some_and(is_at) {
        let Some((outer, _)) = place.rsplit_once('/') else {
            return;
        };
        place = outer;
    }
    let node = graph.pointer_mut(place).expect("it was just found");
    let Some(Value::Object(inputs)) = node.get_mut("inputs") else {
        *node = json!({ "type": "constant", "inputs": { "value": 0.5 } });
        return;
    };
    let count = inputs.len();
    inputs.retain(|_, input| input.get("node").is_none());
    if inputs.len() == count {
        if turn < TURNS / 2 && count > 0 {
            inputs.clear();
        } else {
            *node = json!({ "type": "constant", "inputs": { "value": 0.5 } });
        }
    }
}
