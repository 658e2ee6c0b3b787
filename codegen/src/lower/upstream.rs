//! What is upstream of an input over another footprint than the pixel's: how the input changes with
//! the place, and what it is when blurred.
//!
//! The nodes that the input depends on are lowered once more, into a function of the module that
//! takes the footprint as an argument. Linear responses are products of slopes, so they keep their
//! digits over a footprint of any size: the response over one of next to nothing is the derivative
//! at a point.

use super::fusion::region;
use super::{Bundle, Compiler, Lower};
use crate::ir::{Builder, FunctionRef, Module, Value};
use crate::moments::{Mode, Signal};
use mipless_graph::{Node, NodeId, Source};

/// A footprint on the surface: that of the pixel, convolved with a round Gaussian.
#[derive(Clone, Copy, Debug)]
pub struct Widened {
    /// L₁₁, L₂₁ and L₂₂ of the root L of the covariance Σ = LLᵀ, in uv.
    pub root: [Value; 3],
    /// The responses of u and of v to δ of the pixel's own footprint, A; 0 at a point.
    pub own: [[Value; 2]; 2],
    /// L⁻¹A.
    pub ratio: [[Value; 2]; 2],
}

/// A component of an input over a footprint with δ′ ~ N(0, I), in place of the pixel's δ.
#[derive(Clone, Copy, Debug)]
pub struct Over {
    /// The mean.
    pub mean: Value,
    /// The linear response to δ′.
    pub g: [Value; 2],
    /// The quadratic response to δ′: H₁₁, H₁₂, H₂₂; 0 unless it was asked for.
    pub h: [Value; 3],
    /// The variance beyond both.
    pub rest: Value,
}

/// An input over a widened footprint.
#[derive(Clone, Debug)]
pub struct Upstream {
    /// Its components.
    pub components: Vec<Over>,
    /// The footprint in root mean square wavelengths of the coarsest source or pattern that names one,
    /// else 0.
    pub wavelengths: Value,
}

/// The largest standard deviation of a footprint, in uv. Beyond it a texture has its far field, and
/// sources of up to 150 cells per uv still tell their wavelengths (they know 10⁴ cells).
const LARGEST: f32 = 64.0;

