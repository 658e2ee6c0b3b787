//! A periodic pulse: 1 around every period's centre, 0 elsewhere, with edges that may be ramps.

use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use mipless_codegen::moments::Normal;

/// A pulse in each of `repeat` equal parts of the unit interval, which itself repeats.
///
/// `half` and `bevel` are in parts: 0.5 is half the distance from a pulse to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pulse {
    /// How many there are in the unit interval, at least 1.
    pub(crate) repeat: f32,
    /// The centre of one, in the units of the part.
    pub(crate) centre: Value,
    /// From the centre to the middle of an edge, in [0, 0.5].
    pub(crate) half: Value,
    /// The width of an edge's ramp, at least 0.
    pub(crate) bevel: Value,
    /// Whether that is known to be at most [`SHORT_RAMP`].
    pub(crate) short: bool,
}

/// A coordinate within a footprint: a Gaussian.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axis {
    /// The mean.
    pub(crate) mean: Value,
    /// The standard deviation, at least 1e-6.
    pub(crate) sd: Value,
}

/// Where the two series meet, in parts.
const CROSSOVER: f32 = 0.11;

/// How many harmonics.
const HARMONICS: usize = 6;

/// Up to this width, in parts, what a ramp half a part away adds is below 1e-5.
pub(crate) const SHORT_RAMP: f32 = 0.15;

/// A ramp is at least this wide, and at least so many σ: its hinges then keep their digits.
const NARROWEST: f32 = 1e-4;

/// See [`NARROWEST`].
const NARROWEST_OF_SD: f32 = 0.02;

/// The mean over a Gaussian and its first three derivatives by the coordinate's mean, each times as many
/// σ.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moments {
    /// Of the pulse.
    pub(crate) own: [Value; 4],
    /// Of its square, where that is asked for.
    pub(crate) square: Option<[Value; 4]>,
}

/// What the code of a pulse depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shape {
    /// Half width and bevel, where they are constants.
    known: [Option<f32>; 2],
    short: bool,
    squared: bool,
}

/// The series of a module's pulses, edges and harmonics, as functions: of the two a footprint takes one.
#[derive(Default)]
pub(crate) struct Series(Vec<(Shape, [FunctionRef; 2])>);

impl Series {
    /// The functions for pulses of this shape.
    fn of(&mut self, module: &mut Module, shape: Shape) -> [FunctionRef; 2] {
        if let Some((_, known)) = self.0.iter().find(|(known, _)| *known == shape) {
            return known.clone();
        }
        let edges = ("pulse_edges", "A pulse by its edges.", Pulse::edges as Sum);
        let harmonics = (
            "pulse_harmonics",
            "A pulse by its harmonics.",
            Pulse::harmonics as Sum,
        );
        let functions =
            [edges, harmonics].map(|(name, doc, sum)| series(module, name, doc, shape, sum));
        self.0.push((shape, functions.clone()));
        functions
    }
}

/// The moments of a pulse at a distance under a standard deviation, the square's where that is set.
type Sum = fn(&Pulse, &mut Builder, Value, Value, bool) -> Moments;

/// A series as the body of a fold of at most one turn; captures: distance, σ, and what is not constant
/// of half width and bevel.
fn series(module: &mut Module, name: &str, doc: &str, shape: Shape, sum: Sum) -> FunctionRef {
    let names = &STATE[..if shape.squared { 8 } else { 4 }];
    let mut b = Builder::new(name, doc);
    b.param("index", Type::U32);
    for name in names {
        b.param_f32(format!("last_{name}"));
    }
    let (distance, sd) = (b.param_f32("distance"), b.param_f32("sd"));
    let [half, bevel] = [0, 1].map(|i| match shape.known[i] {
        Some(x) => b.f32(x),
        None => b.param_f32(["half", "bevel"][i]),
    });
    let pulse = Pulse {
        repeat: 1.0,
        centre: b.f32(0.0),
        half,
        bevel,
        short: shape.short,
    };
    let Moments { own, square } = sum(&pulse, &mut b, distance, sd, shape.squared);
    for (name, value) in names
        .iter()
        .zip(own.into_iter().chain(square.into_iter().flatten()))
    {
        b.result(*name, value);
    }
    b.finish(module)
}

