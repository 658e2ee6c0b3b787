//! What nodes ask: the builder, shared functions, the surface, and their inputs in every form.

use super::place::Place;
use super::{Bundle, Lower};
use crate::ir::{Builder, Float, FunctionRef, Int, Module, Type as Kind, Vec2};
use crate::moments::{Mode, Signal};
use mipless_graph::{Literal, Node, NodeId, Source, Stops, Type};
use std::rc::Rc;

impl<'b> Lower<'_, 'b> {
    /// The builder of the function.
    pub fn b(&self) -> &'b Builder {
        self.algebra.b
    }

    /// Which moments are carried.
    pub fn mode(&self) -> Mode {
        self.algebra.mode
    }

    /// A function of the module, built once for each key; the key names whatever it depends on.
    pub fn function(
        &mut self,
        key: &str,
        build: impl FnOnce(&mut Module) -> FunctionRef,
    ) -> FunctionRef {
        if self.in_rule {
            let library = self.algebra.b.library().expect("a rule has a library");
            return library.function(key, build);
        }
        if let Some(function) = self.compiler.functions.borrow().get(key) {
            return function.clone();
        }
        let function = build(self.module);
        self.compiler
            .functions
            .borrow_mut()
            .insert(key.to_owned(), function.clone());
        function
    }

    /// Signals that several nodes make of the same inputs. Where it is asked what they have in common with
    /// others, they are made once in a function, and what is fresh in them stays theirs; elsewhere each
    /// node has its own. The key names whatever they depend on.
    pub fn jointly(&mut self, key: &str, make: impl FnOnce(&mut Self) -> Bundle<'b>) -> Bundle<'b> {
        if !self.compiler.facts.joint || self.in_rule {
            return make(self);
        }
        if let Some(known) = self.made.get(key) {
            return known.clone();
        }
        let mut bundle = make(self);
        for signal in &mut bundle {
            self.algebra.publish(signal);
        }
        self.carriers.born(&bundle);
        self.made.insert(key.to_owned(), bundle.clone());
        bundle
    }

    /// The surface's position: cell and fraction, g = A.
    pub fn surface(&self) -> Bundle<'b> {
        let mut place = self.coordinates(self.arguments.footprint);
        if self.algebra.derives() {
            for (axis, coordinate) in place.iter_mut().enumerate() {
                let along =
                    |i: usize| Signal::constant(self.b(), if i == axis { 1.0 } else { 0.0 });
                coordinate.slope = Some(Rc::new([0, 1].map(along)));
            }
        }
        place
    }

    /// Whether how signals change with u and with v is asked for.
    pub fn derives(&self) -> bool {
        self.algebra.derives()
    }

    /// The surface's position in space: cells and fractions, g = A.
    ///
    /// # Panics
    /// If no class rule of the graph says that a vector of three components is a position.
    pub fn space(&self) -> Bundle<'b> {
        let position = self.arguments.position;
        self.coordinates(position.expect("the graph reads the position"))
    }

    fn coordinates<const AXES: usize>(&self, place: Place<'b, AXES>) -> Bundle<'b> {
        let spread = (self.algebra.mode.filters()).then_some(self.filter_sd);
        (0..AXES)
            .map(|axis| {
                let change = Vec2([place.right[axis], place.down[axis]]);
                let spread = spread.map(|sd| change * sd);
                coordinate(place.cell[axis], place.fraction[axis], spread)
            })
            .collect()
    }

    /// The signals of an input, of the type that the node sees.
    ///
    /// # Panics
    /// If the node has no such input.
    pub fn bundle(&self, node: &Node, port: &str) -> Bundle<'b> {
        let input = node.input(port);
        let bundle = match &input.source {
            Source::Literal(literal) => (literal.numbers().into_iter())
                .map(|x| Signal::constant(self.algebra.b, x))
                .collect(),
            Source::Node(id) => self.output(*id),
            Source::Surface if input.ty == Type::Vector3 => self.space(),
            Source::Surface => self.surface(),
            Source::Parameter(id) => {
                let parameter = &self.compiler.graph.parameters[id.index()];
                let first = self.parameter_scalars[id.index()];
                let range = match (parameter.min, parameter.max) {
                    (Some(low), Some(high)) => [low, high],
                    _ => [f32::NEG_INFINITY, f32::INFINITY],
                };
                (0..parameter.ty.components())
                    .map(|i| {
                        let value = self.arguments.parameters[first + i];
                        let value = match value.ty() {
                            Kind::I32 => value.int().to_float(),
                            Kind::Bool => value.bool().select(1.0, 0.0),
                            _ => value.float(),
                        };
                        Signal::certain(value).with_range(range)
                    })
                    .collect()
            }
        };
        self.promote(bundle, input.ty)
    }

    fn output(&self, id: NodeId) -> Bundle<'b> {
        self.bundles[id.index()]
            .clone()
            .expect("an input is lowered before its user")
    }

    /// Floats broadcast, to alpha too; a colour gains an alpha of 1.
    fn promote(&self, mut bundle: Bundle<'b>, to: Type) -> Bundle<'b> {
        let components = to.components();
        if bundle.len() == 1 && components > 1 {
            bundle = vec![bundle[0].clone(); components];
        }
        while bundle.len() < components {
            bundle.push(Signal::constant(self.algebra.b, 1.0));
        }
        bundle
    }

    /// The one signal of a float input.
    pub fn signal(&self, node: &Node, port: &str) -> Signal<'b> {
        let mut bundle = self.bundle(node, port);
        assert_eq!(bundle.len(), 1, "{port} of {} is a float", node.spec.name);
        bundle.remove(0)
    }

    /// The mean of a float input that is a number to this node, such as an amplitude; where it
    /// varies over the surface its own spread is ignored.
    pub fn number(&self, node: &Node, port: &str) -> Float<'b> {
        self.signal(node, port).flat_mean()
    }

    /// A uniform integer.
    pub fn integer(&self, node: &Node, port: &str) -> i32 {
        match node.literal(port) {
            Literal::Integer(i) => *i,
            other => other.numbers()[0] as i32,
        }
    }

    /// A uniform number.
    pub fn float(&self, node: &Node, port: &str) -> f32 {
        node.literal(port).numbers()[0]
    }

    /// A uniform truth value.
    pub fn flag(&self, node: &Node, port: &str) -> bool {
        matches!(node.literal(port), Literal::Boolean(true))
    }

    /// The text of a uniform input: the chosen name of an enumeration, the name of a file.
    pub fn choice<'n>(&self, node: &'n Node, port: &str) -> &'n str {
        match node.literal(port) {
            Literal::Text(text) => text,
            other => panic!("{port} of {} is a text: {other:?}", node.spec.name),
        }
    }

    /// The stops of a uniform ramp.
    pub fn stops<'n>(&self, node: &'n Node, port: &str) -> &'n Stops {
        match node.literal(port) {
            Literal::Stops(stops) => stops,
            other => panic!("{port} of {} is a ramp: {other:?}", node.spec.name),
        }
    }

    /// The numbers of a uniform matrix.
    pub fn matrix<'n>(&self, node: &'n Node, port: &str) -> &'n [f32] {
        match node.literal(port) {
            Literal::Matrix(numbers) => numbers,
            other => panic!("{port} of {} is a matrix: {other:?}", node.spec.name),
        }
    }

    /// Whether the footprints of sources are asked for: [`Self::source_footprint`].
    pub fn measures(&self) -> bool {
        self.measures
    }

    /// Whether nothing else is asked of the node at work: its output is not read.
    pub fn only_measures(&self) -> bool {
        self.is_only_measured
    }

    /// Reports the footprint of a source, in wavelengths of its dominant detail: `auto` and `split`
    /// decide by it.
    pub fn source_footprint(&mut self, wavelengths: Float<'b>) {
        self.source_detail(wavelengths, 1.0);
    }

    /// The same of a source whose root mean square wavenumber, √(E|∇|²/Var), is `finer` times that of
    /// its dominant detail.
    pub fn source_detail(&mut self, wavelengths: Float<'b>, finer: f32) {
        self.footprints.push(wavelengths);
        self.details.push(wavelengths * finer);
    }

    /// Reports the footprint of a pattern, in wavelengths of its root mean square wavenumber, to what
    /// estimates slopes; nothing else depends on it.
    pub fn pattern_detail(&mut self, wavelengths: Float<'b>) {
        self.details.push(wavelengths);
    }
}

/// A coordinate of the surface: its mean carried as a cell and a fraction in [0, 1), and its linear
/// response, if it spreads.
fn coordinate<'b>(cell: Int<'b>, fraction: Float<'b>, g: Option<Vec2<'b>>) -> Signal<'b> {
    let start = Signal {
        cell: Some(cell),
        ..Signal::certain(fraction.literal(0.0))
    };
    let place = start.offset(fraction);
    Signal {
        cell: place.cell.or(Some(cell)),
        g: g.unwrap_or(place.g),
        ..place
    }
}
