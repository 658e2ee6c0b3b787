//! What sums over things have in common: cells, regions and bricks, of whose numbers an image is summed.

use mipless_codegen::ir::{Bool, Builder, Float, Scalar, Scalars};
use mipless_codegen::moments::{Mode, Signal};
use mipless_codegen::{Ensemble, Image, Lower, pairs};

/// The variance of a number of [0, 1).
pub(crate) const VARIANCE: f32 = 1.0 / 12.0;

/// What an image is over all things, as captures of the functions that sum it: of the number itself it
/// is known there. Where nothing fades, it is not wanted.
pub(crate) fn ensemble<'b>(
    lower: &mut Lower<'_, 'b>,
    image: &Image,
    wanted: impl FnOnce() -> Bool<'b>,
) -> Option<Ensemble<'b>> {
    let is_read = !image.is_identity() && lower.mode().filters();
    is_read.then(|| lower.ensemble(image, wanted()))
}

/// The covariance that signals have beyond what they carry.
pub(crate) fn attach<'b>(
    lower: &mut Lower<'_, 'b>,
    image: &Image,
    signals: &mut [Signal<'b>],
    rest: &[Float<'b>],
) {
    if let [number] = signals
        && image.is_identity()
    {
        number.range = [0.0, 1.0];
    }
    match signals {
        _ if rest.is_empty() => {}
        [signal] => lower.algebra.attach_fresh(signal, rest[0]),
        signals => lower.algebra.attach_joint(signals, rest),
    }
}

/// Parameters of these names, or of the one name where there is one.
pub(crate) fn channels<'b>(b: &'b Builder, name: &str, count: usize) -> Vec<Float<'b>> {
    (0..count)
        .map(|i| match count {
            1 => b.float_param(name),
            _ => b.float_param(format!("{name}_{i}")),
        })
        .collect()
}

/// The names of lists of numbers: of one number the name, of several with their places.
pub(crate) fn named(lists: &[(&str, usize)]) -> Vec<String> {
    let of = |&(name, count): &(&str, usize)| {
        let name = name.to_owned();
        (0..count).map(move |i| match count {
            1 => name.clone(),
            _ => format!("{name}_{i}"),
        })
    };
    lists.iter().flat_map(of).collect()
}

/// What the things of a footprint have in common, by what they are less the centre.
pub(crate) struct Filtered<'b> {
    /// What is at the centre.
    pub(crate) centre: Vec<Float<'b>>,
    /// The means of d and of its products.
    pub(crate) first: Vec<Float<'b>>,
    pub(crate) second: Vec<Float<'b>>,
    /// The derivatives of each mean.
    pub(crate) slopes: Vec<Vec<Float<'b>>>,
    /// The covariance that they give.
    pub(crate) linear: Vec<Float<'b>>,
    /// How much of it has not faded.
    pub(crate) fade: Float<'b>,
    /// The probability that two places of the footprint lie in one thing.
    pub(crate) same: Float<'b>,
}

impl<'b> Filtered<'b> {
    /// The results of a function: for each component of the image the mean and the slopes, then what is
    /// left of the covariance.
    pub(crate) fn results(&self, b: &'b Builder, mode: Mode, ensemble: Option<&Ensemble<'b>>) {
        let Self { first, fade, .. } = self;
        let fade = *fade;
        let count = first.len();
        let carries = matches!(mode, Mode::Local | Mode::Quad);
        for i in 0..count {
            let suffix = if count > 1 {
                format!("_{i}")
            } else {
                String::new()
            };
            // M = μ + fade (v₀ + m₁ − μ).
            let mean = match ensemble {
                None => ((self.centre[i] + first[i] + -0.5) * fade + 0.5).clamp(0.0, 1.0),
                Some(ensemble) => {
                    let far = ensemble.means[i];
                    (self.centre[i] + first[i] - far) * fade + far
                }
            };
            b.result(format!("mean{suffix}"), mean);
            for (name, &slope) in ["dx", "dy", "dz"].into_iter().zip(&self.slopes[i]) {
                let slope = if carries { slope * fade } else { b.float(0.0) };
                b.result(format!("{name}{suffix}"), slope);
            }
        }
        if !mode.spreads() {
            return;
        }
        for (at, (i, k)) in pairs(count).enumerate() {
            let far = |by: Float<'b>| match ensemble {
                None => by * VARIANCE,
                Some(ensemble) => by * ensemble.covariance[at],
            };
            let rest = if carries {
                let own = self.second[at] - first[i] * first[k];
                let near = own - self.linear[at] * fade.square();
                let near = if i == k { near.max(0.0) } else { near };
                near * fade + far(1.0 - fade)
            } else {
                far(1.0 - self.same * fade)
            };
            match count {
                1 => b.result("rest", rest),
                _ => b.result(format!("rest_{i}_{k}"), rest),
            }
        }
    }
}

/// The parameters of what an image is over all cells, of a function that is asked for it.
pub(crate) fn declared_ensemble<'b>(b: &'b Builder, image: &Image) -> Option<Ensemble<'b>> {
    let count = image.channels();
    (!image.is_identity()).then(|| Ensemble {
        means: channels(b, "far_mean", count),
        covariance: channels(b, "far_covariance", pairs(count).count()),
    })
}

/// Sums over things, or over rows and lines of them: of the weight, of d, what they are less the centre, of
/// its products, and of both slopes of d.
#[derive(Clone, Debug)]
pub(crate) struct Sums<'b> {
    pub(crate) weight: Float<'b>,
    pub(crate) first: Vec<Float<'b>>,
    pub(crate) second: Vec<Float<'b>>,
    pub(crate) slope_x: Vec<Float<'b>>,
    pub(crate) slope_y: Vec<Float<'b>>,
}

impl<'b> Sums<'b> {
    pub(crate) fn zero(b: &'b Builder, channels: usize) -> Self {
        let zero = b.float(0.0);
        Self {
            weight: zero,
            first: vec![zero; channels],
            second: vec![zero; pairs(channels).count()],
            slope_x: vec![zero; channels],
            slope_y: vec![zero; channels],
        }
    }

    fn names(count: usize) -> Vec<String> {
        let lists = [
            ("weight", 1),
            ("first", count),
            ("second", pairs(count).count()),
            ("slope_x", count),
            ("slope_y", count),
        ];
        named(&lists)
    }

    pub(crate) fn declare(b: &'b Builder, channels: usize) -> Self {
        let mut names = Self::names(channels).into_iter();
        let mut next = || names.next().expect("a name for each part");
        Self::zero(b, channels).replaced(&mut || b.float_param(next()).into())
    }

    pub(crate) fn results(&self, b: &'b Builder) {
        b.results(Self::names(self.first.len()), self.scalars());
    }
}

impl<'b> Scalars<'b> for Sums<'b> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        self.weight.each(visit);
        [&self.first, &self.second, &self.slope_x, &self.slope_y].each(visit);
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        let weight = self.weight.replaced(next);
        let lists = [self.first, self.second, self.slope_x, self.slope_y];
        let [first, second, slope_x, slope_y] = lists.replaced(next);
        Self {
            weight,
            first,
            second,
            slope_x,
            slope_y,
        }
    }
}

/// Each sum with its part, times a weight.
pub(crate) fn weighted<'b>(
    sums: Vec<Float<'b>>,
    weight: Float<'b>,
    parts: &[Float<'b>],
) -> Vec<Float<'b>> {
    let parts = sums.into_iter().zip(parts);
    parts.map(|(sum, &part)| sum + weight * part).collect()
}