/// Names of the moments.
const STATE: [&str; 8] = [
    "mean",
    "slope",
    "bend",
    "third",
    "square",
    "square_slope",
    "square_bend",
    "square_third",
];

impl Pulse {
    /// The signed distance from the nearest centre, in [−½, ½], and its magnitude.
    fn folded(&self, b: &mut Builder, x: Value) -> [Value; 2] {
        let scaled = b.scale(x, self.repeat);
        let from = b.sub(scaled, self.centre);
        let rounded = b.offset(from, 0.5);
        let rounded = b.floor(rounded);
        let signed = b.sub(from, rounded);
        [signed, b.abs(signed)]
    }

    /// The value at x.
    pub(crate) fn value(&self, b: &mut Builder, x: Value) -> Value {
        let [_, distance] = self.folded(b, x);
        let inside = b.sub(self.half, distance);
        let zero = b.f32(0.0);
        if b.is_zero(self.bevel) {
            let (on, one) = (b.lt(zero, inside), b.f32(1.0));
            return b.select(on, one, zero);
        }
        let narrowest = b.f32(NARROWEST);
        let bevel = b.max(self.bevel, narrowest);
        let share = b.div(inside, bevel);
        let share = b.offset(share, 0.5);
        b.clamp(share, 0.0, 1.0)
    }

    /// The moments of the pulse, and of its square if that is asked for: edges one by one up to σ = 0.11
    /// parts (those left out are half a part away, beyond 4.5 σ: 3e-6), six damped harmonics beyond
    /// (those left out are below 1e-6).
    pub(crate) fn moments(
        &self,
        b: &mut Builder,
        (module, series): (&mut Module, &mut Series),
        axis: Axis,
        squared: bool,
    ) -> Moments {
        let [signed, distance] = self.folded(b, axis.mean);
        let sd = b.scale(axis.sd, self.repeat);
        let known = [self.half, self.bevel].map(|v| b.as_constant(v));
        let shape = Shape {
            known,
            short: self.short,
            squared,
        };
        let [edges, harmonics] = series.of(module, shape);
        let mut captures = vec![distance, sd];
        let shapes = known.iter().zip([self.half, self.bevel]);
        captures.extend(shapes.filter(|(known, _)| known.is_none()).map(|(_, v)| v));
        let crossover = b.f32(CROSSOVER);
        let narrow = b.lt(sd, crossover);
        let (none, once, nothing) = (b.u32(0), b.u32(1), b.f32(0.0));
        let counts = [b.select(narrow, once, none), b.select(narrow, none, once)];
        let state = vec![nothing; if squared { 8 } else { 4 }];
        let near = b.fold(&edges, counts[0], &state, &captures);
        let far = b.fold(&harmonics, counts[1], &state, &captures);
        // The distance is the coordinate or its negative.
        let (zero, one, minus) = (b.f32(0.0), b.f32(1.0), b.f32(-1.0));
        let left = b.lt(signed, zero);
        let sign = b.select(left, minus, one);
        let mut part = |from: usize| {
            let mut out = [0, 1, 2, 3].map(|i| b.add(near[from + i], far[from + i]));
            out[0] = b.clamp(out[0], 0.0, 1.0);
            for i in [1, 3] {
                out[i] = b.mul(sign, out[i]);
            }
            out
        };
        Moments {
            own: part(0),
            square: squared.then(|| part(4)),
        }
    }

