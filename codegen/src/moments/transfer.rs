//! Functions of one signal: Stein's slope, Bussgang's distortion, and the third cumulant.

use super::{
    Algebra, Mode, Signal,
    signal::{UNBOUNDED, ordered},
    spread,
};
use crate::ir::{Builder, SharedFunction, Value};
use smallvec::SmallVec;

/// The Gaussian that a transfer is averaged over.
#[derive(Clone, Copy, Debug)]
pub struct Gaussian {
    /// The mean m.
    pub mean: Value,
    /// The variance v.
    pub variance: Value,
    /// σ, at least 1e-6.
    pub sd: Value,
    /// 1/σ.
    pub inverse_sd: Value,
    /// The range of the input, as far as is known.
    pub range: [f32; 2],
}

/// The moments of T(X) for a Gaussian X.
#[derive(Clone, Copy, Debug)]
pub struct Moments {
    /// E[T].
    pub mean: Value,
    /// E[T′] = ∂E[T]/∂m (Stein).
    pub slope: Value,
    /// E[T″] = ∂²E[T]/∂m².
    pub curvature: Value,
    /// E[T‴] = ∂³E[T]/∂m³.
    pub third: Value,
    /// Var T − E[T′]² v, never negative (Bussgang).
    pub distortion: Value,
}

/// A function of one number, with its moments over a Gaussian.
pub trait Transfer {
    /// T(x).
    fn value(&self, b: &mut Builder, x: Value) -> Value;
    /// The moments over a Gaussian.
    fn moments(&self, b: &mut Builder, x: &Gaussian) -> Moments;
    /// The period, where the function has one: positions then give their fraction alone.
    fn period(&self) -> Option<f32> {
        None
    }
    /// The two values of a function that takes no others.
    fn binary(&self, _: &Builder) -> Option<[f32; 2]> {
        None
    }
    /// How the function is one of a family that shares its code, over an input within `range`;
    /// `None` builds it where it is used.
    fn shared(&self, _b: &mut Builder, _range: [f32; 2]) -> Option<SharedTransfer> {
        None
    }
    /// The least and largest value on `[low, high]` (which may be infinite).
    fn range(&self, b: &Builder, input: [f32; 2]) -> [f32; 2];
}

/// A transfer as a member of a family: the same code for other values.
#[derive(Debug)]
pub struct SharedTransfer {
    /// The family's name (an identifier in lower snake case).
    pub name: &'static str,
    /// One sentence that says what the family computes.
    pub doc: &'static str,
    /// What the code depends on beside the values, below 2²⁹.
    pub variant: u32,
    /// The values that tell the members apart.
    pub values: SmallVec<[Value; 16]>,
    /// The member of these values.
    pub rebuild: fn(variant: u32, values: &[Value]) -> Box<dyn Transfer>,
}

