//! How an input changes with u and with v over a footprint: its derivative signals (`moments/slope.rs`).
//!
//! What the input depends on is lowered once more, into a function of its own that takes the
//! footprint as an argument, as for [`Lower::upstream`]: elsewhere nothing is known of slopes, and
//! nothing is computed for them.
//!
//! A node whose output carries no slopes (a pattern, a picture, points in place of a closed form) gets
//! them from its responses: ∇m = L⁻ᵀg, and L⁻ᵀH as the response of that. Of the slopes that the
//! filter removed nothing is known then but how coarse the node's own detail is: the variance is
//! taken for isotropic and for R(2π/λ)²/2 in each direction, with R the variance beyond the Hessian.

use super::place::Place;
use super::symbols::MOST;
use super::{Bundle, Compiler, Lower, Widened};
use crate::ir::{Builder, Float, FunctionRef, Module, Sym2, Vec2, dot};
use crate::moments::{Mode, Signal, Slope};
use mipless_graph::{Node, NodeId, Source};
use std::rc::Rc;

/// The derivatives of a component of an input by u and by v, over a footprint with δ′ ~ N(0, I).
#[derive(Clone, Copy, Debug)]
pub struct Slopes<'b> {
    /// The means.
    pub mean: Vec2<'b>,
    /// The linear responses of each to δ′.
    pub rows: [Vec2<'b>; 2],
    /// The covariance of what is beyond them.
    pub rest: Sym2<'b>,
    /// The share of the footprint that is not flat.
    pub share: Float<'b>,
}

/// How many numbers they are, the share last.
const PARTS: usize = 10;

/// The names of the numbers.
const NAMES: [&str; PARTS] = [
    "u", "v", "u_gx", "u_gy", "v_gx", "v_gy", "rest_uu", "rest_uv", "rest_vv", "share",
];

impl<'b> Slopes<'b> {
    fn flat(b: &'b Builder) -> Self {
        let mut parts = [b.float(0.0); PARTS];
        parts[PARTS - 1] = b.float(1.0);
        Self::of(parts)
    }

    fn of([u, v, ux, uy, vx, vy, uu, uv, vv, share]: [Float<'b>; PARTS]) -> Self {
        Self {
            mean: Vec2([u, v]),
            rows: [Vec2([ux, uy]), Vec2([vx, vy])],
            rest: Sym2([uu, uv, vv]),
            share,
        }
    }
}

impl<'b> Lower<'_, 'b> {
    /// The derivatives of an input over a widened footprint; what of them spreads where `spreads` is
    /// asked for, else the means alone.
    pub fn slopes(
        &mut self,
        node: &Node,
        port: &str,
        over: &Widened<'b>,
        spreads: bool,
    ) -> Vec<Slopes<'b>> {
        self.reads_elsewhere = true;
        let b = self.algebra.b;
        let zero = b.float(0.0);
        let input = node.input(port);
        let components = input.ty.components();
        let source = match input.source {
            Source::Node(id) => id,
            Source::Surface if components == 2 => {
                return [0, 1]
                    .map(|axis| {
                        let mut slopes = Slopes::flat(b);
                        slopes.mean[axis] = b.float(1.0);
                        slopes
                    })
                    .to_vec();
            }
            // Numbers, and what no footprint of uv moves.
            Source::Literal(_) | Source::Parameter(_) | Source::Surface => {
                return vec![Slopes::flat(b); components];
            }
        };
        let mode = if spreads { Mode::Quad } else { Mode::Local };
        let compiler = self.compiler;
        let key = format!("slopes {} {mode:?}", source.index());
        let function = self.function(&key, |module| function(compiler, module, source, mode));
        let [first, side, last] = over.root.map(|v| v * (1.0 / self.filter_sd));
        let mut arguments = self.arguments.clone();
        arguments.footprint.right = [first, side];
        arguments.footprint.down = [zero, last];
        let results = self.algebra.b.call(&function, arguments);
        let count = parts(compiler);
        let mut slopes: Vec<Slopes<'b>> = (results.chunks_exact(count))
            .map(|parts| {
                let mut all = [b.float(1.0); PARTS];
                all[..count].copy_from_slice(parts);
                Slopes::of(all)
            })
            .collect();
        // A float is every component; the alpha that a colour lacks is 1.
        if let [one] = slopes[..] {
            slopes = vec![one; components.min(3)];
        }
        slopes.resize(components, Slopes::flat(b));
        slopes
    }

    /// The slopes of a node's output, where they are carried: those that its rule gives, else by its
    /// responses and by the detail that it reported since there were so many.
    pub(super) fn slopes_of(
        &mut self,
        bundle: &[Signal<'b>],
        details: usize,
    ) -> Vec<Option<Slope<'b>>> {
        if !self.algebra.derives() {
            return Vec::new();
        }
        let own = self.details[details..].iter().copied();
        let coarsest = own.reduce(|x, y| x.min(y));
        (bundle.iter())
            .map(|signal| match &signal.slope {
                Some(slope) => Some(slope.clone()),
                None if signal.is_certain() => None,
                None => Some(self.by_responses(signal, coarsest)),
            })
            .collect()
    }

    /// Gives them to the node's output, whatever took the place of its closed form, with as many
    /// symbols as signals carry.
    pub(super) fn put_slopes(&mut self, bundle: &mut Bundle<'b>, slopes: Vec<Option<Slope<'b>>>) {
        for (signal, slope) in bundle.iter_mut().zip(slopes) {
            while signal.shared.len() > MOST {
                let oldest = signal.shared[0].0;
                signal.retire(oldest);
            }
            signal.slope = slope.map(|slope| {
                let mut pair = [slope[0].clone(), slope[1].clone()];
                for slope in &mut pair {
                    self.algebra.publish(slope);
                }
                self.algebra.condensed(Rc::new(pair))
            });
        }
    }

    /// Slopes by the responses of a signal, in whose function the footprint's root is triangular.
    fn by_responses(&mut self, signal: &Signal<'b>, coarsest: Option<Float<'b>>) -> Slope<'b> {
        let Place { right, down, .. } = self.arguments.footprint;
        let s = self.filter_sd;
        let [first, side, second] = [right[0] * s, right[1] * s, down[1] * s];
        // L⁻ᵀ.
        let (by_first, by_second) = (1.0 / first, 1.0 / second);
        let raised = |[x, y]: [Float<'b>; 2]| {
            let v = y * by_second;
            [(x - side * v) * by_first, v]
        };
        let [u, v] = raised(*signal.g);
        let [h11, h12, h22] = *signal.h;
        let ([ux, vx], [uy, vy]) = (raised([h11, h12]), raised([h12, h22]));
        let of = |mean, g| Signal {
            g: Vec2(g),
            ..Signal::certain(mean)
        };
        let means = [of(u, [ux, uy]), of(v, [vx, vy])];
        let Some(wavelengths) = coarsest else {
            return Rc::new(means);
        };
        let rest = Signal {
            h: Sym2::splat(u.literal(0.0)),
            ..signal.clone()
        };
        let removed = removed([first, side, second], rest.other_variance(), wavelengths);
        let covariance = Sym2([removed, removed.literal(0.0), removed]);
        self.algebra.slope_of(means, covariance)
    }
}