    /// The edges at −h, h and 1 − h, seen from a distance in [0, ½]. Of the two that rise one is more than
    /// half a part away, and left out unless its ramp may come nearer.
    fn edges(&self, b: &mut Builder, distance: Value, sd: Value, squared: bool) -> Moments {
        let one = b.f32(1.0);
        let inverse = b.div(one, sd);
        let (below, above) = (b.sub(distance, self.half), b.add(distance, self.half));
        let next = b.offset(above, -1.0);
        let falling = self.edge(b, below, sd, inverse, squared);
        let (rising, passed) = if self.short {
            let (middle, zero) = (b.f32(0.5), b.f32(0.0));
            let is_own = b.lt(above, middle);
            let from = b.select(is_own, above, next);
            // What lies behind the next pulse's edge lies behind this one's, too.
            let passed = b.select(is_own, zero, one);
            (vec![self.edge(b, from, sd, inverse, squared)], Some(passed))
        } else {
            let rising = [above, next].map(|from| self.edge(b, from, sd, inverse, squared));
            (rising.to_vec(), None)
        };
        let joined = |b: &mut Builder, rising: &[[Value; 4]], falling: [Value; 4]| {
            let mut out = rising[0];
            for more in &rising[1..] {
                out = [0, 1, 2, 3].map(|i| b.add(out[i], more[i]));
            }
            let mut out = [0, 1, 2, 3].map(|i| b.sub(out[i], falling[i]));
            if let Some(passed) = passed {
                out[0] = b.add(out[0], passed);
            }
            out
        };
        let own: Vec<[Value; 4]> = rising.iter().map(|edge| edge.own).collect();
        let own = joined(b, &own, falling.own);
        let squares: Option<Vec<[Value; 4]>> = rising.iter().map(|edge| edge.square).collect();
        let square = squares.zip(falling.square).map(|(rising, square)| {
            // A falling edge is 1 − R, whose square is 1 − (2R − R²).
            let falls = [0, 1, 2, 3].map(|i| {
                let twice = b.add(falling.own[i], falling.own[i]);
                b.sub(twice, square[i])
            });
            joined(b, &rising, falls)
        });
        Moments { own, square }
    }

    /// A rising edge at a distance.
    fn edge(
        &self,
        b: &mut Builder,
        from: Value,
        sd: Value,
        inverse: Value,
        squared: bool,
    ) -> Moments {
        if b.is_zero(self.bevel) {
            let n = Normal::at(b, from, inverse);
            let curved = b.mul(n.z, n.density);
            let square = b.square(n.z);
            let square = b.offset(square, -1.0);
            let third = b.mul(square, n.density);
            let own = [n.below, n.density, b.neg(curved), third];
            // A step is its own square.
            let square = squared.then_some(own);
            return Moments { own, square };
        }
        // (E[max(x + w/2, 0)] − E[max(x − w/2, 0)])/w.
        let narrowest = b.f32(NARROWEST);
        let least = b.scale(sd, NARROWEST_OF_SD);
        let width = b.max(self.bevel, narrowest);
        let width = b.max(width, least);
        let half = b.scale(width, 0.5);
        let one = b.f32(1.0);
        let inverse_width = b.div(one, width);
        let (start, end) = (b.add(from, half), b.sub(from, half));
        let (n, m) = (Normal::at(b, start, inverse), Normal::at(b, end, inverse));
        let (up, down) = (n.hinge(b, start, sd), m.hinge(b, end, sd));
        let mean = b.sub(up, down);
        let mean = b.mul(mean, inverse_width);
        // Beyond the ramp two large hinges differ by its width, less their roundings.
        let far = b.f32(6.0);
        let passed = b.lt(far, m.z);
        let mean = b.select(passed, one, mean);
        let ratio = b.mul(sd, inverse_width);
        let slope = b.sub(n.below, m.below);
        let curved = b.sub(n.density, m.density);
        let (rise, fall) = (b.mul(n.z, n.density), b.mul(m.z, m.density));
        let third = b.sub(fall, rise);
        let own = [
            mean,
            b.mul(slope, ratio),
            b.mul(curved, ratio),
            b.mul(third, ratio),
        ];
        let square = squared.then(|| {
            // With s and e the coordinates at the start and the end, E[R²] = (E[s₊²] − E[e₊²])/w² −
            // 2E[e₊]/w, where E[s₊²] = s E[s₊] + σ²Φ(s/σ); its derivative is 2σ(E[R] − Φ(e/σ))/w.
            let along = b.mul(end, mean);
            let spread = b.mul(sd, own[1]);
            let sum = b.add(along, spread);
            let sum = b.sub(sum, down);
            let wide = b.mul(sum, inverse_width);
            // Of a ramp of δ = w/σ ≤ 1 that leaves no digits. There E[R²] − E[R] = −δ ∫₀¹ t(1 − t) φ(s/σ −
            // tδ) dt, to 1.3e-5 by the density and two derivatives at both ends.
            let delta = b.mul(width, inverse);
            let (n_bend, m_bend) = (b.mul(n.z, rise), b.mul(m.z, fall));
            let bends = b.add(n_bend, m_bend);
            let values = b.add(n.density, m.density);
            let bends = b.sub(bends, values);
            let slopes = b.sub(rise, fall);
            let inner = b.scale(bends, 1.0 / 560.0);
            let inner = b.mul(inner, delta);
            let slopes = b.scale(slopes, 17.0 / 840.0);
            let inner = b.add(inner, slopes);
            let inner = b.mul(inner, delta);
            let values = b.scale(values, 1.0 / 12.0);
            let inner = b.add(inner, values);
            let narrow = b.mul(inner, delta);
            let narrow = b.neg(narrow);
            let is_narrow = b.lt(delta, one);
            let more = b.select(is_narrow, narrow, wide);
            let value = b.add(mean, more);
            let value = b.select(passed, one, value);
            let twice = b.add(ratio, ratio);
            let slope = b.sub(mean, m.below);
            let bend = b.sub(own[1], m.density);
            let third = b.add(own[2], fall);
            [
                value,
                b.mul(twice, slope),
                b.mul(twice, bend),
                b.mul(twice, third),
            ]
        });
        Moments { own, square }
    }

