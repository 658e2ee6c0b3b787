//! The statistics of a checked graph for people and for tools.

use std::fmt;

use serde_json::{Map, Value, json};

use super::{Checked, Class};
use crate::NodeId;

impl Checked {
    /// The `signals` of `check --json`: for each node its `node`, `pointer`, `type`, `class` (with
    /// `deviation` or `gaussians`), `sources` (`sources_more` where there are more than are
    /// listed), `correlations`, `error` and `because`.
    pub fn signals_json(&self) -> Value {
        let ids = (0..self.graph.nodes.len()).map(|index| NodeId(index as u32));
        Value::Array(ids.map(|id| Value::Object(self.signal_json(id))).collect())
    }

    fn signal_json(&self, id: NodeId) -> Map<String, Value> {
        let node = self.graph.node(id);
        let signal = self.signal(id);
        let mut json = Map::new();
        json.insert("node".to_owned(), node.name.clone().into());
        json.insert("pointer".to_owned(), node.pointer.clone().into());
        json.insert("type".to_owned(), node.ty.name().into());
        json.insert("class".to_owned(), signal.class.name().into());
        match signal.class {
            Class::Gaussian { deviation } | Class::Moments { deviation } => {
                json.insert("deviation".to_owned(), shortest(deviation));
            }
            Class::Function { gaussians } => {
                json.insert("gaussians".to_owned(), gaussians.into());
            }
            Class::Constant | Class::Unknown => {}
        }
        json.insert("sources".to_owned(), self.source_names(id).into());
        if signal.sources.more() {
            json.insert("sources_more".to_owned(), true.into());
        }
        let correlations = signal.correlations.iter().map(|correlation| {
            let source = self.source_name(correlation.source);
            json!({ "inputs": [correlation.first, correlation.second], "source": source })
        });
        json.insert("correlations".to_owned(), correlations.collect());
        json.insert("error".to_owned(), shortest(signal.error));
        json.insert("because".to_owned(), self.because(id).into());
        json
    }

    fn source_name(&self, source: Option<NodeId>) -> &str {
        source.map_or("(position)", |source| &self.graph.node(source).name)
    }

    fn source_names(&self, id: NodeId) -> Vec<&str> {
        let sources = &self.signal(id).sources;
        let nodes = sources
            .nodes()
            .iter()
            .map(|node| self.source_name(Some(*node)));
        nodes
            .chain(sources.position().then_some("(position)"))
            .collect()
    }

    /// The text of `check`, one paragraph a signal.
    pub fn report(&self) -> impl fmt::Display + '_ {
        Report(self)
    }
}

/// The decimal number with the fewest digits that is this f32, as f64 of the same digits.
fn shortest(number: f32) -> Value {
    number
        .to_string()
        .parse::<f64>()
        .map_or(Value::Null, Value::from)
}

struct Report<'a>(&'a Checked);

impl fmt::Display for Report<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let checked = self.0;
        for (index, (node, signal)) in checked.graph.nodes.iter().zip(&checked.signals).enumerate()
        {
            let id = NodeId(index as u32);
            writeln!(
                f,
                "{} ({}, {}): {}",
                node.name, node.spec.name, node.ty, signal.class
            )?;
            for reason in checked.because(id) {
                writeln!(f, "  because {reason}")?;
            }
            let names = checked.source_names(id);
            if !names.is_empty() {
                let more = if signal.sources.more() { ", …" } else { "" };
                writeln!(f, "  sources: {}{more}", names.join(", "))?;
            }
            for correlation in &signal.correlations {
                let source = checked.source_name(correlation.source);
                let (first, second) = (correlation.first, correlation.second);
                writeln!(
                    f,
                    "  carries cov({first}, {second}): both depend on {source}"
                )?;
            }
            if signal.error > 0.0 {
                writeln!(f, "  predicted closure error: {:.3} RMS", signal.error)?;
            }
        }
        Ok(())
    }
}

impl fmt::Display for Class {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Constant => f.write_str("constant"),
            Self::Gaussian { deviation: 0.0 } => f.write_str("gaussian"),
            Self::Gaussian { deviation } => write!(f, "gaussian, deviation {deviation}"),
            Self::Function { gaussians: 0 } => f.write_str("pattern of position, closed form"),
            Self::Function { gaussians: 1 } => f.write_str("function of 1 gaussian"),
            Self::Function { gaussians } => write!(f, "function of {gaussians} gaussians"),
            Self::Moments { deviation } => write!(f, "moments only, deviation about {deviation}"),
            Self::Unknown => f.write_str("unknown"),
        }
    }
}
