//! The periods of a function of position, found by trying.
//!
//! A texture that people build of `fract`, `floor`, `modulo` and waves of coordinates repeats along
//! two directions of texture space, but no node alone knows which. What may repeat are multiples of
//! the steps of its affine coordinates a·uv + c: the displacement that moves one of them by m steps
//! and leaves another one where it is. Steps are 1, 2π and the numbers that the region's own nodes
//! hold. A displacement is a period when it leaves the function as it is at every place tried but
//! for a few, which lie beside an edge.

use super::Compiler;
use super::place::scattered;
use crate::cpu::{Evaluator, Footprint, Scratch};
use crate::ir::Module;
use mipless_graph::{Literal, Source};

/// Two displacements in uv.
pub(super) type Periods = [[f64; 2]; 2];

/// The most directions of coordinates.
const DIRECTIONS: usize = 6;
/// The most steps of a period.
const MOST: u32 = 24;
/// By what a period that was found is divided as long as it stays one.
const PRIMES: [f64; 9] = [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0];
/// The share of a period by which nothing repeats but what does not change.
const IRRATIONAL: f64 = 0.366_025_403_784_438_6;
/// Places where a displacement is tried first, and those that it must stand afterwards.
const TRIED: usize = 48;
const PROVED: usize = 1024;
/// How far away a function must be the same after so many periods, in uv.
const FAR: f64 = 16.0;
/// The share of places that may lie beside an edge.
const EDGES: f64 = 0.01;
/// How far values may be apart, relative to their extent.
const APART: f64 = 1e-3;

/// A function of position: its values at points of texture space.
pub(super) struct Function {
    evaluator: Evaluator<f64>,
    scratch: Scratch<f64>,
}

impl Function {
    /// The entry of a module, which takes the footprint alone.
    pub(super) fn new(module: &Module) -> Self {
        Self {
            evaluator: Evaluator::new(module),
            scratch: Scratch::new(),
        }
    }

    /// The components at points, one vector each.
    pub(super) fn at(&mut self, points: &[[f64; 2]]) -> Vec<Vec<f64>> {
        let footprints: Vec<Footprint> = (points.iter()).map(|&at| Footprint::point(at)).collect();
        let mut values = Vec::new();
        (self.evaluator).evaluate_footprints(&mut self.scratch, &footprints, &[], &mut values);
        values
    }

    /// Whether the function is the same when displaced, at the first `count` places.
    fn repeats(&mut self, by: [f64; 2], count: usize, extent: &[f64]) -> bool {
        let places: Vec<[f64; 2]> = places().take(count).collect();
        let values = self.at(&places);
        // An odd and an even number of periods, to both sides; and so many that they lead far away: what
        // changes slowly is nearly the same a short step aside, and repeats nothing.
        let many = (FAR / by[0].hypot(by[1])).ceil().max(3.0);
        [1.0, -2.0, many].into_iter().all(|times| {
            let displaced: Vec<[f64; 2]> = (places.iter())
                .map(|p| [p[0] + times * by[0], p[1] + times * by[1]])
                .collect();
            let other = self.at(&displaced);
            let differs = |&i: &usize| {
                (values.iter().zip(&other).zip(extent))
                    .any(|((x, y), extent)| (x[i] - y[i]).abs() > APART * extent)
            };
            let differing = (0..count).filter(differs).count();
            (differing as f64) <= EDGES * count as f64
        })
    }
}

/// Places in the squares around the origin.
fn places() -> impl Iterator<Item = [f64; 2]> {
    (1..).map(|i| scattered(i).map(|x| 12.0 * x - 6.0))
}

/// The numbers that the nodes of a region hold: steps that something in it may take.
pub(super) fn steps(compiler: &Compiler<'_>, region: &[usize]) -> Vec<f64> {
    let mut steps = vec![1.0, std::f64::consts::TAU];
    for &node in region {
        for input in &compiler.graph.nodes[node].inputs {
            let numbers = match &input.source {
                Source::Literal(Literal::Numbers(_, numbers)) => numbers.to_vec(),
                Source::Literal(Literal::Integer(i)) => vec![*i as f32],
                _ => continue,
            };
            for number in numbers {
                let step = f64::from(number.abs());
                if (1e-3..1e3).contains(&step) && !steps.contains(&step) && steps.len() < 8 {
                    steps.push(step);
                }
            }
        }
    }
    steps
}

/// The directions a of those coordinates a·uv + c among the components of the function's values that
/// are affine, the steepest first.
pub(super) fn directions(affine: &mut Function) -> Vec<[f64; 2]> {
    let mut points = vec![[0.25, 0.25], [1.25, 0.25], [0.25, 1.25]];
    points.extend(places().take(TRIED));
    let mut directions: Vec<[f64; 2]> = Vec::new();
    for values in affine.at(&points) {
        let a = [values[1] - values[0], values[2] - values[0]];
        let size = a[0].abs() + a[1].abs();
        if !size.is_finite() || size < 1e-9 {
            continue;
        }
        let line = |p: &[f64; 2]| values[0] + a[0] * (p[0] - 0.25) + a[1] * (p[1] - 0.25);
        let mut all = points.iter().zip(&values);
        let is_affine = all.all(|(p, value)| (value - line(p)).abs() < 1e-5 * size * 16.0);
        let is_known = |known: &[f64; 2]| {
            let opposite = (known[0] + a[0]).abs() + (known[1] + a[1]).abs();
            let same = (known[0] - a[0]).abs() + (known[1] - a[1]).abs();
            same.min(opposite) < 1e-6 * size
        };
        if is_affine && !directions.iter().any(is_known) {
            directions.push(a);
        }
    }
    // The steepest have the shortest steps.
    let steepness = |a: &[f64; 2]| -a[0].hypot(a[1]);
    directions.sort_by(|a, b| steepness(a).total_cmp(&steepness(b)));
    directions.truncate(DIRECTIONS);
    directions
}

