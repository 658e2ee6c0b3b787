//! The laws of composition: what holds for every graph that the check accepts, whoever wrote it.

use super::random::Random;
use super::tolerance::{FAR_FIELD, LEFT_OUT, RANGE, ROUNDING, SPREAD, VANISHING};
use crate::target::{Target, validate};
use crate::wgsl::{Entry, emit};
use crate::{Footprint, Method, Options, Program, Texture};
use mipless_codegen::cpu::eval_program;
use mipless_codegen::ir::verify;
use mipless_graph::Node;
use std::any::Any;
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::LazyLock;

/// A law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Law {
    /// Nothing panics.
    Panics,
    /// The IR is valid.
    Ir,
    /// The shader is valid, and translates to every target.
    Shader,
    /// No number is infinite or none.
    Finite,
    /// No variance is negative.
    Variance,
    /// A bounded node's mean lies within its bounds.
    Range,
    /// A bounded node's variance is one that numbers within its bounds can have.
    Spread,
    /// A vanishing footprint gives the point's value.
    Vanishing,
    /// Large footprints all give the same, if points spread over them see the same.
    Far,
    /// f32 gives what f64 does, where small changes of the place change little.
    Rounding,
    /// `auto` is no further from the truth than a point is, but for what the truth itself is off. The
    /// suite of this project holds it over its pictures; [`violations`] leaves it out.
    Worse,
    /// The mean of a function of a Gaussian signal keeps the heat equation, ∂E/∂v = ½ ∂²E/∂m².
    Heat,
    /// What a node and its inputs have in common is a covariance: Var(X + Y) + Var(X − Y) is
    /// 2 Var X + 2 Var Y, and none of them is negative.
    Covariance,
}

impl Law {
    /// All of them.
    pub const ALL: [Self; 13] = [
        Self::Panics,
        Self::Ir,
        Self::Shader,
        Self::Finite,
        Self::Variance,
        Self::Range,
        Self::Spread,
        Self::Vanishing,
        Self::Far,
        Self::Rounding,
        Self::Worse,
        Self::Heat,
        Self::Covariance,
    ];

    /// One word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Panics => "panics",
            Self::Ir => "ir",
            Self::Shader => "shader",
            Self::Finite => "finite",
            Self::Variance => "variance",
            Self::Range => "range",
            Self::Spread => "spread",
            Self::Vanishing => "vanishing",
            Self::Far => "far",
            Self::Rounding => "rounding",
            Self::Worse => "worse",
            Self::Heat => "heat",
            Self::Covariance => "covariance",
        }
    }
}

/// A law that a graph breaks.
#[derive(Clone, Debug)]
pub struct Violation {
    /// The law.
    pub law: Law,
    /// By which method.
    pub method: Method,
    /// What was found.
    pub what: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} by {}: {}", self.law.name(), self.method, self.what)
    }
}

/// Bounds of each component that a node gives, whatever it is given, where it has any.
pub type Bounds<'a> = &'a (dyn Fn(&Node) -> Option<Vec<[f32; 2]>> + Sync);

/// What a graph breaks of these laws, by these methods. Panics are always found.
///
/// [`Law::Worse`], [`Law::Heat`] and [`Law::Covariance`] are no laws of a graph alone, and are not looked at.
pub fn violations(
    texture: &Texture,
    laws: &[Law],
    methods: &[Method],
    bounds: Bounds<'_>,
) -> Vec<Violation> {
    let asked = |law: Law| laws.contains(&law);
    let mut all = Vec::new();
    // What the filters are compared with.
    let mut points = None;
    if asked(Law::Vanishing) || asked(Law::Far) {
        all.extend(watched(Method::Point, |_| {
            points = Some(Points::of(texture))
        }));
    }
    for &method in methods {
        all.extend(watched(method, |report| {
            let program = compile(texture, method);
            if asked(Law::Ir)
                && let Err(violations) = verify(&program.module)
            {
                report(Law::Ir, violations[0].to_string());
                return;
            }
            if asked(Law::Shader) {
                shaders(&program, report);
            }
            let evaluated = Evaluated::of(texture, &program, method, bounds);
            for &law in laws {
                let faults = match (law, &points) {
                    (Law::Finite, _) => evaluated.infinite(),
                    (Law::Variance, _) => evaluated.negative(),
                    (Law::Range, _) => evaluated.outside(),
                    (Law::Spread, _) => evaluated.spread(),
                    (Law::Rounding, _) => evaluated.rounded(),
                    (Law::Vanishing, Some(points)) => evaluated.at_points(points),
                    (Law::Far, Some(points)) => evaluated.far(points),
                    _ => continue,
                };
                if let Some(fault) = faults.first() {
                    report(law, format!("{fault}, and {} more", faults.len() - 1));
                }
            }
        }));
    }
    all
}