/// The variance of the slopes that a footprint removed, in each direction: R(2π/λ)²/2, times
/// q²/(q² + ¼), q = (2πs/λ)². For small q R is of the third order and next to nothing, unless a
/// pattern estimates it by a share of its ramps: what is left of it then is of the first order, and no
/// detail.
fn removed<'b>(
    [first, side, second]: [Float<'b>; 3],
    rest: Float<'b>,
    wavelengths: Float<'b>,
) -> Float<'b> {
    let covariance = Sym2([
        first.square(),
        first * side,
        dot([side, second], [side, second]),
    ]);
    let [major, _] = covariance.eigenvalues();
    let turns = wavelengths.square() * std::f32::consts::TAU.powi(2);
    let square = turns.min(1e9).square();
    rest * (turns / major * (square / (square + 0.25)) * 0.5)
}

/// How many of the numbers are given: the share where it is asked for.
fn parts(compiler: &Compiler<'_>) -> usize {
    if compiler.facts.joint {
        PARTS
    } else {
        PARTS - 1
    }
}

/// How a node's output changes, as a function of the footprint.
fn function(
    compiler: &Compiler<'_>,
    module: &mut Module,
    source: NodeId,
    mode: Mode,
) -> FunctionRef {
    let graph = compiler.graph;
    let name = super::identifier(&graph.node(source).name);
    let name = match mode {
        Mode::Quad => format!("{name}_slope"),
        _ => format!("{name}_slope_at"),
    };
    let doc = "How a part of the texture changes with u and v, over a footprint of its own.";
    let b = &compiler.builder(name, doc);
    let mut lower = Lower::new(compiler, module, b, mode);
    lower.measures = true;
    lower.algebra.derives = true;
    lower.algebra.shares_slopes = compiler.facts.joint;
    let bundle = lower.run_alone(source.index());
    for (i, signal) in bundle.iter().enumerate() {
        let flat = || {
            let zero = Signal::constant(b, 0.0);
            Rc::new([zero.clone(), zero])
        };
        let slope = signal.slopes().unwrap_or_else(flat);
        let [u, v] = &*slope;
        let [ux, uy] = *u.g;
        let [vx, vy] = *v.g;
        let crossed = u.covariance(v).rest;
        let rest = [u.other_variance(), crossed, v.other_variance()];
        let numbers = [u.flat_mean(), v.flat_mean(), ux, uy, vx, vy]
            .into_iter()
            .chain(rest)
            .chain([Signal::share_of([u, v])]);
        for (name, number) in NAMES.into_iter().take(parts(compiler)).zip(numbers) {
            b.result(format!("{name}_{i}"), number);
        }
    }
    b.finish(module)
}