/// Two independent periods of a function, if it has them.
pub(super) fn periods(
    function: &mut Function,
    directions: &[[f64; 2]],
    steps: &[f64],
) -> Option<Periods> {
    let values = function.at(&places().take(PROVED).collect::<Vec<_>>());
    let extent: Vec<f64> = (values.iter())
        .map(|values| {
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            high - low
        })
        .collect();
    if !extent.iter().all(|extent| extent.is_finite()) {
        return None;
    }
    let mut counts: Vec<f64> = (steps.iter())
        .flat_map(|step| (1..=MOST).map(move |m| f64::from(m) * step))
        .collect();
    counts.sort_by(f64::total_cmp);
    counts.dedup_by(|x, y| (*x - *y).abs() < 1e-9);
    // A period, and whether the function changes within it.
    let mut along = |moved: [f64; 2], kept: [f64; 2]| -> Option<([f64; 2], bool)> {
        // a·d = 1 and b·d = 0.
        let area = moved[0] * kept[1] - moved[1] * kept[0];
        let unit = [kept[1] / area, -kept[0] / area];
        let mut repeats = |d: [f64; 2]| {
            function.repeats(d, TRIED, &extent) && function.repeats(d, PROVED, &extent)
        };
        let mut displacements = counts.iter().map(|count| unit.map(|d| d * count));
        let mut found = displacements.find(|&d| repeats(d))?;
        if repeats(found.map(|d| d * IRRATIONAL)) {
            return Some((found, false));
        }
        // Where the steps are finer than those that were tried, so is the period.
        for prime in PRIMES {
            let mut part = found.map(|d| d / prime);
            while repeats(part) {
                found = part;
                part = found.map(|d| d / prime);
            }
        }
        Some((found, true))
    };
    for (i, &a) in directions.iter().enumerate() {
        // With stripes nothing but one direction counts: beside it, any.
        let aside = [-a[1], a[0]];
        let others = (directions[i + 1..].iter().copied()).chain([aside]);
        for b in others {
            let area = (a[0] * b[1] - a[1] * b[0]).abs();
            if area < 1e-6 * a[0].hypot(a[1]) * b[0].hypot(b[1]) {
                continue;
            }
            if let Some(first) = along(a, b)
                && let Some(second) = along(b, a)
            {
                return Some(balanced(first, second));
            }
        }
    }
    None
}

/// Two periods; one along which nothing changes is as long as the other, so that a round footprint
/// stays round.
fn balanced((first, of_first): ([f64; 2], bool), (second, of_second): ([f64; 2], bool)) -> Periods {
    let as_long = |d: [f64; 2], other: [f64; 2]| {
        let by = other[0].hypot(other[1]) / d[0].hypot(d[1]);
        d.map(|x| x * by)
    };
    match (of_first, of_second) {
        (true, false) => [first, as_long(second, first)],
        (false, true) => [as_long(first, second), second],
        _ => [first, second],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::{Builder, FOOTPRINT, Float};
    use crate::lower::place::Place;

    /// A function of u and v.
    fn function(of: impl for<'b> Fn([Float<'b>; 2]) -> Float<'b>) -> Function {
        let mut module = Module::default();
        let b = &Builder::new("function", "A function of position.");
        let place = Place::<2>::declare(b, &FOOTPRINT);
        let at = [0, 1].map(|axis| place.cell[axis].to_float() + place.fraction[axis]);
        b.result("value", of(at));
        b.finish(&mut module);
        Function::new(&module)
    }

    const AXES: [[f64; 2]; 2] = [[1.0, 0.0], [0.0, 1.0]];

    fn fract(x: Float<'_>) -> Float<'_> {
        x - x.floor()
    }

    #[test]
    fn a_period_is_found_though_no_step_is_as_short() {
        let mut cells = function(|[u, v]| fract(u * 4.0).min(fract(v * 2.0)));
        let [first, second] = periods(&mut cells, &AXES, &[1.0]).expect("periods");
        assert!((first[0].abs() - 0.25).abs() < 1e-9 && first[1].abs() < 1e-9);
        assert!((second[1].abs() - 0.5).abs() < 1e-9 && second[0].abs() < 1e-9);
    }

    #[test]
    fn what_does_not_change_along_a_direction_has_a_period_as_long_as_the_other() {
        let mut stripes = function(|[u, _]| fract(u * 2.0));
        let [first, second] = periods(&mut stripes, &AXES, &[1.0, 0.001]).expect("periods");
        assert!((first[0].abs() - 0.5).abs() < 1e-9, "{first:?}");
        assert!((second[1].abs() - 0.5).abs() < 1e-9, "{second:?}");
    }

    #[test]
    fn what_changes_slowly_does_not_repeat_at_a_short_step() {
        let mut hill = function(|[u, v]| 1.0 / (1.0 + (u * u + v * v) * 0.01));
        assert_eq!(periods(&mut hill, &AXES, &[1.0, 0.001]), None);
    }
}
