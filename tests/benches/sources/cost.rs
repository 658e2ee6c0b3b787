//! What sources cost on one thread of the CPU, in one run.

use crate::footprint::{footprint, places};
use mipless::{Method, Options, PixelFilter, Texture};
use mipless_codegen::cpu::{Evaluator, Scratch};
use std::time::Instant;

/// Points of a run, and how many runs of which the fastest counts.
const POINTS: usize = 1 << 13;
const RUNS: usize = 15;

/// A graph, a method, and the footprint's standard deviation in uv.
pub(crate) struct Job<'a> {
    pub(crate) graph: &'a str,
    pub(crate) method: Method,
    pub(crate) size: f64,
}

/// Nanoseconds a point of every job. The jobs take turns, so that what else the machine does falls
/// on all of them.
pub(crate) fn nanoseconds(jobs: &[Job<'_>]) -> Vec<f64> {
    let prepared: Vec<_> = (jobs.iter())
        .map(|job| {
            let texture = Texture::from_json(job.graph).expect("the graph has no mistakes");
            let program = texture.compile(&Options {
                method: job.method,
                filter: PixelFilter::Gaussian(1.0),
                moments: job.method != Method::Point,
                ..Options::default()
            });
            let axes = [[job.size, 0.0], [0.0, job.size]];
            let footprints: Vec<_> = (places(POINTS, 50.0).into_iter())
                .map(|at| footprint(at, axes))
                .collect();
            (Evaluator::<f32>::of_program(&program), footprints)
        })
        .collect();
    let (mut scratch, mut outputs) = (Scratch::new(), Vec::new());
    let mut least = vec![f64::INFINITY; jobs.len()];
    for _ in 0..RUNS {
        for ((evaluator, footprints), least) in prepared.iter().zip(&mut least) {
            let start = Instant::now();
            evaluator.evaluate_footprints(&mut scratch, footprints, &[], &mut outputs);
            *least = least.min(start.elapsed().as_secs_f64() * 1e9 / POINTS as f64);
        }
    }
    least
}
