//! The measured choice of a method: error and cost of each on a sample of a view's pixels.
//!
//! # What is measured
//! - *Error*: the root mean square of the differences from the truth as a display shows them
//!   (clamped to 0 to 1, sRGB encoded), over pixels spread all over the picture, each with the
//!   footprint that it has there. The truth is the mean of two independent runs of
//!   [`TRUTH`]; half their difference is its own error, the noise floor, which is subtracted in
//!   squares.
//! - *Cost*: the time on one thread over runs of neighbouring pixels, as a batch of a whole picture
//!   sees them, relative to `point`.

use std::time::{Duration, Instant};

use mipless_codegen::cpu::{Evaluator, Footprint, Position, Scratch};
use mipless_codegen::ir::Program;
use mipless_codegen::{Method, Options, PixelFilter};
use rayon::prelude::*;

use crate::image::{Image, outputs};
use crate::job::{Cancelled, Job};
use crate::metrics::display_difference;
use crate::view::{Size, View};

/// The truth.
pub const TRUTH: Method = Method::Supersample(1024);

/// The methods that a choice is made from.
pub const CANDIDATES: [Method; 9] = [
    Method::Local,
    Method::Quad,
    Method::Auto,
    Method::Split(4),
    Method::Split(7),
    Method::Split(16),
    Method::Supersample(16),
    Method::Supersample(64),
    Method::Supersample(256),
];

/// Runs of neighbouring pixels that are timed.
const RUNS: usize = 8;
/// Pixels in a run: a few batches of the evaluator.
const RUN: usize = 256;
/// Footprints that a thread takes at a time.
const PART: usize = 128;
/// A method is timed about this long, unless two evaluations take longer.
const TIMED: Duration = Duration::from_millis(30);

/// Where a pixel lies in texture space and in space.
type Pixel = (Footprint, Position);

/// Pixels of a picture.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Pixels all over the picture, in the order of its rows.
    spread: Vec<Pixel>,
    /// Runs of neighbouring pixels.
    runs: Vec<Pixel>,
}

impl Sample {
    /// About `pixels` pixels of a picture of this size; those that show the background are left
    /// out.
    pub fn new(view: &View, size: Size, pixels: usize) -> Self {
        let all = size.pixels();
        let mut spread: Vec<usize> = if pixels >= all {
            (0..all).collect()
        } else {
            // The R2 sequence (Roberts 2018) meets no regular pattern of the texture.
            let (width, height) = (size.width as usize, size.height as usize);
            let place = |index: usize| {
                let at = |step: f64| (0.5 + step * index as f64).fract();
                let column = (at(0.754_877_666_246_692_8) * width as f64) as usize;
                let row = (at(0.569_840_290_998_053_3) * height as f64) as usize;
                row.min(height - 1) * width + column.min(width - 1)
            };
            (0..pixels).map(place).collect()
        };
        spread.sort_unstable();
        spread.dedup();
        let shown = |index: &usize| view.pixel(size, *index);
        let spread: Vec<Pixel> = spread.iter().filter_map(shown).collect();

        let covered: Vec<usize> = (0..size.height as usize)
            .map(|row| row * size.width as usize + size.width as usize / 2)
            .filter(|&index| view.footprint(size, index).is_some())
            .collect();
        let starts = (0..RUNS)
            .filter_map(|run| covered.get((2 * run + 1) * covered.len() / (2 * RUNS)))
            .map(|&middle| middle.saturating_sub(RUN / 2));
        let runs = starts.flat_map(|start| start..all.min(start + RUN));
        let runs = runs.filter_map(|index| view.pixel(size, index));
        Self {
            spread,
            runs: runs.collect(),
        }
    }

    /// How many pixels the error is measured over.
    pub fn pixels(&self) -> usize {
        self.spread.len()
    }
}

/// What is measured.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// Compiles the texture.
    pub compile: &'a dyn Fn(&Options) -> Program,
    /// The pixel filter.
    pub filter: PixelFilter,
    /// The numbers of the texture's inputs, one a component, in order.
    pub parameters: &'a [f32],
    /// The position of the output.
    pub output: usize,
}

/// One method on one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// The method.
    pub method: Method,
    /// The error: sRGB, RMS, dimensionless.
    pub error: f64,
    /// The time, relative to `point`.
    pub cost: f64,
    /// The time of a pixel on one thread, in seconds.
    pub seconds: f64,
}

/// All that was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// The methods, in the order that they were asked for.
    pub methods: Vec<Measurement>,
    /// The truth's own error (sRGB, RMS): what is smaller cannot be told from 0.
    pub noise_floor: f64,
    /// How many pixels the errors were measured over.
    pub pixels: usize,
}

