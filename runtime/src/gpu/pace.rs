//! What a pipeline costs, relative to another one.

use std::time::{Duration, Instant};

use super::{Gpu, GpuError, Pipeline};
use crate::job::Job;
use crate::view::{Size, View};

/// The time of a pipeline beside that of another one, its baseline.
///
/// A device that idles between dispatches runs at a fraction of its clock, and changes it within a
/// second (an H100 by a factor of five): times of different moments say nothing about each other.
/// So the two take turns, and what counts is the median of the ratios of neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// The shortest time of a footprint, in seconds.
    pub seconds: f64,
    /// The shortest time of a footprint by the baseline, in seconds.
    pub baseline: f64,
    /// The time, relative to the baseline's.
    pub ratio: f64,
}

/// Who takes longer than this for a picture has one turn after the first.
const PATIENCE: Duration = Duration::from_secs(1);

impl Gpu {
    /// Measures a pipeline against a baseline in `rounds` turns after one that finds the size of
    /// their dispatches.
    ///
    /// # Errors
    /// As [`Gpu::render`].
    pub fn pace(
        &self,
        pipeline: &Pipeline,
        baseline: &Pipeline,
        view: &View,
        size: Size,
        rounds: u32,
        job: Job<'_>,
    ) -> Result<Pace, GpuError> {
        let time = |pipeline, job| {
            let (_, timing) = self.render(pipeline, view, size, job)?;
            let footprints = timing.footprints.max(1) as f64;
            Ok::<f64, GpuError>(timing.best().as_secs_f64() / footprints)
        };
        let mut turns: Vec<[f64; 2]> = Vec::new();
        let mut before = time(baseline, Job::default())?;
        let mut rounds = rounds.max(1);
        let mut round = 0;
        while round <= rounds {
            let begun = Instant::now();
            let by_pipeline = time(pipeline, job)?;
            let after = time(baseline, Job::default())?;
            if begun.elapsed() > PATIENCE {
                rounds = 1;
            }
            // Some drivers compile a shader only when it first runs.
            if round > 0 {
                turns.push([by_pipeline, before.min(after)]);
            }
            before = after;
            round += 1;
        }
        let least = |which: usize| turns.iter().map(|t| t[which]).fold(f64::INFINITY, f64::min);
        let mut ratios: Vec<f64> = (turns.iter())
            .map(|[pipeline, baseline]| pipeline / baseline)
            .collect();
        ratios.sort_by(f64::total_cmp);
        Ok(Pace {
            seconds: least(0),
            baseline: least(1),
            ratio: ratios[ratios.len() / 2],
        })
    }
}
