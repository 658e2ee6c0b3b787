//! The CPU renderer: tiles of pixels over all cores.
//!
//! A tile is a run of pixels along the rows. Which thread evaluates it, and how many threads there
//! are, changes nothing: every pixel's result depends on its footprint alone, and every tile writes
//! its own part of the image.

use std::fmt;
use std::num::NonZeroUsize;

use mipless_codegen::ir::Interface;
use rayon::prelude::*;

use crate::footprint::Footprint;
use crate::image::{Image, result_names};
use crate::job::{Cancelled, Job, Tally};
use crate::view::{Size, View};

/// A compiled texture with its parameters, ready to be evaluated over lanes of footprints.
pub trait Evaluate: Sync {
    /// The float bank: f32, or f64 for the oracle.
    type Number: Copy + Default + Send + Sync;
    /// What one thread needs besides; it carries nothing from one call to the next.
    type Scratch;

    /// Memory for one thread.
    fn scratch(&self) -> Self::Scratch;

    /// Evaluates all footprints: result r of footprint i goes to `results[r][i]`. Every slice of
    /// `results` is as long as `footprints`.
    fn evaluate(
        &self,
        scratch: &mut Self::Scratch,
        footprints: &[Footprint],
        results: &mut [&mut [Self::Number]],
    );
}

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

/// Renders all results of a program over a view, with all cores or with `threads` threads. Pixels
/// of the background are 0 in every channel; [`View::present`] puts the background there.
///
/// The channels are the results in the order of [`crate::image::outputs`].
///
/// # Errors
/// If the job is cancelled, or if the threads cannot be started.
pub fn render<E: Evaluate>(
    evaluator: &E,
    interface: &Interface,
    view: &View,
    size: Size,
    threads: Option<NonZeroUsize>,
    job: Job<'_>,
) -> Result<Image<E::Number>, CpuError> {
    let Some(threads) = threads else {
        return Ok(tiles(evaluator, interface, view, size, job)?);
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.get())
        .build()
        .map_err(CpuError::Threads)?;
    Ok(pool.install(|| tiles(evaluator, interface, view, size, job))?)
}

fn tiles<E: Evaluate>(
    evaluator: &E,
    interface: &Interface,
    view: &View,
    size: Size,
    job: Job<'_>,
) -> Result<Image<E::Number>, Cancelled> {
    let names = result_names(interface);
    let mut channels = vec![vec![E::Number::default(); size.pixels()]; names.len()];
    let mut tiles: Vec<Vec<&mut [E::Number]>> = Vec::new();
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
        || Worker::new(evaluator, names.len()),
        |worker, (tile, mut results)| {
            tally.proceed()?;
            let start = tile * TILE;
            let end = size.pixels().min(start + TILE);
            worker.tile(view, size, start..end, &mut results);
            tally.add(end - start);
            Ok(())
        },
    )?;
    Ok(Image::new(size, &names, channels))
}

/// What one thread holds.
struct Worker<'a, E: Evaluate> {
    evaluator: &'a E,
    scratch: E::Scratch,
    footprints: Vec<Footprint>,
    covered: Vec<usize>,
    packed: Vec<Vec<E::Number>>,
}

impl<'a, E: Evaluate> Worker<'a, E> {
    fn new(evaluator: &'a E, results: usize) -> Self {
        Self {
            evaluator,
            scratch: evaluator.scratch(),
            footprints: Vec::with_capacity(TILE),
            covered: Vec::with_capacity(TILE),
            packed: vec![vec![E::Number::default(); TILE]; results],
        }
    }

    /// Evaluates the pixels of a tile that are not background.
    fn tile(
        &mut self,
        view: &View,
        size: Size,
        pixels: std::ops::Range<usize>,
        results: &mut [&mut [E::Number]],
    ) {
        self.footprints.clear();
        self.covered.clear();
        let whole = pixels.len();
        for (lane, index) in pixels.enumerate() {
            if let Some(footprint) = view.footprint(size, index) {
                self.footprints.push(footprint);
                self.covered.push(lane);
            }
        }
        if self.footprints.len() == whole {
            self.evaluator
                .evaluate(&mut self.scratch, &self.footprints, results);
            return;
        }
        if self.footprints.is_empty() {
            return;
        }
        let count = self.footprints.len();
        let mut packed: Vec<_> = self.packed.iter_mut().map(|p| &mut p[..count]).collect();
        self.evaluator
            .evaluate(&mut self.scratch, &self.footprints, &mut packed);
        for (channel, packed) in results.iter_mut().zip(&packed) {
            for (&lane, &value) in self.covered.iter().zip(packed.iter()) {
                channel[lane] = value;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;
    use std::sync::atomic::AtomicBool;

    use mipless_codegen::ir::Port;
    use mipless_graph::Type;

    use super::*;
    use crate::view::Sphere;

    /// The position and the size of the footprint, which depend on every lane being in its place.
    struct Position;

    impl Evaluate for Position {
        type Number = f64;
        type Scratch = ();

        fn scratch(&self) {}

        fn evaluate(&self, (): &mut (), footprints: &[Footprint], results: &mut [&mut [f64]]) {
            assert!(results.iter().all(|r| r.len() == footprints.len()));
            for (i, f) in footprints.iter().enumerate() {
                results[0][i] = f64::from(f.cell[0]) + f64::from(f.uv[0]);
                results[1][i] = f64::from(f.cell[1]) + f64::from(f.uv[1]);
            }
        }
    }

    fn interface() -> Interface {
        let port = Port {
            name: "uv".into(),
            ty: Type::Vector2,
            default: Vec::new(),
        };
        Interface {
            name: "position".into(),
            parameters: Vec::new(),
            outputs: vec![port],
            moments: false,
        }
    }

    #[test]
    fn any_number_of_threads_gives_the_same_bits_in_place() {
        let (size, view) = (Size::new(150, 97), View::Sphere(Sphere::default()));
        let with = |threads| {
            let threads = NonZeroUsize::new(threads);
            render(
                &Position,
                &interface(),
                &view,
                size,
                threads,
                Job::default(),
            )
            .unwrap()
        };
        let all = with(0);
        assert_eq!(all, with(1));
        assert_eq!(all, with(5));
        assert_eq!(all.names(), ["uv.X", "uv.Y"]);
        for index in 0..size.pixels() {
            let expected = view
                .hit(size, size.centre(index))
                .map_or([0.0; 2], |hit| hit.uv);
            for axis in 0..2 {
                let error = (all.channels()[axis][index] - expected[axis]).abs();
                assert!(error < 1e-7, "pixel {index}: {error:e}");
            }
        }
    }

    #[test]
    fn progress_reaches_the_last_row_and_cancelling_stops() {
        let (size, view) = (Size::new(300, 100), View::by_name("flat").unwrap());
        let rows = Mutex::new(Vec::new());
        let progress = |done, all| rows.lock().unwrap().push((done, all));
        let job = Job {
            progress: Some(&progress),
            ..Job::default()
        };
        render(&Position, &interface(), &view, size, None, job).unwrap();
        let rows = rows.into_inner().unwrap();
        assert_eq!(rows.iter().max(), Some(&(100, 100)));
        assert_eq!(rows.len(), (300 * 100usize).div_ceil(TILE));

        let cancel = AtomicBool::new(true);
        let job = Job {
            cancel: Some(&cancel),
            ..Job::default()
        };
        let result = render(&Position, &interface(), &view, size, None, job);
        assert!(
            matches!(result, Err(CpuError::Cancelled(Cancelled))),
            "{result:?}"
        );
    }
}