/// Measures methods. The progress of the job counts programs, of which there are three more than
/// methods.
///
/// # Errors
/// If the job is cancelled.
///
/// # Panics
/// If the subject has no such output, or other parameters.
pub fn measure(
    subject: &Subject<'_>,
    sample: &Sample,
    methods: &[Method],
    job: Job<'_>,
) -> Result<Measured, Cancelled> {
    let all = methods.len() as u32 + 3;
    let step = |done: u32| {
        if let Some(progress) = job.progress {
            progress(done, all);
        }
        let cancelled = job
            .cancel
            .is_some_and(|flag| flag.load(std::sync::atomic::Ordering::Relaxed));
        if cancelled { Err(Cancelled) } else { Ok(()) }
    };
    // The methods below use seed 0; a truth that shared their points would flatter them.
    let first = subject.program(TRUTH, 1).image(&sample.spread);
    step(1)?;
    let mut truth = subject.program(TRUTH, 2).image(&sample.spread);
    step(2)?;
    let noise_floor = display_difference(&first, &truth, None).rms / 2.0;
    for (mean, other) in truth.channels_mut().iter_mut().zip(first.channels()) {
        for (mean, other) in mean.iter_mut().zip(other) {
            *mean = 0.5 * *mean + 0.5 * other;
        }
    }
    let point = subject.program(Method::Point, 0).seconds(&sample.runs);
    step(3)?;
    let mut measured = Vec::new();
    for (index, &method) in methods.iter().enumerate() {
        let program = subject.program(method, 0);
        let apart = display_difference(&program.image(&sample.spread), &truth, None).rms;
        let seconds = match method {
            Method::Point => point,
            _ => program.seconds(&sample.runs),
        };
        measured.push(Measurement {
            method,
            error: (apart * apart - noise_floor * noise_floor).max(0.0).sqrt(),
            cost: if point > 0.0 { seconds / point } else { 1.0 },
            seconds,
        });
        step(index as u32 + 4)?;
    }
    Ok(Measured {
        methods: measured,
        noise_floor,
        pixels: sample.pixels(),
    })
}

/// A compiled program with what it takes to run it.
struct Ready<'a> {
    evaluator: Evaluator<f32>,
    parameters: &'a [f32],
    place: crate::image::Output,
}

impl<'a> Subject<'a> {
    fn program(&self, method: Method, seed: u32) -> Ready<'a> {
        let program = (self.compile)(&Options {
            method,
            filter: self.filter,
            moments: false,
            seed,
        });
        Ready {
            evaluator: Evaluator::of_program(&program),
            parameters: self.parameters,
            place: outputs(&program.interface).swap_remove(self.output),
        }
    }
}

impl Ready<'_> {
    /// The output over some footprints, as an image of one row.
    fn image(&self, pixels: &[Pixel]) -> Image {
        let names = crate::image::channel_names(self.place.ty);
        if pixels.is_empty() {
            return Image::new(Size::new(1, 1), names, vec![vec![0.0]; names.len()]);
        }
        let part = |part: &[Pixel]| {
            let mut results = Vec::new();
            let mut scratch = Scratch::new();
            let evaluator = &self.evaluator;
            let (footprints, positions): (Vec<_>, Vec<_>) = part.iter().copied().unzip();
            let parameters = self.parameters;
            evaluator.evaluate_surface(
                &mut scratch,
                &footprints,
                &positions,
                parameters,
                &mut results,
            );
            results[self.place.mean.clone()].to_vec()
        };
        let parts: Vec<Vec<Vec<f32>>> = pixels.par_chunks(PART).map(part).collect();
        let channel = |c: usize| parts.iter().flat_map(|part| part[c].clone()).collect();
        let channels = (0..names.len()).map(channel).collect();
        Image::new(Size::new(pixels.len() as u32, 1), names, channels)
    }

    /// The shortest time of one footprint on this thread, in seconds: each run of pixels counts with
    /// the best of its times, so that what else the machine does meanwhile counts little.
    fn seconds(&self, pixels: &[Pixel]) -> f64 {
        let (footprints, positions): (Vec<_>, Vec<_>) = pixels.iter().copied().unzip();
        let (mut results, mut scratch) = (Vec::new(), Scratch::new());
        let mut best = vec![Duration::MAX; footprints.len().div_ceil(RUN)];
        let (mut total, mut rounds) = (Duration::ZERO, 0);
        while rounds < 2 || (total < 4 * TIMED && (rounds < 3 || total < TIMED)) {
            for (best, (run, positions)) in
                (best.iter_mut()).zip(footprints.chunks(RUN).zip(positions.chunks(RUN)))
            {
                let begun = Instant::now();
                let (evaluator, parameters) = (&self.evaluator, self.parameters);
                evaluator.evaluate_surface(&mut scratch, run, positions, parameters, &mut results);
                let taken = begun.elapsed();
                *best = taken.min(*best);
                total += taken;
            }
            // Without footprints the time would stand still.
            total += Duration::from_micros(1);
            rounds += 1;
        }
        best.iter().sum::<Duration>().as_secs_f64() / footprints.len().max(1) as f64
    }
}