/// What `laws` reports, and a panic if there is one.
pub(super) fn watched(method: Method, laws: impl FnOnce(&mut Report<'_>)) -> Vec<Violation> {
    let mut found = Vec::new();
    let mut report = |law, what| found.push(Violation { law, method, what });
    let ran = catch_unwind(AssertUnwindSafe(|| laws(&mut report)));
    if let Err(payload) = ran {
        report(Law::Panics, said(&*payload));
    }
    found
}

/// Takes a law that is broken, and what was found.
pub(super) type Report<'a> = dyn FnMut(Law, String) + 'a;

/// What a panic says.
fn said(payload: &(dyn Any + Send)) -> String {
    let text = payload
        .downcast_ref::<&str>()
        .map(|text| (*text).to_owned());
    let text = text.or_else(|| payload.downcast_ref::<String>().cloned());
    text.unwrap_or_else(|| "something that is no text".to_owned())
}

/// The defaults of a program's parameters, one number a component.
fn defaults(program: &Program) -> Vec<f32> {
    let parameters = program.interface.parameters.iter();
    parameters.flat_map(|p| p.default.clone()).collect()
}

fn compile(texture: &Texture, method: Method) -> Program {
    texture.compile(&Options {
        method,
        moments: true,
        ..Options::default()
    })
}

/// The program's shaders are valid and translate.
fn shaders(program: &Program, report: &mut Report<'_>) {
    let bare = emit(program, &Entry::None.into());
    if let Err(error) = validate(&bare.source) {
        report(Law::Shader, error.to_string());
        return;
    }
    for entry in [Entry::Fragment, Entry::Compute] {
        let shader = emit(program, &entry.into());
        let validated = match validate(&shader.source) {
            Ok(validated) => validated,
            Err(error) => return report(Law::Shader, error.to_string()),
        };
        for target in Target::ALL {
            if target.refuses(&shader).is_some() {
                continue;
            }
            if let Err(error) = validated.translate(&shader, target) {
                return report(Law::Shader, format!("{}: {error}", target.name()));
            }
        }
    }
}

fn round(cell: [i32; 2], uv: [f32; 2], size: f32) -> Footprint {
    let (du, dv) = ([size, 0.0], [0.0, size]);
    Footprint { cell, uv, du, dv }
}

/// Footprints from 1e-6 to 1e6: round, eight times as long as wide and askew, a line, at the origin,
/// at random places and a million units away.
static FOOTPRINTS: LazyLock<Vec<Footprint>> = LazyLock::new(|| {
    let mut random = Random::new(7);
    let mut all = Vec::new();
    for size in [1e-6, 1e-4, 0.01, 0.1, 0.7, 10.0, 1e3, 1e6] {
        for origin in 0..4 {
            let cell = match origin {
                0 => [0, 0],
                1 => [1_000_000, -1_000_000],
                _ => [0, 1].map(|_| random.within(-20.0, 20.0) as i32),
            };
            let uv = [0, 1].map(|_| random.unit() as f32);
            let place = round(cell, uv, size);
            let narrow = size / 8.0;
            let [sin, cos] = [0.6, 0.8];
            all.push(place);
            all.push(Footprint {
                du: [cos * size, sin * size],
                dv: [-sin * narrow, cos * narrow],
                ..place
            });
            all.push(Footprint {
                dv: [0.0, 0.0],
                ..place
            });
            all.push(Footprint {
                du: [size, -0.7 * size],
                dv: [-size, 0.7 * size],
                ..place
            });
        }
    }
    all
});

/// Places without a footprint, none of which lies on a round number.
static PLACES: LazyLock<Vec<Footprint>> = LazyLock::new(|| {
    let mut random = Random::new(8);
    let place = |_| {
        let cell = [0, 1].map(|_| random.within(-4.0, 4.0).floor() as i32);
        round(cell, [0, 1].map(|_| random.unit() as f32), 0.0)
    };
    (0..2 * 128).map(place).collect()
});

/// The pixels of the far field; the pixel filter's standard deviation is half a pixel.
const FAR: [f32; 2] = [1e4, 1e5];

/// Places that are spread as the filter of a far pixel is.
fn spread(pixel: f32) -> Vec<Footprint> {
    let mut random = Random::new(9);
    let place = |_| {
        let [x, y] = random.normal_pair().map(|z| 0.5 * z * f64::from(pixel));
        let cell = [x, y].map(|x| x.floor() as i32);
        round(cell, [x, y].map(|x| (x - x.floor()) as f32), 0.0)
    };
    (0..3 * 128).map(place).collect()
}

/// What points see, and what of it can be relied on.
struct Points {
    /// Of each component of the outputs at each of [`PLACES`].
    values: Vec<Vec<f32>>,
    /// Whether f32 knows that value.
    known: Vec<Vec<bool>>,
    /// Of each component: the extent of its values over far pixels, if it is the same for all.
    far: Vec<Option<f64>>,
}

impl Points {
    fn of(texture: &Texture) -> Self {
        let program = compile(texture, Method::Point);
        let parameters = defaults(&program);
        let values: Vec<Vec<f32>> = eval_program(&program, &PLACES, &parameters);
        let exact: Vec<Vec<f64>> = eval_program(&program, &PLACES, &parameters);
        let components = values.len() / 2;
        let known = (values.iter().zip(&exact))
            .map(|(values, exact)| {
                let near = |(&x, &y): (&f32, &f64)| {
                    (f64::from(x) - y).abs() <= 0.1 * VANISHING * y.abs().max(1.0)
                };
                values.iter().zip(exact).map(near).collect()
            })
            .collect();
        let frames = FAR.map(|pixel| eval_program::<f32>(&program, &spread(pixel), &parameters));
        let far = (0..components).map(|component| {
            let [near, far] = [0, 1].map(|frame: usize| {
                let values = frames[frame][component].iter().copied().map(f64::from);
                let low = values.clone().fold(f64::INFINITY, f64::min);
                [low, values.fold(f64::NEG_INFINITY, f64::max)]
            });
            let extent = near[1] - near[0];
            let same = [0, 1].map(|end| (near[end] - far[end]).abs() <= 0.2 * extent);
            (same == [true, true]).then_some(extent)
        });
        Self {
            far: far.collect(),
            values,
            known,
        }
    }
}

/// The numbers that a method gives.
struct Evaluated<'a> {
    texture: &'a Texture,
    program: &'a Program,
    method: Method,
    parameters: Vec<f32>,
    /// Means, then variances, at [`FOOTPRINTS`].
    found: Vec<Vec<f32>>,
    /// How many of them are means.
    components: usize,
    bounds: Bounds<'a>,
}

