//! What nodes ask: the builder, shared functions, the surface, and their inputs in every form.

use super::{Bundle, Lower};
use crate::ir::{Builder, FunctionRef, Module, Type as Scalar, Value};
use crate::moments::{Mode, Signal};
use mipless_graph::{Literal, Node, NodeId, Source, Stops, Type};

impl Lower<'_> {
    /// The builder of the function.
    pub fn b(&mut self) -> &mut Builder {
        &mut self.algebra.b
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

    /// The surface's position: cell and fraction, g = A.
    pub fn surface(&mut self) -> Bundle {
        let [cell_x, cell_y, u, v, du_dx, dv_dx, du_dy, dv_dy] = self.arguments.footprint;
        let s = self.filter_sd;
        let spreads = self.algebra.mode.filters();
        let b = &mut self.algebra.b;
        [(cell_x, u, [du_dx, du_dy]), (cell_y, v, [dv_dx, dv_dy])]
            .map(|(cell, fraction, change)| {
                place(b, cell, fraction, spreads.then_some((change, s)))
            })
            .to_vec()
    }

    /// The surface's position in space: cells and fractions, g = A.
    ///
    /// # Panics
    /// If no class rule of the graph says that a vector of three components is a position.
    pub fn space(&mut self) -> Bundle {
        let all = self
            .arguments
            .position
            .expect("the graph reads the position");
        let s = self.filter_sd;
        let spreads = self.algebra.mode.filters();
        let b = &mut self.algebra.b;
        (0..3)
            .map(|axis| {
                let change = [all[6 + axis], all[9 + axis]];
                place(b, all[axis], all[3 + axis], spreads.then_some((change, s)))
            })
            .collect()
    }

    /// The signals of an input, of the type that the node sees.
    ///
    /// # Panics
    /// If the node has no such input.
    pub fn bundle(&mut self, node: &Node, port: &str) -> Bundle {
        let input = node.input(port);
        let bundle = match &input.source {
            Source::Literal(literal) => {
                let b = &mut self.algebra.b;
                literal
                    .numbers()
                    .into_iter()
                    .map(|x| Signal::constant(b, x))
                    .collect()
            }
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
                        let b = &mut self.algebra.b;
                        let value = match b.ty(value) {
                            Scalar::I32 => b.float_i(value),
                            Scalar::Bool => {
                                let (one, zero) = (b.f32(1.0), b.f32(0.0));
                                b.select(value, one, zero)
                            }
                            _ => value,
                        };
                        Signal::certain(b, value).with_range(range)
                    })
                    .collect()
            }
        };
        self.promote(bundle, input.ty)
    }

    fn output(&self, id: NodeId) -> Bundle {
        self.bundles[id.index()]
            .clone()
            .expect("an input is lowered before its user")
    }

    /// Floats broadcast; a colour gains an alpha of 1.
    fn promote(&mut self, mut bundle: Bundle, to: Type) -> Bundle {
        let components = to.components();
        if bundle.len() == 1 && components > 1 {
            // A float as a colour with alpha is opaque.
            let opaque = to == Type::Color4;
            bundle = vec![bundle[0].clone(); components];
            if opaque {
                bundle[3] = Signal::constant(&mut self.algebra.b, 1.0);
            }
        }
        while bundle.len() < components {
            bundle.push(Signal::constant(&mut self.algebra.b, 1.0));
        }
        bundle
    }

    /// The one signal of a float input.
    pub fn signal(&mut self, node: &Node, port: &str) -> Signal {
        let mut bundle = self.bundle(node, port);
        assert_eq!(bundle.len(), 1, "{port} of {} is a float", node.spec.name);
        bundle.remove(0)
    }

    /// The mean of a float input that is a number to this node, such as an amplitude; where it
    /// varies over the surface its own spread is ignored.
    pub fn number(&mut self, node: &Node, port: &str) -> Value {
        let signal = self.signal(node, port);
        signal.flat_mean(&mut self.algebra.b)
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
    pub fn source_footprint(&mut self, wavelengths: Value) {
        self.source_detail(wavelengths, 1.0);
    }

    /// The same of a source whose root mean square wavenumber, √(E|∇|²/Var), is `finer` times that of
    /// its dominant detail.
    pub fn source_detail(&mut self, wavelengths: Value, finer: f32) {
        self.footprints.push(wavelengths);
        let detail = self.algebra.b.scale(wavelengths, finer);
        self.details.push(detail);
    }

    /// Reports the footprint of a pattern, in wavelengths of its root mean square wavenumber, to what
    /// estimates slopes; nothing else depends on it.
    pub fn pattern_detail(&mut self, wavelengths: Value) {
        self.details.push(wavelengths);
    }
}

/// A coordinate of the surface: its mean carried as a cell and a fraction in [0, 1), and its
/// changes from pixel to pixel times the standard deviation of the filter, if it spreads.
fn place(
    b: &mut Builder,
    cell: Value,
    fraction: Value,
    spread: Option<([Value; 2], f32)>,
) -> Signal {
    let zero = b.f32(0.0);
    let start = Signal {
        cell: Some(cell),
        ..Signal::certain(b, zero)
    };
    let mut signal = start.offset(b, fraction);
    if signal.cell.is_none() || b.is_zero(fraction) {
        signal.cell = Some(cell);
    }
    if let Some((change, sd)) = spread {
        signal.g = change.map(|x| b.scale(x, sd));
    }
    signal
}