impl Lower<'_> {
    /// The pixel's footprint, or that of a point, convolved with a round Gaussian of this variance
    /// (in uv², above 0).
    pub fn widened(&mut self, variance: Value) -> Widened {
        let filters = self.mode().filters();
        let s = self.filter_sd;
        let [.., du_dx, dv_dx, du_dy, dv_dy] = self.arguments.footprint;
        let b = &mut self.algebra.b;
        let own = [[du_dx, du_dy], [dv_dx, dv_dy]].map(|row| {
            row.map(|change| {
                if filters {
                    b.scale(change, s)
                } else {
                    b.f32(0.0)
                }
            })
        });
        let [u, v] = own;
        // Over a larger footprint nothing changes but numbers that sources can no longer follow.
        let (of_u, of_v) = (b.dot(&u, &u), b.dot(&v, &v));
        let (size, largest) = (b.add(of_u, of_v), b.f32(LARGEST * LARGEST));
        let size = b.max(size, largest);
        let by = b.div(largest, size);
        let (of_u, of_v, both) = (b.mul(of_u, by), b.mul(of_v, by), b.dot(&u, &v));
        let both = b.mul(both, by);
        let first = b.add(of_u, variance);
        let first = b.sqrt(first);
        let one = b.f32(1.0);
        let inverse = b.div(one, first);
        let side = b.mul(both, inverse);
        // det Σ = (det A)² + v (|u|² + |v|²) + v², all of which are positive.
        let (p, q) = (b.mul(u[0], v[1]), b.mul(u[1], v[0]));
        let area = b.sub(p, q);
        let area = b.mul(area, by);
        let area = b.mul(area, inverse);
        let area = b.square(area);
        let total = b.add(of_u, of_v);
        let total = b.add(total, variance);
        let share = b.square(inverse);
        let share = b.mul(share, variance);
        let rest = b.mul(share, total);
        let second = b.add(area, rest);
        let second = b.sqrt(second);
        let inverse_second = b.div(one, second);
        let rows = [0, 1].map(|i| {
            let top = b.mul(u[i], inverse);
            let drop = b.mul(side, top);
            let left = b.sub(v[i], drop);
            [top, b.mul(left, inverse_second)]
        });
        Widened {
            root: [first, side, second],
            own,
            ratio: [[rows[0][0], rows[1][0]], [rows[0][1], rows[1][1]]],
        }
    }

    /// An input over a widened footprint, with its quadratic response if that is asked for.
    pub fn upstream(&mut self, node: &Node, port: &str, over: &Widened, second: bool) -> Upstream {
        let input = node.input(port);
        let source = match input.source {
            Source::Node(id) => id,
            Source::Surface if input.ty.components() == 2 => {
                let b = &mut self.algebra.b;
                let zero = b.f32(0.0);
                let [first, side, second] = over.root;
                let components = self.bundle(node, port);
                let rows = components.iter().zip([[first, zero], [side, second]]);
                let b = &mut self.algebra.b;
                let components = rows
                    .map(|(signal, g)| Over {
                        mean: signal.flat_mean(b),
                        g,
                        h: [zero; 3],
                        rest: zero,
                    })
                    .collect();
                return Upstream {
                    components,
                    wavelengths: zero,
                };
            }
            // Numbers, and what no footprint of uv moves.
            Source::Literal(_) | Source::Parameter(_) | Source::Surface => {
                let bundle = self.bundle(node, port);
                let b = &mut self.algebra.b;
                let zero = b.f32(0.0);
                let components = (bundle.iter())
                    .map(|signal| Over {
                        mean: signal.flat_mean(b),
                        g: [zero; 2],
                        h: [zero; 3],
                        rest: zero,
                    })
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
        let mut arguments = self.arguments.all();
        let s = self.filter_sd;
        let b = &mut self.algebra.b;
        let zero = b.f32(0.0);
        let [first, side, last] = over.root.map(|v| b.scale(v, 1.0 / s));
        arguments[4..8].copy_from_slice(&[first, side, zero, last]);
        let results = b.call(&function, &arguments);
        let (&wavelengths, components) = results.split_last().expect("the footprint is a result");
        let components: Vec<Over> = (components.chunks(PARTS))
            .map(|part| Over {
                mean: part[0],
                g: [part[1], part[2]],
                h: [part[3], part[4], part[5]],
                rest: part[6],
            })
            .collect();
        Upstream {
            components: self.broadcast(components, input.ty.components()),
            wavelengths,
        }
    }

    /// A float is every component; the alpha that a colour lacks is 1.
    fn broadcast(&mut self, mut components: Vec<Over>, count: usize) -> Vec<Over> {
        if let [one] = components[..] {
            components = vec![one; count.min(3)];
        }
        let b = &mut self.algebra.b;
        while components.len() < count {
            let (zero, one) = (b.f32(0.0), b.f32(1.0));
            components.push(Over {
                mean: one,
                g: [zero; 2],
                h: [zero; 3],
                rest: zero,
            });
        }
        components
    }
}

/// How many results a component has.
const PARTS: usize = 7;

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
    let mut lower = Lower::new(compiler, module, Builder::new(name, doc), mode);
    lower.measures = true;
    let mut uses = vec![0; graph.nodes.len()];
    uses[source.index()] = 1;
    for index in region(compiler, source.index(), &[]) {
        for input in &graph.nodes[index].inputs {
            if let Source::Node(id) = input.source {
                uses[id.index()] += 1;
            }
        }
    }
    lower.run_nodes(uses);
    let bundle: Bundle = lower.bundles[source.index()]
        .take()
        .expect("what is asked for is read once more than by its readers");
    let details = std::mem::take(&mut lower.details);
    let mut b = lower.algebra.b;
    for (i, signal) in bundle.iter().enumerate() {
        results(&mut b, i, signal);
    }
    let mut coarsest = details.first().copied().unwrap_or_else(|| b.f32(0.0));
    for &detail in details.iter().skip(1) {
        coarsest = b.min(coarsest, detail);
    }
    b.result("wavelengths", coarsest);
    b.finish(module)
}

fn results(b: &mut Builder, i: usize, signal: &Signal) {
    let mean = signal.flat_mean(b);
    let shared = Signal {
        h: [b.f32(0.0); 3],
        ..signal.clone()
    };
    let rest = shared.other_variance(b);
    b.result(format!("mean_{i}"), mean);
    for (name, value) in ["gx", "gy", "hxx", "hxy", "hyy"]
        .into_iter()
        .zip(signal.g.into_iter().chain(signal.h))
    {
        b.result(format!("{name}_{i}"), value);
    }
    b.result(format!("rest_{i}"), rest);
}
