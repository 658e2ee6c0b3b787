//! What is upstream of an input over another footprint than the pixel's: how the input changes with
//! the place, and what it is when blurred.
//!
//! The nodes that the input depends on are lowered once more, into a function of the module that
//! takes the footprint as an argument. Linear responses are products of slopes, so they keep their
//! digits over a footprint of any size: the response over one of next to nothing is the derivative
//! at a point.

use super::place::Place;
use super::{Compiler, Lower};
use crate::ir::{Builder, Float, FunctionRef, Module, Sym2, Vec2, dot};
use crate::moments::{Mode, PARTS, Signal};
use mipless_graph::{Node, NodeId, Source};

/// A footprint on the surface: that of the pixel, convolved with a round Gaussian.
#[derive(Clone, Copy, Debug)]
pub struct Widened<'b> {
    /// L₁₁, L₂₁ and L₂₂ of the root L of the covariance Σ = LLᵀ, in uv.
    pub root: [Float<'b>; 3],
    /// The responses of u and of v to δ of the pixel's own footprint, A; 0 at a point.
    pub own: [[Float<'b>; 2]; 2],
    /// L⁻¹A.
    pub ratio: [[Float<'b>; 2]; 2],
}

/// A component of an input over a footprint with δ′ ~ N(0, I), in place of the pixel's δ.
#[derive(Clone, Copy, Debug)]
pub struct Over<'b> {
    /// The mean.
    pub mean: Float<'b>,
    /// The linear response to δ′.
    pub g: Vec2<'b>,
    /// The quadratic response to δ′: H₁₁, H₁₂, H₂₂; 0 unless it was asked for.
    pub h: Sym2<'b>,
    /// The variance beyond both.
    pub rest: Float<'b>,
}

/// An input over a widened footprint.
#[derive(Clone, Debug)]
pub struct Upstream<'b> {
    /// Its components.
    pub components: Vec<Over<'b>>,
    /// The footprint in root mean square wavelengths of the coarsest source or pattern that names one,
    /// else 0.
    pub wavelengths: Float<'b>,
}

/// The largest standard deviation of a footprint, in uv. Beyond it a texture has its far field, and
/// sources of up to 150 cells per uv still tell their wavelengths (they know 10⁴ cells).
const LARGEST: f32 = 64.0;

impl<'b> Over<'b> {
    /// A number that the place moves linearly.
    fn linear(mean: Float<'b>, g: Vec2<'b>) -> Self {
        let zero = mean.literal(0.0);
        Self {
            mean,
            g,
            h: Sym2::splat(zero),
            rest: zero,
        }
    }

    /// A number that no place moves.
    fn certain(mean: Float<'b>) -> Self {
        Self::linear(mean, Vec2::splat(mean.literal(0.0)))
    }
}

impl<'b> Lower<'_, 'b> {
    /// The pixel's footprint, or that of a point, convolved with a round Gaussian of this variance
    /// (in uv², above 0).
    pub fn widened(&self, variance: Float<'b>) -> Widened<'b> {
        let (filters, s) = (self.mode().filters(), self.filter_sd);
        let Place { right, down, .. } = self.arguments.footprint;
        let own = [0, 1].map(|axis| {
            [right[axis], down[axis]].map(|change| {
                if filters {
                    change * s
                } else {
                    change.literal(0.0)
                }
            })
        });
        let [u, v] = own;

        // Over a larger footprint nothing changes but numbers that sources can no longer follow.
        let (of_u, of_v) = (dot(u, u), dot(v, v));
        const MOST: f32 = LARGEST * LARGEST;
        let by = MOST / (of_u + of_v).max(MOST);
        let (of_u, of_v, both) = (of_u * by, of_v * by, dot(u, v) * by);

        // The root: det Σ = (det A)² + v (|u|² + |v|²) + v², all of which are positive.
        let first = (of_u + variance).sqrt();
        let inverse = 1.0 / first;
        let side = both * inverse;
        let area = (u[0] * v[1] - u[1] * v[0]) * by * inverse;
        let rest = inverse.square() * variance * (of_u + of_v + variance);
        let second = (area.square() + rest).sqrt();
        let inverse_second = 1.0 / second;

        let [[top_x, bottom_x], [top_y, bottom_y]] = [0, 1].map(|i| {
            let top = u[i] * inverse;
            [top, (v[i] - side * top) * inverse_second]
        });
        Widened {
            root: [first, side, second],
            own,
            ratio: [[top_x, top_y], [bottom_x, bottom_y]],
        }
    }

    /// An input over a widened footprint, with its quadratic response if that is asked for.
    pub fn upstream(
        &mut self,
        node: &Node,
        port: &str,
        over: &Widened<'b>,
        second: bool,
    ) -> Upstream<'b> {
        self.reads_elsewhere = true;
        let zero = self.algebra.b.float(0.0);
        let input = node.input(port);
        let source = match input.source {
            Source::Node(id) => id,
            Source::Surface if input.ty.components() == 2 => {
                let [first, side, second] = over.root;
                let rows = [Vec2([first, zero]), Vec2([side, second])];
                let components = self.bundle(node, port);
                let components = (components.iter().zip(rows))
                    .map(|(signal, g)| Over::linear(signal.flat_mean(), g))
                    .collect();
                return Upstream {
                    components,
                    wavelengths: zero,
                };
            }
            // Numbers, and what no footprint of uv moves.
            Source::Literal(_) | Source::Parameter(_) | Source::Surface => {
                let components = (self.bundle(node, port).iter())
                    .map(|signal| Over::certain(signal.flat_mean()))
                    .collect();
                return Upstream {
                    components,
                    wavelengths: zero,
                };
            }
        };
        let mode = if second { Mode::Quad } else { Mode::Local };
        let compiler = self.compiler;
        let key = format!("upstream {} {mode:?}", source.index());
        let function = self.function(&key, |module| function(compiler, module, source, mode));
        let [first, side, last] = over.root.map(|v| v * (1.0 / self.filter_sd));
        let mut arguments = self.arguments.clone();
        arguments.footprint.right = [first, side];
        arguments.footprint.down = [zero, last];
        let results = self.algebra.b.call(&function, arguments);
        let (&wavelengths, components) = results.split_last().expect("the footprint is a result");
        let components: Vec<Over<'b>> = (components.as_chunks::<PARTS>().0.iter())
            .map(|&[mean, gx, gy, hxx, hxy, hyy, rest]| Over {
                mean,
                g: Vec2([gx, gy]),
                h: Sym2([hxx, hxy, hyy]),
                rest,
            })
            .collect();
        Upstream {
            components: self.broadcast(components, input.ty.components()),
            wavelengths,
        }
    }

    /// A float is every component; the alpha that a colour lacks is 1.
    fn broadcast(&self, mut components: Vec<Over<'b>>, count: usize) -> Vec<Over<'b>> {
        if let [one] = components[..] {
            components = vec![one; count.min(3)];
        }
        while components.len() < count {
            components.push(Over::certain(self.algebra.b.float(1.0)));
        }
        components
    }
}

/// A node's output as a function of the footprint.
fn function(
    compiler: &Compiler<'_>,
    module: &mut Module,
    source: NodeId,
    mode: Mode,
) -> FunctionRef {
    let graph = compiler.graph;
    let name = super::identifier(&graph.node(source).name);
    let name = match mode {
        Mode::Quad => format!("{name}_over_quad"),
        _ => format!("{name}_over"),
    };
    let doc = "A part of the texture over a footprint of its own.";
    let b = &compiler.builder(name, doc);
    let mut lower = Lower::new(compiler, module, b, mode);
    lower.measures = true;
    let bundle = lower.run_alone(source.index());
    for (i, signal) in bundle.iter().enumerate() {
        results(b, i, signal);
    }
    let coarsest = lower.details.iter().copied().reduce(|x, y| x.min(y));
    b.result("wavelengths", coarsest.unwrap_or_else(|| b.float(0.0)));
    b.finish(module)
}

fn results<'b>(b: &'b Builder, i: usize, signal: &Signal<'b>) {
    let carried = Signal {
        h: Sym2::splat(b.float(0.0)),
        ..signal.clone()
    };
    b.result(format!("mean_{i}"), signal.flat_mean());
    let responses = signal.g.into_iter().chain(signal.h);
    for (name, value) in ["gx", "gy", "hxx", "hxy", "hyy"].into_iter().zip(responses) {
        b.result(format!("{name}_{i}"), value);
    }
    b.result(format!("rest_{i}"), carried.other_variance());
}
