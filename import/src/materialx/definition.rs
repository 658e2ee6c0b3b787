//! Node definitions: what inputs and outputs a node has, with which types and defaults. Those of
//! MaterialX's own nodes are a table; a document adds its own.

use crate::element::{Id, Tree};
use rustc_hash::FxHashMap;
use std::sync::OnceLock;

/// The signatures and defaults of MaterialX 1.39's standard nodes, one a line:
/// `NAME node input:type=default@geometric-default … -> output:type …`. One number stands for equal
/// components.
const STANDARD: &str = include_str!("definitions.txt");

/// An input of a definition.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Input {
    pub(crate) name: String,
    pub(crate) ty: String,
    pub(crate) value: Option<String>,
    /// What of the surface it reads where nothing is connected.
    pub(crate) geometric: Option<String>,
    /// Where a document declares it.
    pub(crate) element: Option<Id>,
}

/// A definition.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Definition {
    pub(crate) name: String,
    pub(crate) node: String,
    pub(crate) inputs: Vec<Input>,
    /// Names and types.
    pub(crate) outputs: Vec<(String, String)>,
    pub(crate) version: Option<String>,
    pub(crate) is_default_version: bool,
    /// The element `nodedef`, of those that stand in a document.
    pub(crate) element: Option<Id>,
}

impl Definition {
    pub(crate) fn input(&self, name: &str) -> Option<&Input> {
        self.inputs.iter().find(|input| input.name == name)
    }

    /// The type that a node of it says it has.
    fn ty(&self) -> &str {
        match self.outputs.as_slice() {
            [(_, ty)] => ty,
            _ => "multioutput",
        }
    }

    /// The output of a name, or the first where none is named.
    pub(crate) fn output(&self, name: &str) -> Option<(&str, &str)> {
        let found = self.outputs.iter().find(|(own, _)| own == name);
        let unnamed = name == "out" || self.outputs.len() == 1;
        let found = found.or_else(|| self.outputs.first().filter(|_| unnamed));
        found.map(|(name, ty)| (name.as_str(), ty.as_str()))
    }
}

/// Definitions by name and by node.
#[derive(Debug, Default)]
pub(crate) struct Definitions {
    all: Vec<Definition>,
    by_name: FxHashMap<String, usize>,
    by_node: FxHashMap<String, Vec<usize>>,
}

impl Definitions {
    /// MaterialX's own.
    pub(crate) fn standard() -> &'static Self {
        static TABLE: OnceLock<Definitions> = OnceLock::new();
        TABLE.get_or_init(|| {
            let mut definitions = Self::default();
            for line in STANDARD.lines() {
                definitions.add(parse(line));
            }
            definitions
        })
    }

    /// Those that stand below an element.
    pub(crate) fn of(tree: &Tree, root: Id) -> Self {
        let mut definitions = Self::default();
        for id in tree.tagged(root, "nodedef") {
            definitions.add(read(tree, id));
        }
        definitions
    }

    fn add(&mut self, definition: Definition) {
        let index = self.all.len();
        self.by_name.entry(definition.name.clone()).or_insert(index);
        self.by_node
            .entry(definition.node.clone())
            .or_default()
            .push(index);
        self.all.push(definition);
    }

    pub(crate) fn named(&self, name: &str) -> Option<&Definition> {
        self.by_name.get(name).map(|index| &self.all[*index])
    }

    /// The definitions of a node.
    pub(crate) fn of_category(&self, node: &str) -> impl Iterator<Item = &Definition> + use<'_> {
        let indices = self.by_node.get(node).map_or(&[][..], Vec::as_slice);
        indices.iter().map(|index| &self.all[*index])
    }

    pub(crate) fn knows(&self, node: &str) -> bool {
        self.by_node.contains_key(node)
    }

    /// The definition that a node means: of its category, type and version, and of the types of its
    /// inputs; where none fits exactly, the one that most of them fit.
    pub(crate) fn of_node(
        &self,
        category: &str,
        ty: &str,
        version: Option<&str>,
        inputs: &[(&str, &str)],
    ) -> Option<&Definition> {
        let candidates = self
            .by_node
            .get(category)?
            .iter()
            .map(|index| &self.all[*index]);
        let candidates: Vec<&Definition> = candidates
            .filter(|definition| definition.ty() == ty || ty.is_empty())
            .collect();
        let fit = |definition: &&&Definition| {
            let typed = inputs
                .iter()
                .filter(|(name, ty)| definition.input(name).is_some_and(|input| input.ty == *ty));
            let versioned = match version {
                Some(version) => definition.version.as_deref() == Some(version),
                None => definition.is_default_version,
            };
            (versioned, typed.count())
        };
        // Of several that fit as well, the first, as MaterialX does.
        candidates.iter().rev().max_by_key(fit).copied()
    }
}

/// A line of the table.
pub(crate) fn parse(line: &str) -> Definition {
    let (left, right) = line.split_once(" -> ").unwrap_or((line, ""));
    let mut words = left.split_whitespace();
    let mut word = || words.next().unwrap_or("").to_owned();
    let (name, node) = (word(), word());
    let inputs = words.map(|word| {
        let (word, geometric) = match word.split_once('@') {
            Some((word, geometric)) => (word, Some(geometric.to_owned())),
            None => (word, None),
        };
        let (port, value) = match word.split_once('=') {
            Some((port, value)) => (port, Some(value.to_owned())),
            None => (word, None),
        };
        let (name, ty) = port.split_once(':').unwrap_or((port, ""));
        Input {
            name: name.to_owned(),
            ty: ty.to_owned(),
            value,
            geometric,
            element: None,
        }
    });
    Definition {
        name,
        node,
        inputs: inputs.collect(),
        outputs: (right.split_whitespace())
            .filter_map(|word| word.split_once(':'))
            .map(|(name, ty)| (name.to_owned(), ty.to_owned()))
            .collect(),
        version: None,
        is_default_version: true,
        element: None,
    }
}

/// A `nodedef` of a document.
fn read(tree: &Tree, id: Id) -> Definition {
    let element = tree.get(id);
    let text = |id: Id, key: &str| tree.get(id).attribute(key).map(str::to_owned);
    Definition {
        name: element.name.clone(),
        node: text(id, "node").unwrap_or_default(),
        inputs: (tree.tagged(id, "input"))
            .map(|input| Input {
                name: tree.get(input).name.clone(),
                ty: text(input, "type").unwrap_or_default(),
                value: text(input, "value"),
                geometric: text(input, "defaultgeomprop"),
                element: Some(input),
            })
            .collect(),
        outputs: (tree.tagged(id, "output"))
            .map(|output| {
                (
                    tree.get(output).name.clone(),
                    text(output, "type").unwrap_or_default(),
                )
            })
            .collect(),
        version: text(id, "version"),
        is_default_version: text(id, "isdefaultversion").as_deref() == Some("true"),
        element: Some(id),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overloads_are_told_apart_by_the_types_of_their_inputs() {
        let table = Definitions::standard();
        let found = |inputs: &[(&str, &str)]| {
            let definition = table.of_node("multiply", "color4", None, inputs);
            definition.map(|definition| definition.name.as_str())
        };
        assert_eq!(
            found(&[("in1", "color4"), ("in2", "float")]),
            Some("ND_multiply_color4FA")
        );
        assert_eq!(found(&[("in1", "color4")]), Some("ND_multiply_color4"));
        assert!(table.named("ND_noise2d_float").is_some());
        assert!(table.of_node("nothing", "float", None, &[]).is_none());
    }
}
