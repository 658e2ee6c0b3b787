//! A scene that is evaluated some rows at a time, on any thread.

use crate::mistake::Mistake;
use crate::report::Report;
use crate::scene::Scene;
use mipless::{Options, Program};
use mipless_runtime::cpu::Renderer;
use mipless_runtime::device::Device;
use mipless_runtime::gpu::{Gpu, GpuError, Pipeline};
use mipless_runtime::image::Image;
use mipless_runtime::job::Job;
use mipless_runtime::lit::{Hiding, Lit};
use mipless_runtime::view::Part;
use std::sync::{Mutex, PoisonError};

/// What evaluates.
enum Engine<'a> {
    Cpu(Box<Renderer<f32>>),
    /// One thread at a time.
    Gpu(&'a Gpu, Box<Mutex<Pipeline>>),
}

/// A scene and what evaluates it.
pub(crate) struct Strips<'a> {
    scene: &'a Scene,
    program: Program,
    engine: Engine<'a>,
    lit: Option<Lit>,
}

impl<'a> Strips<'a> {
    /// Compiles. A GPU that was chosen on its own and cannot is replaced by the CPU, with a warning.
    pub(crate) fn new(
        scene: &'a Scene,
        options: &Options,
        report: &mut Report,
    ) -> Result<Self, Mistake> {
        let program = scene.texture.compile(options);
        let engine = match &scene.device {
            Device::Gpu(gpu) => match pipeline(gpu, scene, &program) {
                Ok(pipeline) => Engine::Gpu(gpu, Box::new(Mutex::new(pipeline))),
                Err(error) if scene.falls_back => {
                    let message = format!("{}: {error}; the CPU evaluates instead", scene.device);
                    report.warn("device-failed", message);
                    Engine::cpu(scene, &program)
                }
                Err(error) => return Err(failed(scene, &error)),
            },
            Device::Cpu => Engine::cpu(scene, &program),
        };
        Ok(Self {
            scene,
            program,
            engine,
            lit: scene.lit(Hiding::Facets),
        })
    }

    /// The pictures that people see of a part.
    pub(crate) fn pictures(&self, part: Part) -> Result<Vec<Image>, Mistake> {
        let view = &self.scene.view;
        let all = match &self.engine {
            Engine::Cpu(renderer) => renderer.strip(view, part),
            Engine::Gpu(gpu, pipeline) => {
                let pipeline = pipeline.lock().unwrap_or_else(PoisonError::into_inner);
                let rendered = gpu.render_part(&pipeline, view, part, Job::default());
                rendered.map_err(|error| failed(self.scene, &error))?.0
            }
        };
        let interface = &self.program.interface;
        Ok(self
            .scene
            .pictures(interface, self.lit.as_ref(), &all, part))
    }
}

impl Engine<'_> {
    fn cpu(scene: &Scene, program: &Program) -> Self {
        let mut renderer = Renderer::new(program);
        renderer.set_parameters(&scene.parameters);
        Self::Cpu(Box::new(renderer))
    }
}

fn pipeline(gpu: &Gpu, scene: &Scene, program: &Program) -> Result<Pipeline, GpuError> {
    let pipeline = gpu.pipeline(program)?;
    gpu.set_parameters(&pipeline, &scene.parameters)?;
    Ok(pipeline)
}

fn failed(scene: &Scene, error: &GpuError) -> Mistake {
    Mistake::usage("device-failed", format!("{}: {error}", scene.device))
        .help("`--device cpu` works everywhere")
}
