//! The CPU renderer: tiles of pixels over all cores.
//!
//! A tile is a run of pixels along the rows. Which thread evaluates it, and how many threads there
//! are, changes nothing: every pixel's result depends on its footprint alone, and every tile writes
//! its own part of the image.

use std::fmt;
use std::num::NonZeroUsize;
use std::ops::Range;

use mipless_codegen::cpu::{Evaluator, Footprint, Position, Scratch};
use mipless_codegen::float::Float;
use mipless_codegen::ir::{Interface, Program};
use rayon::prelude::*;

use crate::image::{Image, result_names};
use crate::job::{Cancelled, Job, Tally};
use crate::view::{Part, Size, View};

/// Why a CPU render has no image.
#[derive(Debug)]
pub enum CpuError {
    /// It was stopped.
    Cancelled(Cancelled),
    /// The threads could not be started.
    Threads(rayon::ThreadPoolBuildError),
}

impl fmt::Display for CpuError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cancelled(cancelled) => cancelled.fmt(f),
            Self::Threads(error) => write!(f, "the threads could not be started: {error}"),
        }
    }
}

impl std::error::Error for CpuError {}

impl From<Cancelled> for CpuError {
    fn from(cancelled: Cancelled) -> Self {
        Self::Cancelled(cancelled)
    }
}

/// Pixels in a tile: enough to fill the lanes of a batch many times, few enough to share a small
/// picture among many cores and to be stopped soon.
const TILE: usize = 1024;

/// A program compiled for the CPU, with its parameters. `F` is f32, or f64 for the oracle.
#[derive(Debug)]
pub struct Renderer<F> {
    evaluator: Evaluator<F>,
    interface: Interface,
    parameters: Vec<f32>,
}

impl<F: Float> Renderer<F> {
    /// Compiles a program, with its default parameters.
    pub fn new(program: &Program) -> Self {
        let interface = program.interface.clone();
        let parameters = interface
            .parameters
            .iter()
            .flat_map(|p| p.default.clone())
            .collect();
        Self {
            evaluator: Evaluator::of_program(program),
            interface,
            parameters,
        }
    }

    /// Sets the parameters: one number a component, in the order of the program's interface.
    ///
    /// # Panics
    /// If there are not as many numbers as components.
    pub fn set_parameters(&mut self, numbers: &[f32]) {
        assert_eq!(
            numbers.len(),
            self.parameters.len(),
            "numbers for the parameters"
        );
        self.parameters.copy_from_slice(numbers);
    }

    /// Renders all results over a view, with all cores or with `threads` threads. Pixels of the
    /// background are 0 in every channel; [`View::present`] puts the background there.
    ///
    /// The channels are the results in the order of [`crate::image::outputs`].
    ///
    /// # Errors
    /// If the job is cancelled, or if the threads cannot be started.
    pub fn render(
        &self,
        view: &View,
        size: Size,
        threads: Option<NonZeroUsize>,
        job: Job<'_>,
    ) -> Result<Image<F>, CpuError> {
        let Some(threads) = threads else {
            return Ok(self.tiles(view, Part::all(size), job)?);
        };
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads.get())
            .build()
            .map_err(CpuError::Threads)?;
        Ok(pool.install(|| self.tiles(view, Part::all(size), job))?)
    }

    /// Renders a part of a picture with all cores, to the bit as it stands in the whole.
    ///
    /// # Errors
    /// If the job is cancelled.
    pub fn render_part(&self, view: &View, part: Part, job: Job<'_>) -> Result<Image<F>, CpuError> {
        Ok(self.tiles(view, part, job)?)
    }

    /// The same on the calling thread.
    pub fn strip(&self, view: &View, part: Part) -> Image<F> {
        let names = result_names(&self.interface);
        let pixels = part.size.pixels();
        let mut channels = vec![vec![F::default(); pixels]; names.len()];
        let mut worker = Worker::new(self);
        for start in (0..pixels).step_by(TILE) {
            let end = pixels.min(start + TILE);
            let mut results: Vec<&mut [F]> = (channels.iter_mut())
                .map(|channel| &mut channel[start..end])
                .collect();
            worker.tile(view, part, start..end, &mut results);
        }
        Image::new(part.size, &names, channels)
    }

    fn tiles(&self, view: &View, part: Part, job: Job<'_>) -> Result<Image<F>, Cancelled> {
        let size = part.size;
        let names = result_names(&self.interface);
        let mut channels = vec![vec![F::default(); size.pixels()]; names.len()];
        let mut tiles: Vec<Vec<&mut [F]>> = Vec::new();
        tiles.resize_with(size.pixels().div_ceil(TILE), || {
            Vec::with_capacity(names.len())
        });
        for channel in &mut channels {
            for (tile, part) in tiles.iter_mut().zip(channel.chunks_mut(TILE)) {
                tile.push(part);
            }
        }
        let tally = Tally::new(job, size);
        tiles.into_par_iter().enumerate().try_for_each_init(
            || Worker::new(self),
            |worker, (tile, mut results)| {
                tally.proceed()?;
                let start = tile * TILE;
                let end = size.pixels().min(start + TILE);
                worker.tile(view, part, start..end, &mut results);
                tally.add(end - start);
                Ok(())
            },
        )?;
        Ok(Image::new(size, &names, channels))
    }
}

/// What one thread holds.
struct Worker<'a, F> {
    renderer: &'a Renderer<F>,
    scratch: Scratch<F>,
    footprints: Vec<Footprint>,
    positions: Vec<Position>,
    /// Where in the tile each of the footprints belongs.
    lanes: Vec<usize>,
    outputs: Vec<Vec<F>>,
}

