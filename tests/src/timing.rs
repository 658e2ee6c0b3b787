//! Timing programs against each other on one thread of the CPU.

use mipless::{Footprint, Program};
use mipless_codegen::cpu::{Evaluator, Scratch};
use std::time::Instant;

/// The defaults of a program's parameters, one number a component.
pub fn defaults(program: &Program) -> Vec<f32> {
    (program.interface.parameters.iter())
        .flat_map(|p| p.default.clone())
        .collect()
}

/// Seconds that each program takes for all footprints, the fastest of so many runs. The programs take
/// turns, so that what else the machine does falls on all of them.
pub fn fastest<const N: usize>(
    programs: &[Program; N],
    footprints: &[Footprint],
    runs: usize,
) -> [f64; N] {
    let evaluators = programs.each_ref().map(Evaluator::<f32>::of_program);
    let parameters = programs.each_ref().map(defaults);
    let (mut scratch, mut outputs) = (Scratch::new(), Vec::new());
    let mut least = [f64::INFINITY; N];
    for _ in 0..runs {
        for i in 0..N {
            let start = Instant::now();
            evaluators[i].evaluate_footprints(
                &mut scratch,
                footprints,
                &parameters[i],
                &mut outputs,
            );
            least[i] = least[i].min(start.elapsed().as_secs_f64());
        }
    }
    least
}
