//! A periodic pulse: 1 around every period's centre, 0 elsewhere, with edges that may be ramps.

use mipless_codegen::ir::{Builder, Float, FunctionRef, Module, multiples};
use mipless_codegen::moments::Normal;
use std::array;

/// A pulse in each of `repeat` equal parts of the unit interval, which itself repeats.
///
/// `half` and `bevel` are in parts: 0.5 is half the distance from a pulse to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pulse<'b> {
    /// How many there are in the unit interval, at least 1.
    pub(crate) repeat: f32,
    /// The centre of one, in the units of the part.
    pub(crate) centre: Float<'b>,
    /// From the centre to the middle of an edge, in [0, 0.5].
    pub(crate) half: Float<'b>,
    /// The width of an edge's ramp, at least 0.
    pub(crate) bevel: Float<'b>,
    /// Whether that is known to be at most [`SHORT_RAMP`].
    pub(crate) short: bool,
}

/// A coordinate within a footprint: a Gaussian.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axis<'b> {
    /// The mean.
    pub(crate) mean: Float<'b>,
    /// The standard deviation, at least 1e-6.
    pub(crate) sd: Float<'b>,
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
pub(crate) type Derivatives<'b> = [Float<'b>; 4];

/// The derivatives of the mean of a pulse.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moments<'b> {
    /// Of the pulse.
    pub(crate) own: Derivatives<'b>,
    /// Of its square, where that is asked for.
    pub(crate) square: Option<Derivatives<'b>>,
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
        let mut series = |name, doc, sum: Sum| series(module, name, doc, shape, sum);
        let functions = [
            series(
                "pulse_edges",
                "A pulse by its edges.",
                |pulse, at, sd, squared| pulse.edges(at, sd, squared),
            ),
            series(
                "pulse_harmonics",
                "A pulse by its harmonics.",
                |pulse, at, sd, squared| pulse.harmonics(at, sd, squared),
            ),
        ];
        self.0.push((shape, functions.clone()));
        functions
    }
}

/// The moments of a pulse at a distance under a standard deviation, the square's where that is set.
type Sum = for<'b> fn(&Pulse<'b>, Float<'b>, Float<'b>, bool) -> Moments<'b>;