/// Which method was chosen, and whether it is what was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice {
    /// The position among the measurements.
    pub index: usize,
    /// Whether the error is within the tolerance, if there is one.
    pub accurate: bool,
    /// Whether the cost is within the budget, if there is one.
    pub affordable: bool,
}

/// The cheapest method within the tolerance, or the most accurate one within the budget. With both,
/// the cheapest within both, or else the most accurate one within the budget. If nothing is within
/// the tolerance, the most accurate; if nothing is within the budget, the cheapest.
///
/// # Panics
/// If there are no measurements.
pub fn choose(measured: &[Measurement], tolerance: Option<f64>, budget: Option<f64>) -> Choice {
    let accurate = |m: &Measurement| tolerance.is_none_or(|most| m.error <= most);
    let affordable = |m: &Measurement| budget.is_none_or(|most| m.cost <= most);
    let best = |fits: &dyn Fn(&Measurement) -> bool, key: fn(&Measurement) -> [f64; 2]| {
        let fitting = measured.iter().enumerate().filter(|(_, m)| fits(m));
        let least = fitting.min_by(|(_, a), (_, b)| {
            let order = |i: usize| key(a)[i].total_cmp(&key(b)[i]);
            order(0).then(order(1))
        });
        least.map(|(index, _)| index)
    };
    let by_cost = |m: &Measurement| [m.cost, m.error];
    let by_error = |m: &Measurement| [m.error, m.cost];
    let wanted = if tolerance.is_some() {
        by_cost
    } else {
        by_error
    };
    let index = best(&|m| accurate(m) && affordable(m), wanted)
        .or_else(|| best(&affordable, by_error))
        .or_else(|| best(&|_| true, by_cost))
        .expect("there are measurements");
    Choice {
        index,
        accurate: accurate(&measured[index]),
        affordable: affordable(&measured[index]),
    }
}

/// For each measurement, whether no other one is both cheaper and more accurate: the Pareto front.
pub fn front(measured: &[Measurement]) -> Vec<bool> {
    let beats = |a: &Measurement, b: &Measurement| {
        a.error <= b.error && a.cost <= b.cost && (a.error < b.error || a.cost < b.cost)
    };
    (measured.iter())
        .map(|m| !measured.iter().any(|other| beats(other, m)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::{Flat, Plane};

    fn measured() -> Vec<Measurement> {
        let of = |method, error, cost| Measurement {
            method,
            error,
            cost,
            seconds: cost,
        };
        vec![
            of(Method::Local, 0.02, 2.0),
            of(Method::Quad, 0.03, 4.0),
            of(Method::Split(7), 0.01, 20.0),
            of(Method::Supersample(256), 0.001, 250.0),
        ]
    }

    #[test]
    fn the_choice_is_the_one_that_was_asked_for() {
        let all = measured();
        let index = |tolerance, budget| {
            let choice = choose(&all, tolerance, budget);
            (choice.index, choice.accurate, choice.affordable)
        };
        assert_eq!(index(Some(0.015), None), (2, true, true));
        assert_eq!(index(Some(0.5), None), (0, true, true));
        assert_eq!(index(Some(1e-6), None), (3, false, true));
        assert_eq!(index(None, Some(30.0)), (2, true, true));
        assert_eq!(index(None, Some(1.0)), (0, true, false));
        assert_eq!(index(Some(0.025), Some(30.0)), (0, true, true));
        assert_eq!(index(Some(0.002), Some(30.0)), (2, false, true));
    }

    #[test]
    fn what_is_beaten_is_not_in_front() {
        assert_eq!(front(&measured()), [true, false, true, true]);
    }

    #[test]
    fn a_sample_is_spread_and_shows_no_background() {
        let size = Size::new(640, 360);
        let flat = Sample::new(&View::Flat(Flat::default()), size, 960);
        assert!(flat.pixels() > 950, "{}", flat.pixels());
        let quarter = |(f, _): &Pixel| f.uv[0] < 0.5 && f.uv[1] < 0.5;
        let share = flat.spread.iter().filter(|f| quarter(f)).count();
        assert!((230..250).contains(&share), "{share}");
        assert_eq!(flat.runs.len(), RUNS * RUN);

        let plane = Sample::new(&View::Plane(Plane::default()), size, 960);
        assert!((600..720).contains(&plane.pixels()), "{}", plane.pixels());
        let tiny = Sample::new(&View::Flat(Flat::default()), Size::new(2, 1), 960);
        assert_eq!(tiny.pixels(), 2);
    }
}