impl Algebra {
    /// T(X): mean E[T] + (κ₃/6) E[T‴] inside T's range, coefficients E[T′]·x, second order
    /// E[T′] H + E[T″] g gᵀ, and the distortion into a fresh ε (RULES: transfers, H and the third
    /// cumulant). Where several transfers read X, the second Hermite part of the distortion is
    /// shared among them.
    pub fn transfer(&mut self, x: &Signal, t: &dyn Transfer) -> Signal {
        let b = &mut self.b;
        let range = t.range(b, x.range);
        // Whole periods do not matter, and a fraction keeps its detail far from the origin.
        let fraction = Signal {
            cell: None,
            ..x.clone()
        };
        let x = if t.period() == Some(1.0) {
            &fraction
        } else {
            x
        };
        if !self.mode.spreads() || x.is_certain(b) {
            let mean = x.flat_mean(b);
            let value = t.value(b, mean);
            return Signal::certain(b, value).with_range(range);
        }
        if let Some(values) = x.binary {
            return self.between(x, t, values);
        }
        let x = &x.flat(b);
        let carries = self.mode == Mode::Quad;
        let carried = x.shared_variance(b);
        let shared = t.shared(b, x.range);
        // The mean can leave the range by the third cumulant alone.
        let bounded = carries && range[0].is_finite() && range[1].is_finite();
        let [from, to] = if bounded { range } else { [0.0; 2] }.map(|end| b.f32(end));
        let inputs: SmallVec<[(&'static str, Value); 24]> = [
            ("mean", x.mean),
            ("gx", x.g[0]),
            ("gy", x.g[1]),
            ("hxx", x.h[0]),
            ("hxy", x.h[1]),
            ("hyy", x.h[2]),
            ("private", x.private),
            ("carried", carried),
            ("from", from),
            ("to", to),
        ]
        .into_iter()
        .collect();
        let wants = Wants {
            second: carries,
            hermite: x.hermite.is_some(),
            bounded,
        };
        let [
            mean,
            gx,
            gy,
            hxx,
            hxy,
            hyy,
            private,
            slope,
            hermite,
            distortion,
        ] = match shared {
            Some(shared) => {
                let mut inputs = inputs;
                inputs.extend(shared.values.iter().map(|&v| ("v", v)));
                let of = SharedFunction {
                    name: shared.name,
                    variant: shared.variant << 3 | wants.bits(),
                    doc: shared.doc,
                };
                b.shared(of, &inputs, |b, v| {
                    let t = (shared.rebuild)(shared.variant, &v[INPUTS..]);
                    through(b, &v[..INPUTS], UNBOUNDED, &*t, wants)
                })
            }
            None => {
                let values: SmallVec<[Value; INPUTS]> = inputs.iter().map(|&(_, v)| v).collect();
                through(b, &values, x.range, t, wants).map(|(_, v)| v)
            }
        };
        if !b.is_zero(distortion) {
            self.bent = true;
            self.period = t.period();
        }
        let mut out = Signal {
            mean,
            cell: None,
            g: [gx, gy],
            h: [hxx, hxy, hyy],
            shared: x
                .shared
                .iter()
                .map(|&(s, v)| (s, b.mul(v, slope)))
                .collect(),
            private,
            range,
            binary: t.binary(b).map(|values| values.map(|v| b.f32(v))),
            hermite: None,
        };
        if let Some(symbol) = x.hermite {
            out.push_shared(symbol, hermite);
        }
        self.attach_fresh(&mut out, distortion);
        out
    }

    /// T(X) of a signal that takes two values is linear in it: exact, whatever T is.
    fn between(&mut self, x: &Signal, t: &dyn Transfer, [low, high]: [Value; 2]) -> Signal {
        let b = &mut self.b;
        let (at_low, at_high) = (t.value(b, low), t.value(b, high));
        let (rise, span) = (b.sub(at_high, at_low), b.sub(high, low));
        // Two equal values are one: then the rise is 0 as well.
        let (zero, one) = (b.f32(0.0), b.f32(1.0));
        let magnitude = b.abs(span);
        let distinct = b.lt(zero, magnitude);
        let span = b.select(distinct, span, one);
        let slope = b.div(rise, span);
        let mut out = x.scale(b, slope);
        let mean = x.flat_mean(b);
        let share = b.sub(mean, low);
        let part = b.mul(share, slope);
        out.mean = b.add(at_low, part);
        out.cell = None;
        out.binary = Some([at_low, at_high]);
        out.range = match [at_low, at_high].map(|v| b.as_constant(v)) {
            [Some(p), Some(q)] => ordered(p, q),
            _ => t.range(b, x.range),
        };
        out
    }
}

/// What is asked of a transfer beside the mean, the linear response and the distortion.
#[derive(Clone, Copy)]
struct Wants {
    /// The second order and the third cumulant.
    second: bool,
    /// The coefficient of the input's second Hermite symbol.
    hermite: bool,
    /// That the mean stays inside the bounds of T.
    bounded: bool,
}

impl Wants {
    fn bits(self) -> u32 {
        u32::from(self.second) | u32::from(self.hermite) << 1 | u32::from(self.bounded) << 2
    }
}

/// The inputs of [`through`]: m, g, H, the private variance, that of shared symbols, T's bounds.
const INPUTS: usize = 10;

/// T(X) without what shared symbols give.
fn through(
    b: &mut Builder,
    inputs: &[Value],
    range: [f32; 2],
    t: &dyn Transfer,
    wants: Wants,
) -> [(&'static str, Value); 10] {
    let [mean, g1, g2, h11, h12, h22, private, carried, from, to] = inputs else {
        panic!("{INPUTS} inputs")
    };
    let zero = b.f32(0.0);
    let x = Signal {
        g: [*g1, *g2],
        h: [*h11, *h12, *h22],
        private: *private,
        ..Signal::certain(b, *mean)
    };
    let linear = x.linear_variance(b);
    let other = x.other_variance(b);
    let other = b.add(other, *carried);
    let variance = b.add(linear, other);
    let (sd, inverse_sd) = spread(b, variance);
    let gaussian = Gaussian {
        mean: x.mean,
        variance,
        sd,
        inverse_sd,
        range,
    };
    let m = t.moments(b, &gaussian);
    let mut out = x.scale(b, m.slope);
    out.mean = m.mean;
    let kappa = x.third_cumulant(b, sd);
    if !b.is_zero(kappa) {
        let sixth = b.scale(kappa, 1.0 / 6.0);
        let correction = b.mul(sixth, m.third);
        out.mean = b.add(m.mean, correction);
        if wants.bounded {
            out.mean = b.max(out.mean, *from);
            out.mean = b.min(out.mean, *to);
        }
    }
    if wants.second {
        let outer = [b.square(*g1), b.mul(*g1, *g2), b.square(*g2)];
        for (h, o) in out.h.iter_mut().zip(outer) {
            let bent = b.mul(m.curvature, o);
            *h = b.add(*h, bent);
        }
    }
    // The second Hermite coefficient squared: v² E[T″]²/2, of which the second order carries
    // |g|⁴ E[T″]²/2. A footprint's fourth power overflows: the curvature goes to each factor.
    let mut hermite = zero;
    if wants.hermite {
        let left = if wants.second {
            let sum = b.add(variance, linear);
            let (sum, rest) = (b.sqrt(sum), b.sqrt(other));
            b.mul(sum, rest)
        } else {
            variance
        };
        hermite = b.mul(m.curvature, left);
        hermite = b.scale(hermite, std::f32::consts::FRAC_1_SQRT_2);
    }
    let mut distortion = m.distortion;
    if wants.hermite || wants.second {
        let explained = if wants.hermite { variance } else { linear };
        let second = b.mul(m.curvature, explained);
        let second = b.square(second);
        let second = b.scale(second, 0.5);
        distortion = b.sub(distortion, second);
        distortion = b.max(distortion, zero);
    }
    [
        ("mean", out.mean),
        ("gx", out.g[0]),
        ("gy", out.g[1]),
        ("hxx", out.h[0]),
        ("hxy", out.h[1]),
        ("hyy", out.h[2]),
        ("private", out.private),
        ("slope", m.slope),
        ("hermite", hermite),
        ("distortion", distortion),
    ]
}