impl<'a> Evaluated<'a> {
    fn of(texture: &'a Texture, program: &'a Program, method: Method, bounds: Bounds<'a>) -> Self {
        let parameters = defaults(program);
        let found: Vec<Vec<f32>> = eval_program(program, &FOOTPRINTS, &parameters);
        Self {
            components: found.len() / 2,
            texture,
            program,
            method,
            parameters,
            found,
            bounds,
        }
    }

    fn run(&self, footprints: &[Footprint]) -> Vec<Vec<f32>> {
        eval_program(self.program, footprints, &self.parameters)
    }

    fn infinite(&self) -> Vec<String> {
        self.those(|_, x| !x.is_finite())
    }

    fn negative(&self) -> Vec<String> {
        self.those(|channel, x| channel >= self.components && x < 0.0)
    }

    /// Numbers of which something holds that should not.
    fn those(&self, wrong: impl Fn(usize, f32) -> bool) -> Vec<String> {
        let mut all = Vec::new();
        for (channel, values) in self.found.iter().enumerate() {
            for (&value, place) in values.iter().zip(&*FOOTPRINTS) {
                if wrong(channel, value) {
                    all.push(format!("{value} in channel {channel} at {place:?}"));
                }
            }
        }
        all
    }

    /// Vanishing footprints whose values are not those of points.
    fn at_points(&self, points: &Points) -> Vec<String> {
        let mut all = Vec::new();
        for size in [0.0, 1e-12] {
            let places: Vec<Footprint> = (PLACES.iter())
                .map(|place| round(place.cell, place.uv, size))
                .collect();
            let found = self.run(&places);
            for channel in 0..self.components {
                let mut wrong = Vec::new();
                for (lane, place) in places.iter().enumerate() {
                    let (x, wanted) = (found[channel][lane], points.values[channel][lane]);
                    let off = f64::from((x - wanted).abs());
                    let near = off <= VANISHING * f64::from(wanted.abs()).max(1.0);
                    if points.known[channel][lane] && !near {
                        wrong.push(format!(
                            "{x} for {wanted} in channel {channel} at {place:?}"
                        ));
                    }
                }
                // Points within a rounding of an edge.
                if wrong.len() as f64 > LEFT_OUT * places.len() as f64 {
                    all.append(&mut wrong);
                }
            }
        }
        all
    }

