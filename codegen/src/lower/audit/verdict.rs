//! Which of two ways to filter a graph is better.

use super::super::bands::Bands;
use super::truth::Errors;

/// How far off an output may be, root mean square over places, as a display shows it.
pub(super) const TOLERANCE: f64 = 0.03;
/// Beyond this an output that is worse than a point is worth samples.
pub(super) const NOTICEABLE: f64 = 0.01;
/// By how much something else must be better than a closed form that is merely inexact, over all bands.
const BETTER: f64 = 0.7;
/// The same of points in a band: they are taken in those alone where they are worth their time, so that
/// a band where nothing helps does not outweigh the others.
pub(super) const BETTER_BY_POINTS: f64 = 0.85;

/// How bad errors are: in how many bands an output is worse than a point or misses the tolerance,
/// and the mean of their squares.
#[derive(Clone, Copy, Debug)]
pub(super) struct Verdict {
    worse: usize,
    off: usize,
    pub(super) square: f64,
}

impl Verdict {
    pub(super) fn of(errors: &Errors, point: &Errors, floor: &Errors) -> Self {
        let (mut worse, mut off, mut square) = (0, 0, 0.0);
        for (errors, (point, floor)) in errors.iter().zip(point.iter().zip(floor)) {
            for (error, (point, floor)) in errors.iter().zip(point.iter().zip(floor)) {
                worse += usize::from(is_worse(*error, *point, *floor));
                off += usize::from(is_off(*error, *floor));
                square += error * error;
            }
        }
        Self { worse, off, square }
    }

    pub(super) fn is_good(self) -> bool {
        self.worse == 0 && self.off == 0
    }

    /// Whether this is better at all, and nowhere else worse than a point.
    pub(super) fn improves(self, other: Self) -> bool {
        self.worse <= other.worse && self.square < other.square
    }

    /// Whether this is so much better that it is worth its time.
    pub(super) fn beats(self, other: Self) -> bool {
        self.worse < other.worse
            || self.worse == other.worse && self.square < BETTER * BETTER * other.square
    }
}

/// Whether an error misses the tolerance, beyond the noise of what is held to be true.
pub(super) fn is_off(error: f64, floor: f64) -> bool {
    error > TOLERANCE.hypot(floor)
}

pub(super) fn is_worse(error: f64, point: f64, floor: f64) -> bool {
    error > NOTICEABLE && error > point + floor
}

/// The bits of the bands in which something else has less than a share of the errors of some of the
/// outputs, where these are above `noticed`.
pub(super) fn where_better(
    other: &Errors,
    closed: &Errors,
    outputs: &[usize],
    [noticed, share]: [f64; 2],
) -> u32 {
    let better = |band: &usize| {
        let square = |errors: &Errors| {
            let errors = outputs.iter().map(|&output| errors[output][*band].powi(2));
            errors.sum::<f64>()
        };
        let matters = outputs
            .iter()
            .any(|&output| closed[output][*band] > noticed);
        matters && square(other) < share * share * square(closed)
    };
    (0..Bands::COUNT)
        .filter(better)
        .fold(0, |bits, band| bits | 1 << band)
}
