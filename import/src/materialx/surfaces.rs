//! The shaders of a document as nodes `surface`: each takes those of its inputs that the node has, and its
//! parts are outputs.

use super::network::Network;
use super::refuse;
use super::root::{Root, Surface};
use crate::Output;
use crate::build::Builder;
use crate::surface::{self, NODE};
use crate::value::Value;
use mipless_graph::{Diagnostic, Reference};

/// An output that shows a part of a surface.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Shown {
    name: String,
    part: String,
}

/// The surfaces of a document, with what is known of their inputs.
pub(super) struct Surfaces<'a> {
    surfaces: &'a [Surface],
    given: Vec<Vec<(String, Value)>>,
    shown: Vec<Vec<Shown>>,
    /// Whether there is a node `surface` at all.
    known: bool,
}

impl<'a> Surfaces<'a> {
    pub(super) fn new(builder: &Builder, surfaces: &'a [Surface]) -> Self {
        Self {
            surfaces,
            given: vec![Vec::new(); surfaces.len()],
            shown: vec![Vec::new(); surfaces.len()],
            known: builder.spec(NODE).is_some(),
        }
    }

    /// Whether one surface gives all outputs.
    fn is_whole(&self) -> bool {
        matches!(self.surfaces, [only] if only.prefix.is_empty() && only.shader.is_model)
    }

    /// Takes an input that a surface has, and gives the name of the output that shows it. What it has not
    /// is an output of its own, which a note says where it is not what it is anyway.
    pub(super) fn take(
        &mut self,
        network: &mut Network<'_>,
        builder: &Builder,
        root: &Root,
        value: &Result<Value, ()>,
    ) -> Option<String> {
        let index = root.surface.filter(|_| self.known)?;
        let surface = &self.surfaces[index];
        let input = network.tree.get(root.element).name.clone();
        // MaterialX's generator reads the surface where a literal is written for its normal.
        let is_ignored = |value: &Value| {
            surface.shader.is_geometric(&input) && matches!(value, Value::Literal(_))
        };
        // A height has slopes, which what is a function of space has not.
        let in_space = |(part, _): &(&str, &str)| {
            *part == "displacement" && value.as_ref().is_ok_and(|value| builder.is_in_space(value))
        };
        // A scale is one of what is a height.
        let given = &self.given[index];
        let scales_nothing =
            input == "scale" && given.iter().all(|(name, _)| name != "displacement");
        let part = (surface.shader.part(&input)).filter(|part| !in_space(part) && !scales_nothing);
        let Some((part, name)) = part else {
            let is_default =
                |value: &Value| surface.shader.is_default(&input, value) || is_ignored(value);
            if !value.as_ref().is_ok_and(is_default) {
                let place = network.tree.place(root.element);
                let message = match surface.shader.part(&input) {
                    Some(_) => format!(
                        "`{input}` is a function of space and no height: it is an output of its own"
                    ),
                    None => format!("`{NODE}` has no `{input}`, which is an output of its own"),
                };
                let note = Diagnostic::note("import-approximated", message);
                network.findings.say(&place, note);
            }
            return None;
        };
        let shown = Shown {
            name: format!("{}{name}", surface.prefix),
            part: part.to_owned(),
        };
        let name = shown.name.clone();
        if let Ok(value) = value {
            if !is_ignored(value) {
                self.given[index].push((input, value.clone()));
            }
            if !self.shown[index].contains(&shown) {
                self.shown[index].push(shown);
            }
        }
        Some(name)
    }

    /// A name for an output of its own that no part has.
    pub(super) fn distinct(&self, builder: &Builder, name: String) -> String {
        let [only] = self.surfaces else {
            return name;
        };
        let is_part = self.known && surface::is_part(builder, &only.shader.model, &name);
        if is_part {
            format!("{name}_input")
        } else {
            name
        }
    }

    /// Makes the nodes, and the outputs that show them.
    pub(super) fn finish(
        self,
        network: &mut Network<'_>,
        builder: &mut Builder,
        outputs: &mut Vec<Output>,
    ) {
        let is_whole = self.is_whole();
        for (index, surface) in self.surfaces.iter().enumerate() {
            let shown = &self.shown[index];
            // A shader without inputs is a material where there is nothing else.
            let is_bare = is_whole && outputs.is_empty();
            if shown.is_empty() && !is_bare {
                continue;
            }
            let place = network.tree.place(surface.element);
            builder.place = Some(place.clone());
            builder.hint = match is_whole {
                true => NODE.to_owned(),
                false => network
                    .tree
                    .get(surface.element)
                    .name
                    .replace([':', '/'], "_"),
            };
            match surface.shader.node(builder, &self.given[index]) {
                Ok(reference) if is_whole => {
                    builder.read(NODE, reference);
                    if is_bare {
                        outputs.push(Output {
                            name: NODE.to_owned(),
                            source: network.tree.get(surface.element).name.clone(),
                            loads: true,
                        });
                    }
                }
                Ok(reference) => {
                    for shown in shown {
                        let part = Reference {
                            output: shown.part.clone(),
                            ..reference.clone()
                        };
                        builder.read(&shown.name, part);
                    }
                }
                Err(refusal) => {
                    refuse(network, &place, &refusal);
                    for output in outputs.iter_mut() {
                        output.loads &= shown.iter().all(|shown| shown.name != output.name);
                    }
                }
            }
        }
    }
}