    /// Far fields that are not the same.
    fn far(&self, points: &Points) -> Vec<String> {
        if matches!(self.method, Method::Point | Method::Supersample(_)) {
            return Vec::new();
        }
        let pixels = FAR.map(|size| round([0, 0], [0.3, 0.6], size));
        let found = self.run(&pixels);
        let different = (0..self.components).filter_map(|channel| {
            let extent = points.far[channel]?;
            let [near, far] = [found[channel][0], found[channel][1]];
            let allowed = FAR_FIELD * extent + ROUNDING * f64::from(near.abs()).max(1.0);
            let off = f64::from((near - far).abs());
            (off > allowed).then(|| format!("{near} and {far} in channel {channel}"))
        });
        different.collect()
    }

    /// The bounds of each component of the outputs, where it has any.
    fn bounds(&self) -> impl Iterator<Item = (usize, [f32; 2])> {
        let graph = self.texture.checked().graph();
        let components = (self.texture.outputs().iter()).flat_map(|output| {
            let bounds = (self.bounds)(graph.node(output.node));
            let component = move |i: usize| bounds.as_ref().map(|bounds| bounds[i]);
            (0..output.ty.components()).map(component)
        });
        (components.enumerate()).filter_map(|(channel, bounds)| Some((channel, bounds?)))
    }

    /// Means outside of a node's bounds.
    fn outside(&self) -> Vec<String> {
        let mut wrong = Vec::new();
        for (channel, [low, high]) in self.bounds() {
            let slack = RANGE as f32 * low.abs().max(high.abs()).max(1.0);
            for (mean, place) in self.found[channel].iter().zip(&*FOOTPRINTS) {
                if !(low - slack..=high + slack).contains(mean) {
                    wrong.push(format!(
                        "{mean} outside [{low}, {high}] in channel {channel} at {place:?}"
                    ));
                }
            }
        }
        wrong
    }

    /// Variances above what numbers within a node's bounds have, a quarter of the square of their
    /// distance (Popoviciu 1935). A variance of samples is larger than theirs by n/(n − 1).
    fn spread(&self) -> Vec<String> {
        let more = match self.method {
            Method::Supersample(n) => n as f32 / (n - 1) as f32,
            _ => 1.0,
        };
        let mut wrong = Vec::new();
        for (channel, [low, high]) in self.bounds() {
            let most = (0.25 * more + SPREAD as f32) * (high - low).powi(2) + SPREAD as f32;
            let variances = &self.found[self.components + channel];
            for (variance, place) in variances.iter().zip(&*FOOTPRINTS) {
                if *variance > most {
                    wrong.push(format!(
                        "{variance} above {most} in channel {channel} at {place:?}"
                    ));
                }
            }
        }
        wrong
    }

    /// Footprints at which f32 and f64 differ by more than small changes of the place explain, but
    /// for those far away, where a frequency that is rounded moves everything.
    fn rounded(&self) -> Vec<String> {
        let near: Vec<Footprint> = (FOOTPRINTS.iter())
            .filter(|footprint| footprint.cell[0].abs() < 1000)
            .copied()
            .collect();
        // A few units in the last place.
        let moved: Vec<Footprint> = (near.iter())
            .map(|footprint| Footprint {
                uv: [0, 1].map(|i| {
                    let size = (footprint.cell[i].abs() + 1) as f32;
                    footprint.uv[i] + 2.4e-7 * size
                }),
                du: footprint.du.map(|x| x * (1.0 + 2.4e-7)),
                dv: footprint.dv.map(|x| x * (1.0 - 2.4e-7)),
                ..*footprint
            })
            .collect();
        let found = self.run(&near);
        let exact: Vec<Vec<f64>> = eval_program(self.program, &near, &self.parameters);
        let beside: Vec<Vec<f64>> = eval_program(self.program, &moved, &self.parameters);
        let mut wrong = Vec::new();
        for channel in 0..self.components {
            let mut of_channel = Vec::new();
            for (lane, place) in near.iter().enumerate() {
                let (single, double) = (f64::from(found[channel][lane]), exact[channel][lane]);
                let change = (beside[channel][lane] - double).abs();
                let spread = exact[self.components + channel][lane].max(0.0).sqrt();
                let scale = double.abs().max(spread).max(1.0);
                if (single - double).abs() > ROUNDING * scale + 1e3 * change {
                    of_channel.push(format!(
                        "{single} for {double} in channel {channel} at {place:?}"
                    ));
                }
            }
            if of_channel.len() as f64 > 0.05 * near.len() as f64 {
                wrong.append(&mut of_channel);
            }
        }
        wrong
    }
}
