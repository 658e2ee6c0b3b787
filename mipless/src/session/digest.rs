//! What a graph says, in 128 bits: equal graphs have equal digests, whenever and wherever they are made in
//! one process.

use mipless_graph::{Graph, Input, Literal, Node, Source, Type};
use std::hash::{DefaultHasher, Hasher};

/// Two of SipHash's words under different prefixes: among 10⁹ digests two that are equal by chance have a
/// probability of 10⁻²⁰.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct Digest([u64; 2]);

/// The words of which a digest is made; what has no fixed length says it first.
#[derive(Default)]
pub(super) struct Words(Vec<u8>);

impl Words {
    pub(super) fn number(&mut self, number: u64) -> &mut Self {
        self.0.extend(number.to_le_bytes());
        self
    }

    pub(super) fn text(&mut self, text: &str) -> &mut Self {
        self.number(text.len() as u64);
        self.0.extend(text.as_bytes());
        self
    }

    pub(super) fn reals(&mut self, reals: &[f32]) -> &mut Self {
        self.number(reals.len() as u64);
        for real in reals {
            self.0.extend(real.to_bits().to_le_bytes());
        }
        self
    }

    pub(super) fn digest(&mut self, digest: Digest) -> &mut Self {
        self.number(digest.0[0]).number(digest.0[1])
    }

    /// The digest; the words start anew.
    pub(super) fn take(&mut self) -> Digest {
        let words = [0, 1].map(|prefix| {
            let mut hasher = DefaultHasher::new();
            hasher.write_u8(prefix);
            hasher.write(&self.0);
            hasher.finish()
        });
        self.0.clear();
        Digest(words)
    }
}

/// What a name of a file stands for, by its digest.
pub(super) type Pictures<'p> = &'p dyn Fn(&str) -> Option<Digest>;

/// The digests of the nodes of a graph: of all that each is a function of.
pub(super) fn of_nodes(graph: &Graph, pictures: Pictures<'_>) -> Vec<Digest> {
    let mut words = Words::default();
    let mut digests: Vec<Digest> = Vec::with_capacity(graph.nodes.len());
    for node in &graph.nodes {
        start(&mut words, node);
        for input in &node.inputs {
            of_input(&mut words, graph, pictures, input, &digests);
        }
        let digest = words.take();
        digests.push(digest);
    }
    digests
}

fn start(words: &mut Words, node: &Node) {
    words
        .number(node.definition as u64)
        .number(node.ty as u64)
        .text(&node.name);
}

fn of_input(
    words: &mut Words,
    graph: &Graph,
    pictures: Pictures<'_>,
    input: &Input,
    digests: &[Digest],
) {
    words.number(input.from as u64).number(input.ty as u64);
    match &input.source {
        Source::Node(id) => {
            words.number(0).digest(digests[id.index()]);
        }
        Source::Surface => {
            words.number(1);
        }
        Source::Parameter(id) => {
            let parameter = &graph.parameters[id.index()];
            let bounds = [parameter.min, parameter.max];
            words
                .number(2)
                .number(u64::from(id.0))
                .text(&parameter.name)
                .number(parameter.ty as u64)
                .number(bounds.iter().flatten().count() as u64)
                .reals(&bounds.map(|bound| bound.unwrap_or(f32::NAN)));
        }
        Source::Literal(literal) => {
            words.number(3);
            of_literal(words, literal);
            if let (Literal::Text(name), Type::Filename) = (literal, input.ty)
                && let Some(digest) = pictures(name)
            {
                words.digest(digest);
            }
        }
    }
}

fn of_literal(words: &mut Words, literal: &Literal) {
    match literal {
        Literal::Numbers(ty, numbers) => {
            words.number(0).number(*ty as u64).reals(numbers);
        }
        Literal::Integer(integer) => {
            words.number(1).number(*integer as u64);
        }
        Literal::Boolean(flag) => {
            words.number(2).number(u64::from(*flag));
        }
        Literal::Text(text) => {
            words.number(3).text(text);
        }
        Literal::Stops(stops) => {
            words
                .number(4)
                .number(stops.ty as u64)
                .number(stops.stops.len() as u64);
            for stop in &stops.stops {
                words.reals(&[stop.at]).reals(&stop.value);
            }
        }
        Literal::Matrix(numbers) => {
            words.number(5).reals(numbers);
        }
    }
}

/// The digest of all that a program of the graph depends on: the nodes in their order, the outputs, the
/// inputs with their values and sliders, and the name.
pub(super) fn of_program(
    graph: &Graph,
    nodes: &[Digest],
    options: &mipless_codegen::Options,
) -> Digest {
    let mut words = Words::default();
    words.text(&graph.name).text(&format!("{options:?}"));
    words.number(graph.parameters.len() as u64);
    for parameter in &graph.parameters {
        words
            .text(&parameter.name)
            .number(parameter.ty as u64)
            .reals(&parameter.value.numbers());
        let bounds = [
            parameter.min,
            parameter.max,
            parameter.soft_min,
            parameter.soft_max,
        ];
        for bound in bounds {
            words.number(u64::from(bound.is_some()));
            words.reals(&[bound.unwrap_or(0.0)]);
        }
    }
    words.number(nodes.len() as u64);
    for node in nodes {
        words.digest(*node);
    }
    for output in &graph.outputs {
        words
            .text(&output.name)
            .number(output.ty as u64)
            .digest(nodes[output.node.index()]);
    }
    words.number(graph.materials.len() as u64);
    words.take()
}
