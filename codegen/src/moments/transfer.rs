//! Functions of one signal: Stein's slope, Bussgang's distortion, and the third cumulant.

use super::{
    Algebra, Mode, Signal, position,
    signal::{PARTS, UNBOUNDED, ordered},
    spread,
};
use crate::ir::{Float, SharedFunction, Sym2};
use smallvec::SmallVec;

/// The Gaussian that a transfer is averaged over.
#[derive(Clone, Copy, Debug)]
pub struct Gaussian<'b> {
    /// The mean m.
    pub mean: Float<'b>,
    /// The variance v.
    pub variance: Float<'b>,
    /// σ, at least 1e-6.
    pub sd: Float<'b>,
    /// 1/σ.
    pub inverse_sd: Float<'b>,
    /// The range of the input, as far as is known.
    pub range: [f32; 2],
}

/// The moments of T(X) for a Gaussian X.
#[derive(Clone, Copy, Debug)]
pub struct Moments<'b> {
    /// E[T].
    pub mean: Float<'b>,
    /// E[T′] = ∂E[T]/∂m (Stein).
    pub slope: Float<'b>,
    /// E[T″] = ∂²E[T]/∂m².
    pub curvature: Float<'b>,
    /// E[T‴] = ∂³E[T]/∂m³.
    pub third: Float<'b>,
    /// Var T − E[T′]² v, never negative (Bussgang).
    pub distortion: Float<'b>,
}

impl<'b> Moments<'b> {
    /// E[T] with its three derivatives by m, and the distortion.
    pub(super) fn of(
        [mean, slope, curvature, third]: [Float<'b>; 4],
        distortion: Float<'b>,
    ) -> Self {
        Self {
            mean,
            slope,
            curvature,
            third,
            distortion,
        }
    }
}

/// A function of one number, with its moments over a Gaussian.
pub trait Transfer<'b> {
    /// T(x).
    fn value(&self, x: Float<'b>) -> Float<'b>;
    /// The moments over a Gaussian.
    fn moments(&self, x: &Gaussian<'b>) -> Moments<'b>;
    /// The period, where the function has one: positions then give what is left of whole periods.
    fn period(&self) -> Option<f32> {
        None
    }
    /// The two values of a function that takes no others.
    fn binary(&self) -> Option<[f32; 2]> {
        None
    }
    /// The two values of a function that takes no others at any number of places.
    fn values(&self) -> Option<[f32; 2]> {
        self.binary()
    }
    /// Whether the value may jump, or rise without bound: what does not spread has one value, while a
    /// Gaussian of next to no width has both sides.
    fn is_steep(&self) -> bool {
        false
    }
    /// How many places the closed form adds a term for: where a table is cheaper depends on it.
    fn knots(&self) -> u32 {
        1
    }
    /// How the function is one of a family that shares its code, over an input within `range`;
    /// `None` builds it where it is used.
    fn shared(&self, _range: [f32; 2]) -> Option<SharedTransfer<'b>> {
        None
    }
    /// T′, where it is a function whose moments are known as well; what jumps has none.
    fn derivative(&self) -> Option<Box<dyn Transfer<'b> + 'b>> {
        None
    }
    /// The least and largest value on `[low, high]` (which may be infinite).
    fn range(&self, input: [f32; 2]) -> [f32; 2];
}

/// A transfer as a member of a family: the same code for other values.
#[derive(Debug)]
pub struct SharedTransfer<'b> {
    /// The family's name (an identifier in lower snake case).
    pub name: &'static str,
    /// One sentence that says what the family computes.
    pub doc: &'static str,
    /// What the code depends on beside the values, below 2²⁸.
    pub variant: u32,
    /// The values that tell the members apart.
    pub values: SmallVec<[Float<'b>; 16]>,
    /// The member of these values.
    pub rebuild: Rebuild,
}

/// Makes the member of a family from its variant and its values.
pub type Rebuild = for<'c> fn(variant: u32, values: &[Float<'c>]) -> Box<dyn Transfer<'c> + 'c>;

