//! The choice of a method for `--tolerance` and `--budget`.

use crate::mistake::Mistake;
use crate::progress;
use crate::report::Report;
use crate::scene::Scene;
use mipless::{Method, Options};
use mipless_runtime::device::Device;
use mipless_runtime::gpu::Gpu;
use mipless_runtime::job::Job;
use mipless_runtime::plan::{CANDIDATES, Measured, Measurement, Sample, Subject, choose, measure};
use serde_json::{Value, json};
use std::fmt;

/// How many pixels the errors are measured over: enough to know them to some percent.
const PIXELS: usize = 40 * 24;

/// Turns in which a method and `point` are timed on a graphics device.
const TURNS: u32 = 5;

/// What is asked for: a tolerance, a budget, or both.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wish {
    tolerance: Option<f64>,
    budget: Option<f64>,
}

impl Wish {
    /// `None` if nothing is asked for.
    pub(crate) fn new(tolerance: Option<f64>, budget: Option<f64>) -> Option<Self> {
        (tolerance.is_some() || budget.is_some()).then_some(Self { tolerance, budget })
    }
}

/// The method that was chosen, and why.
#[derive(Debug)]
pub(crate) struct Plan {
    /// The method.
    pub(crate) method: Method,
    wish: Wish,
    measured: Measured,
    chosen: usize,
}

/// Measures methods on pixels of a scene: their errors on the CPU, their costs where the scene is
/// evaluated.
pub(crate) fn measured(
    scene: &Scene,
    methods: &[Method],
    pixels: usize,
    report: &Report,
) -> Result<Measured, Mistake> {
    let compile = |options: &Options| scene.texture.compile(options);
    let subject = Subject {
        compile: &compile,
        filter: scene.filter,
        parameters: &scene.parameters,
        output: scene.output,
    };
    let sample = Sample::new(&scene.view, scene.size, pixels);
    let work = |job: Job<'_>| measure(&subject, &sample, methods, job);
    let mut measured = progress::watch(report, "measuring", work)
        .map_err(|error| Mistake::usage("render-failed", error))?;
    if let Device::Gpu(gpu) = &scene.device {
        time_on_gpu(scene, gpu, &mut measured.methods, report)?;
    }
    Ok(measured)
}

/// Replaces the times by those of a graphics device.
fn time_on_gpu(
    scene: &Scene,
    gpu: &Gpu,
    methods: &mut [Measurement],
    report: &Report,
) -> Result<(), Mistake> {
    let failed = |error| Mistake::usage("device-failed", error);
    let pipeline = |method| {
        let program = scene.texture.compile(&scene.options(method));
        let pipeline = gpu.pipeline(&program)?;
        gpu.set_parameters(&pipeline, &scene.parameters)?;
        Ok(pipeline)
    };
    let point = pipeline(Method::Point).map_err(failed)?;
    for measurement in methods {
        let pipeline = pipeline(measurement.method).map_err(failed)?;
        let (view, size) = (&scene.view, scene.size);
        let work = |job: Job<'_>| gpu.pace(&pipeline, &point, view, size, TURNS, job);
        let label = measurement.method.to_string();
        let pace = progress::watch(report, &label, work).map_err(failed)?;
        measurement.seconds = pace.seconds;
        measurement.cost = pace.ratio;
    }
    Ok(())
}

impl Plan {
    /// Measures and chooses. `filters` says whether every signal has statistics; what has none can
    /// only be sampled.
    pub(crate) fn make(
        scene: &Scene,
        wish: Wish,
        filters: bool,
        report: &mut Report,
    ) -> Result<Self, Mistake> {
        let samples = |method: &Method| matches!(method, Method::Supersample(_));
        let methods: Vec<Method> = CANDIDATES
            .into_iter()
            .filter(|method| filters || samples(method))
            .collect();
        let measured = measured(scene, &methods, PIXELS, report)?;
        let choice = choose(&measured.methods, wish.tolerance, wish.budget);
        let plan = Self {
            method: measured.methods[choice.index].method,
            wish,
            chosen: choice.index,
            measured,
        };
        let Measurement { error, cost, .. } = plan.measurement();
        if let (false, Some(tolerance)) = (choice.accurate, wish.tolerance) {
            let within = if wish.budget.is_some() {
                " within the budget"
            } else {
                ""
            };
            let message = format!(
                "no method is within the tolerance of {tolerance}{within}; the best, {}, has an \
                 error of {error:.4}",
                plan.method
            );
            report.warn("tolerance-missed", message);
        }
        if let (false, Some(budget)) = (choice.affordable, wish.budget) {
            let message = format!(
                "no method is within the budget of {budget} times `point`; the cheapest, {}, takes \
                 {cost:.1}",
                plan.method
            );
            report.warn("budget-missed", message);
        }
        Ok(plan)
    }

    fn measurement(&self) -> &Measurement {
        &self.measured.methods[self.chosen]
    }

    /// The choice with all that was measured.
    pub(crate) fn to_json(&self) -> Value {
        let Measurement { error, cost, .. } = self.measurement();
        json!({
            "method": self.method.to_string(),
            "error": error,
            "cost": cost,
            "tolerance": self.wish.tolerance,
            "budget": self.wish.budget,
            "noise_floor": self.measured.noise_floor,
            "pixels": self.measured.pixels,
            "measured": self.measured.methods.iter().map(|m| json!({
                "method": m.method.to_string(), "error": m.error, "cost": m.cost,
            })).collect::<Vec<_>>(),
        })
    }
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Measurement { error, cost, .. } = self.measurement();
        let Measured { noise_floor, .. } = self.measured;
        write!(
            f,
            "measured error {error:.4} ± {noise_floor:.4}, cost {cost:.1} × point"
        )
    }
}