    /// 2h + Σ 2/(πk) sin(2πkh) sinc(kw) e^{−2π²k²σ²} cos(2πkx). The square is taken for a pulse whose ramps
    /// begin w/6 later and have the spread of a squared ramp's derivative, 0.816 of the ramp's.
    fn harmonics(&self, b: &mut Builder, distance: Value, sd: Value, squared: bool) -> Moments {
        use std::f32::consts::PI;
        let variance = b.square(sd);
        let exponent = b.scale(variance, -2.0 * PI * PI);
        let exponent = b.clamp(exponent, -40.0, 0.0);
        let first = b.exp(exponent);
        let square = b.square(first);
        // qᵏ²: each is the one before times q²ᵏ⁺¹.
        let (mut damping, mut step) = (first, b.mul(square, first));
        let place = b.circle(distance);
        let place = b.multiples::<HARMONICS>(place);
        let mut waves = [place[0]; HARMONICS];
        for (wave, place) in waves.iter_mut().zip(place) {
            *wave = place.map(|part| b.mul(damping, part));
            damping = b.mul(damping, step);
            step = b.mul(step, square);
        }
        let own = self.summed(b, sd, &waves);
        let square = squared.then(|| {
            if b.is_zero(self.bevel) {
                return own;
            }
            let later = b.scale(self.bevel, -1.0 / 6.0);
            let squared = Self {
                half: b.add(self.half, later),
                bevel: b.scale(self.bevel, 0.816_496_6),
                ..*self
            };
            squared.summed(b, sd, &waves)
        });
        Moments { own, square }
    }

    /// The sum over damped waves at the place.
    fn summed(&self, b: &mut Builder, sd: Value, waves: &[[Value; 2]; HARMONICS]) -> [Value; 4] {
        use std::f32::consts::{PI, TAU};
        let edge = b.circle(self.half);
        let edge = b.multiples::<HARMONICS>(edge);
        let ramp = (!b.is_zero(self.bevel)).then(|| {
            let least = b.f32(NARROWEST);
            let width = b.max(self.bevel, least);
            let half = b.scale(width, 0.5);
            let turned = b.circle(half);
            let one = b.f32(1.0);
            (b.multiples::<HARMONICS>(turned), b.div(one, width))
        });
        let zero = b.f32(0.0);
        let mut sums = [zero; 4];
        for (i, wave) in waves.iter().enumerate() {
            let k = (i + 1) as f32;
            let mut amplitude = edge[i][1];
            let mut factor = 2.0 / (PI * k);
            if let Some((ramp, inverse)) = ramp {
                let sinc = b.mul(ramp[i][1], inverse);
                amplitude = b.mul(amplitude, sinc);
                factor /= PI * k;
            }
            let parts = wave.map(|part| b.mul(amplitude, part));
            for (order, sum) in sums.iter_mut().enumerate() {
                let part = b.scale(parts[order % 2], factor * k.powi(order as i32));
                *sum = b.add(*sum, part);
            }
        }
        let width = b.add(self.half, self.half);
        let once = b.scale(sd, TAU);
        let twice = b.square(once);
        let thrice = b.mul(twice, once);
        let (back, curved) = (b.mul(sums[1], once), b.mul(sums[2], twice));
        [
            b.add(width, sums[0]),
            b.neg(back),
            b.neg(curved),
            b.mul(sums[3], thrice),
        ]
    }
}