impl<'b> Algebra<'b> {
    /// T(X): mean E[T] + (κ₃/6) E[T‴] inside T's range, coefficients E[T′]·x, second order
    /// E[T′] H + E[T″] g gᵀ, and the distortion into a fresh ε (RULES: transfers, H and the third
    /// cumulant). Where several transfers read X, the second Hermite part of the distortion is
    /// shared among them.
    pub fn transfer(&mut self, x: &Signal<'b>, t: &dyn Transfer<'b>) -> Signal<'b> {
        let b = self.b;
        let range = t.range(x.range);
        // Whole periods do not matter, and a fraction keeps its detail far from the origin.
        let mean = match t.period() {
            Some(period) if x.cell.is_some() => position::modulo((x.cell, x.mean), period),
            _ => x.flat_mean(),
        };
        if !self.mode.spreads() || x.is_certain() {
            return Signal::certain(t.value(mean)).with_range(range);
        }
        let flat;
        let x = if x.cell.is_some() {
            flat = Signal {
                mean,
                cell: None,
                ..x.clone()
            };
            &flat
        } else {
            x
        };
        if let Some(values) = x.binary {
            return between(x, t, values);
        }
        let exposed;
        let mut x = x;
        let mut steepness = None;
        if self.derives() && x.slope.is_some() {
            // What T(X) and T′(X) have in common.
            exposed = self.expose(x);
            x = &exposed;
            steepness = Some(self.derivative(x, t));
        }
        let carries = self.mode == Mode::Quad;
        let shared = t.shared(x.range);
        // The mean can leave the range by the third cumulant alone.
        let bounded = carries && range[0].is_finite() && range[1].is_finite();
        let [from, to] = if bounded { range } else { [0.0; 2] }.map(|end| b.float(end));
        let mut inputs: SmallVec<[(&'static str, Float<'b>); 24]> =
            NAMES.into_iter().zip(x.parts()).collect();
        inputs.extend([("carried", x.shared_variance()), ("from", from), ("to", to)]);
        let wants = Wants {
            second: carries,
            hermite: x.hermite.is_some(),
            bounded,
            steep: t.is_steep(),
        };
        let results = match shared {
            Some(shared) => {
                inputs.extend(shared.values.iter().map(|&v| ("v", v)));
                let of = SharedFunction {
                    name: shared.name,
                    variant: shared.variant << 4 | wants.bits(),
                    doc: shared.doc,
                };
                b.shared(of, &inputs, |_, v| {
                    let t = (shared.rebuild)(shared.variant, &v[INPUTS..]);
                    through(&v[..INPUTS], UNBOUNDED, &*t, wants)
                })
            }
            None => {
                let values: SmallVec<[Float<'b>; INPUTS]> =
                    inputs.iter().map(|&(_, v)| v).collect();
                through(&values, x.range, t, wants).map(|(_, v)| v)
            }
        };
        let [parts @ .., slope, hermite, distortion] = results;
        if !distortion.is_zero() {
            self.bent = true;
            self.knots = self.knots.max(t.knots());
            self.period = t.period();
        }
        let mut out = Signal {
            shared: x.shared.iter().map(|&(s, c)| (s, c * slope)).collect(),
            range,
            binary: t.binary().map(|values| values.map(|v| b.float(v))),
            ..Signal::of_parts(parts)
        };
        if let Some(symbol) = x.hermite {
            out.push_shared(symbol, hermite);
        }
        self.attach_fresh(&mut out, distortion);
        if let (Some(steepness), Some(slope)) = (steepness, &x.slope) {
            out.slope = Some(self.bilinear(&[(&steepness, slope)]));
        }
        out
    }
}

/// T(X) of a signal that takes two values is linear in it: exact, whatever T is.
fn between<'b>(x: &Signal<'b>, t: &dyn Transfer<'b>, [low, high]: [Float<'b>; 2]) -> Signal<'b> {
    let (at_low, at_high) = (t.value(low), t.value(high));
    let span = high - low;
    // Two equal values are one: then the rise is 0 as well.
    let slope = (at_high - at_low) / span.abs().gt(0.0).select(span, 1.0);
    let range = match [at_low, at_high].map(|v| v.as_constant()) {
        [Some(p), Some(q)] => ordered(p, q),
        _ => t.range(x.range),
    };
    Signal {
        mean: at_low + (x.flat_mean() - low) * slope,
        cell: None,
        binary: Some([at_low, at_high]),
        range,
        ..x * slope
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
    /// The value itself where the input does not spread.
    steep: bool,
}