/// A series as the body of a fold of at most one turn; captures: distance, σ, and what is not constant
/// of half width and bevel.
fn series(module: &mut Module, name: &str, doc: &str, shape: Shape, sum: Sum) -> FunctionRef {
    let names = &STATE[..if shape.squared { 8 } else { 4 }];
    let b = &Builder::new(name, doc);
    b.uint_param("index");
    for name in names {
        b.float_param(format!("last_{name}"));
    }
    let [distance, sd] = b.float_params(["distance", "sd"]);
    let [half, bevel] = [(0, "half"), (1, "bevel")].map(|(i, name)| match shape.known[i] {
        Some(x) => b.float(x),
        None => b.float_param(name),
    });
    let pulse = Pulse {
        repeat: 1.0,
        centre: b.float(0.0),
        half,
        bevel,
        short: shape.short,
    };
    let Moments { own, square } = sum(&pulse, distance, sd, shape.squared);
    let values = own.into_iter().chain(square.into_iter().flatten());
    b.results(names.iter().copied(), values);
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

impl<'b> Pulse<'b> {
    /// The signed distance from the nearest centre, in [−½, ½].
    fn folded(&self, x: Float<'b>) -> Float<'b> {
        let from = x * self.repeat - self.centre;
        from - (from + 0.5).floor()
    }

    /// The value at x.
    pub(crate) fn value(&self, x: Float<'b>) -> Float<'b> {
        let inside = self.half - self.folded(x).abs();
        if self.bevel.is_zero() {
            return inside.gt(0.0).select(1.0, 0.0);
        }
        (inside / self.bevel.max(NARROWEST) + 0.5).clamp(0.0, 1.0)
    }

    /// The moments of the pulse, and of its square if that is asked for: edges one by one up to σ = 0.11
    /// parts (those left out are half a part away, beyond 4.5 σ: 3e-6), six damped harmonics beyond
    /// (those left out are below 1e-6).
    pub(crate) fn moments(
        &self,
        (module, series): (&mut Module, &mut Series),
        axis: Axis<'b>,
        squared: bool,
    ) -> Moments<'b> {
        let b = axis.mean.builder();
        let signed = self.folded(axis.mean);
        let sd = axis.sd * self.repeat;
        let known = [self.half, self.bevel].map(|v| v.as_constant());
        let shape = Shape {
            known,
            short: self.short,
            squared,
        };
        let [edges, harmonics] = series.of(module, shape);
        let live = [self.half, self.bevel].map(|v| v.as_constant().is_none().then_some(v));
        let captures = (signed.abs(), sd, live);
        let narrow = sd.lt(CROSSOVER);
        let none = vec![b.float(0.0); if squared { 8 } else { 4 }];
        let near = b.fold(&edges, narrow.select(1u32, 0u32), none.clone(), captures);
        let far = b.fold(&harmonics, narrow.select(0u32, 1u32), none, captures);
        // The distance is the coordinate or its negative.
        let sign = signed.lt(0.0).select(-1.0, 1.0);
        let part = |from: usize| {
            let [mean, slope, bend, third] = array::from_fn(|i| near[from + i] + far[from + i]);
            [mean.clamp(0.0, 1.0), sign * slope, bend, sign * third]
        };
        Moments {
            own: part(0),
            square: squared.then(|| part(4)),
        }
    }

    /// The edges at −h, h and 1 − h, seen from a distance in [0, ½]. Of the two that rise one is more than
    /// half a part away, and left out unless its ramp may come nearer.
    fn edges(&self, distance: Float<'b>, sd: Float<'b>, squared: bool) -> Moments<'b> {
        let inverse = 1.0 / sd;
        let (below, above) = (distance - self.half, distance + self.half);
        let next = above + -1.0;
        let falling = self.edge(below, sd, inverse, squared);
        let (rising, passed) = if self.short {
            let is_own = above.lt(0.5);
            let from = is_own.select(above, next);
            // What lies behind the next pulse's edge lies behind this one's, too.
            let passed = is_own.select(0.0, 1.0);
            (vec![self.edge(from, sd, inverse, squared)], Some(passed))
        } else {
            let rising = [above, next].map(|from| self.edge(from, sd, inverse, squared));
            (rising.to_vec(), None)
        };
        let joined = |rising: &[Derivatives<'b>], falling: Derivatives<'b>| {
            let mut out: Derivatives<'b> = array::from_fn(|i| {
                let sum = rising
                    .iter()
                    .map(|edge| edge[i])
                    .reduce(|sum, more| sum + more);
                sum.expect("an edge rises") - falling[i]
            });
            if let Some(passed) = passed {
                out[0] += passed;
            }
            out
        };
        let own: Vec<Derivatives<'b>> = rising.iter().map(|edge| edge.own).collect();
        let squares: Option<Vec<Derivatives<'b>>> = rising.iter().map(|edge| edge.square).collect();
        let square = squares.zip(falling.square).map(|(rising, square)| {
            // A falling edge is 1 − R, whose square is 1 − (2R − R²).
            let falls = array::from_fn(|i| falling.own[i] + falling.own[i] - square[i]);
            joined(&rising, falls)
        });
        Moments {
            own: joined(&own, falling.own),
            square,
        }
    }

    /// A rising edge at a distance.
    fn edge(
        &self,
        from: Float<'b>,
        sd: Float<'b>,
        inverse: Float<'b>,
        squared: bool,
    ) -> Moments<'b> {
        if self.bevel.is_zero() {
            let n = Normal::at(from, inverse);
            let third = (n.z.square() + -1.0) * n.density;
            let own = [n.below, n.density, -(n.z * n.density), third];
            // A step is its own square.
            let square = squared.then_some(own);
            return Moments { own, square };
        }
        // (E[max(x + w/2, 0)] − E[max(x − w/2, 0)])/w.
        let width = self.bevel.max(NARROWEST).max(sd * NARROWEST_OF_SD);
        let half = width * 0.5;
        let inverse_width = 1.0 / width;
        let (start, end) = (from + half, from - half);
        let [n, m] = [start, end].map(|place| Normal::at(place, inverse));
        let down = m.hinge(end, sd);
        let mean = (n.hinge(start, sd) - down) * inverse_width;
        // Beyond the ramp two large hinges differ by its width, less their roundings.
        let passed = m.z.gt(6.0);
        let mean = passed.select(1.0, mean);
        let ratio = sd * inverse_width;
        let (rise, fall) = (n.z * n.density, m.z * m.density);
        let own = [
            mean,
            (n.below - m.below) * ratio,
            (n.density - m.density) * ratio,
            (fall - rise) * ratio,
        ];
        let square = squared.then(|| {
            // With s and e the coordinates at the start and the end, E[R²] = (E[s₊²] − E[e₊²])/w² −
            // 2E[e₊]/w, where E[s₊²] = s E[s₊] + σ²Φ(s/σ); its derivative is 2σ(E[R] − Φ(e/σ))/w.
            let wide = (end * mean + sd * own[1] - down) * inverse_width;
            // Of a ramp of δ = w/σ ≤ 1 that leaves no digits. There E[R²] − E[R] = −δ ∫₀¹ t(1 − t) φ(s/σ −
            // tδ) dt, to 1.3e-5 by the density and two derivatives at both ends.
            let delta = width * inverse;
            let values = n.density + m.density;
            let slopes = rise - fall;
            let bends = n.z * rise + m.z * fall - values;
            let inner = bends * (1.0 / 560.0) * delta + slopes * (17.0 / 840.0);
            let narrow = -((inner * delta + values * (1.0 / 12.0)) * delta);
            let value = mean + delta.lt(1.0).select(narrow, wide);
            let twice = ratio + ratio;
            [
                passed.select(1.0, value),
                twice * (mean - m.below),
                twice * (own[1] - m.density),
                twice * (own[2] + fall),
            ]
        });
        Moments { own, square }
    }

    /// 2h + Σ 2/(πk) sin(2πkh) sinc(kw) e^{−2π²k²σ²} cos(2πkx). The square is taken for a pulse whose ramps
    /// begin w/6 later and have the spread of a squared ramp's derivative, 0.816 of the ramp's.
    fn harmonics(&self, distance: Float<'b>, sd: Float<'b>, squared: bool) -> Moments<'b> {
        use std::f32::consts::PI;
        let first = (sd.square() * (-2.0 * PI * PI)).clamp(-40.0, 0.0).exp();
        let square = first.square();
        // qᵏ²: each is the one before times q²ᵏ⁺¹.
        let (mut damping, mut step) = (first, square * first);
        let waves = multiples::<HARMONICS>(distance.circle()).map(|place| {
            let wave = place.map(|part| damping * part);
            damping *= step;
            step *= square;
            wave
        });
        let own = self.summed(sd, &waves);
        let square = squared.then(|| {
            if self.bevel.is_zero() {
                return own;
            }
            let squared = Self {
                half: self.half + self.bevel * (-1.0 / 6.0),
                bevel: self.bevel * 0.816_496_6,
                ..*self
            };
            squared.summed(sd, &waves)
        });
        Moments { own, square }
    }

    /// The sum over damped waves at the place.
    fn summed(&self, sd: Float<'b>, waves: &[[Float<'b>; 2]; HARMONICS]) -> Derivatives<'b> {
        use std::f32::consts::{PI, TAU};
        let edge = multiples::<HARMONICS>(self.half.circle());
        let ramp = (!self.bevel.is_zero()).then(|| {
            let width = self.bevel.max(NARROWEST);
            let ramp = multiples::<HARMONICS>((width * 0.5).circle());
            (ramp, 1.0 / width)
        });
        let mut sums = [sd.literal(0.0); 4];
        for (i, wave) in waves.iter().enumerate() {
            let k = (i + 1) as f32;
            let mut amplitude = edge[i][1];
            let mut factor = 2.0 / (PI * k);
            if let Some((ramp, inverse)) = ramp {
                amplitude *= ramp[i][1] * inverse;
                factor /= PI * k;
            }
            let parts = wave.map(|part| amplitude * part);
            for (order, sum) in sums.iter_mut().enumerate() {
                *sum += parts[order % 2] * (factor * k.powi(order as i32));
            }
        }
        let once = sd * TAU;
        let twice = once.square();
        [
            self.half + self.half + sums[0],
            -(sums[1] * once),
            -(sums[2] * twice),
            sums[3] * (twice * once),
        ]
    }
}