impl<'a, F: Float> Worker<'a, F> {
    fn new(renderer: &'a Renderer<F>) -> Self {
        Self {
            renderer,
            scratch: Scratch::new(),
            footprints: Vec::with_capacity(TILE),
            positions: Vec::with_capacity(TILE),
            lanes: Vec::with_capacity(TILE),
            outputs: Vec::new(),
        }
    }

    /// Evaluates the pixels of a tile that are not background.
    fn tile(&mut self, view: &View, part: Part, pixels: Range<usize>, results: &mut [&mut [F]]) {
        self.footprints.clear();
        self.positions.clear();
        self.lanes.clear();
        for (lane, index) in pixels.enumerate() {
            if let Some((footprint, position)) = view.pixel(part.whole, part.place(index)) {
                self.footprints.push(footprint);
                self.positions.push(position);
                self.lanes.push(lane);
            }
        }
        if self.footprints.is_empty() {
            return;
        }
        let Renderer {
            evaluator,
            parameters,
            ..
        } = self.renderer;
        let (scratch, outputs) = (&mut self.scratch, &mut self.outputs);
        let (footprints, positions) = (&self.footprints, &self.positions);
        evaluator.evaluate_surface(scratch, footprints, positions, parameters, outputs);
        for (result, output) in results.iter_mut().zip(outputs) {
            for (&lane, &value) in self.lanes.iter().zip(output.iter()) {
                result[lane] = value;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;
    use std::sync::atomic::AtomicBool;

    use mipless_codegen::ir::{Builder, FOOTPRINT, Module, Port};
    use mipless_graph::Type;

    use super::*;
    use crate::view::Sphere;

    /// The position times a parameter.
    fn position() -> Program {
        let b = &Builder::new("position", "The position times a parameter.");
        let footprint = FOOTPRINT.map(|(name, ty)| b.scalar_param(name, ty));
        let scale = b.float_param("scale");
        for axis in 0..2 {
            let (cell, uv) = (footprint[axis].int(), footprint[axis + 2].float());
            b.result(["x", "y"][axis], (cell.to_float() + uv) * scale);
        }
        let mut module = Module::default();
        b.finish(&mut module);
        let port = |name: &str, ty, default| Port {
            name: name.into(),
            ty,
            default,
        };
        let interface = Interface {
            name: "position".into(),
            parameters: vec![port("scale", Type::Float, vec![1.0])],
            outputs: vec![port("uv", Type::Vector2, Vec::new())],
            moments: false,
            position: false,
        };
        Program { module, interface }
    }

    #[test]
    fn any_number_of_threads_gives_the_same_bits_in_place() {
        let (size, view) = (Size::new(150, 97), View::Sphere(Sphere::default()));
        let mut renderer = Renderer::<f64>::new(&position());
        let with = |renderer: &Renderer<f64>, threads| {
            renderer
                .render(&view, size, NonZeroUsize::new(threads), Job::default())
                .unwrap()
        };
        let all = with(&renderer, 0);
        assert_eq!(all, with(&renderer, 1));
        assert_eq!(all, with(&renderer, 5));
        assert_eq!(all.names(), ["uv.X", "uv.Y"]);
        renderer.set_parameters(&[-2.0]);
        let scaled = with(&renderer, 0);
        for index in 0..size.pixels() {
            let expected = view
                .hit(size, size.centre(index))
                .map_or([0.0; 2], |hit| hit.uv);
            for axis in 0..2 {
                let got = all.channels()[axis][index];
                assert!(
                    (got - expected[axis]).abs() < 1e-7,
                    "pixel {index}: {got} {expected:?}"
                );
                assert_eq!(scaled.channels()[axis][index], -2.0 * got);
            }
        }
    }

    #[test]
    fn parts_are_what_the_whole_holds() {
        let (size, view) = (Size::new(150, 97), View::Sphere(Sphere::default()));
        let renderer = Renderer::<f32>::new(&position());
        let whole = renderer.render(&view, size, None, Job::default()).unwrap();
        for (column, row) in [(0, 0), (1, 2), (2, 1)] {
            let part = Part::tile(size, [column, row], [3, 4]).expect("it has pixels");
            let image = renderer.strip(&view, part);
            let shared = renderer.render_part(&view, part, Job::default()).unwrap();
            assert_eq!(image, shared);
            for (channel, whole) in image.channels().iter().zip(whole.channels()) {
                for (index, x) in channel.iter().enumerate() {
                    assert_eq!(x.to_bits(), whole[part.place(index)].to_bits());
                }
            }
        }
    }

    #[test]
    fn progress_reaches_the_last_row_and_cancelling_stops() {
        let (size, view) = (Size::new(300, 100), View::by_name("flat").unwrap());
        let renderer = Renderer::<f32>::new(&position());
        let rows = Mutex::new(Vec::new());
        let progress = |done, all| rows.lock().unwrap().push((done, all));
        let job = Job {
            progress: Some(&progress),
            ..Job::default()
        };
        renderer.render(&view, size, None, job).unwrap();
        let rows = rows.into_inner().unwrap();
        assert_eq!(rows.iter().max(), Some(&(100, 100)));
        assert_eq!(rows.len(), (300 * 100usize).div_ceil(TILE));

        let cancel = AtomicBool::new(true);
        let job = Job {
            cancel: Some(&cancel),
            ..Job::default()
        };
        let result = renderer.render(&view, size, None, job);
        assert!(
            matches!(result, Err(CpuError::Cancelled(Cancelled))),
            "{result:?}"
        );
    }
}