impl Wants {
    fn bits(self) -> u32 {
        let flags = [self.second, self.hermite, self.bounded, self.steep];
        let bit = |(place, flag): (usize, bool)| u32::from(flag) << place;
        flags.into_iter().enumerate().map(bit).sum()
    }
}

/// The least variance that is told from none: σ is a rounding of a position.
const NARROWEST: f32 = 1e-14;

/// The names of a signal's parts.
const NAMES: [&str; PARTS] = ["mean", "gx", "gy", "hxx", "hxy", "hyy", "private"];
/// The inputs of [`through`]: a signal's parts, the variance of shared symbols, T's bounds.
const INPUTS: usize = PARTS + 3;

/// The largest variance that a function is averaged over.
const WIDEST: f32 = 1e38;

/// T(X) without what shared symbols give.
fn through<'b>(
    inputs: &[Float<'b>],
    range: [f32; 2],
    t: &dyn Transfer<'b>,
    wants: Wants,
) -> [(&'static str, Float<'b>); PARTS + 3] {
    let [parts @ .., carried, from, to] =
        <[Float<'b>; INPUTS]>::try_from(inputs).expect("the inputs");
    let x = Signal::of_parts(parts);
    let linear = x.linear_variance();
    let other = x.other_variance() + carried;
    // A spread whose square is no number is as wide as one that is: the limit is the same.
    let variance = (linear + other).min(WIDEST);
    let (sd, inverse_sd) = spread(variance);
    let m = t.moments(&Gaussian {
        mean: x.mean,
        variance,
        sd,
        inverse_sd,
        range,
    });
    let mut out = &x * m.slope;
    out.mean = m.mean;
    let mut distortion = m.distortion;

    // The third cumulant.
    let skewness = x.skewness(inverse_sd);
    if !skewness.is_zero() {
        // (κ₃/6) E[T‴]: σ by σ, since σ³ alone overflows.
        out.mean = m.mean + skewness * (1.0 / 6.0) * m.third * sd * sd * sd;
        if wants.bounded {
            out.mean = out.mean.clamp(from, to);
        }
    }

    // The second order.
    if wants.second {
        // From the left: a footprint's square may overflow.
        let [gx, gy] = *x.g;
        let [curved_x, curved_y] = [m.curvature * gx, m.curvature * gy];
        out.h = out.h + Sym2([curved_x * gx, curved_x * gy, curved_y * gy]);
    }
    // The second Hermite coefficient squared: v² E[T″]²/2, of which the second order carries
    // |g|⁴ E[T″]²/2. A footprint's fourth power overflows: the curvature goes to each factor.
    let mut hermite = sd.literal(0.0);
    if wants.hermite {
        let left = if wants.second {
            (variance + linear).sqrt() * other.sqrt()
        } else {
            variance
        };
        hermite = m.curvature * left * std::f32::consts::FRAC_1_SQRT_2;
    }
    if wants.hermite || wants.second {
        let explained = if wants.hermite { variance } else { linear };
        distortion = (distortion - (m.curvature * explained).square() * 0.5).max(0.0);
    }

    if wants.steep {
        let spreads = variance.gt(NARROWEST);
        out.mean = spreads.select(out.mean, t.value(x.mean));
        distortion = spreads.select(distortion, 0.0);
    }

    let [mean, gx, gy, hxx, hxy, hyy, private] = out.parts();
    [
        ("mean", mean),
        ("gx", gx),
        ("gy", gy),
        ("hxx", hxx),
        ("hxy", hxy),
        ("hyy", hyy),
        ("private", private),
        ("slope", m.slope),
        ("hermite", hermite),
        ("distortion", distortion),
    ]
}
