//! Pictures on the CPU for tools: any view, any tile of it, into the caller's buffer, on all cores, coarse
//! first, and stopped at once.
//!
//! ```
//! use mipless::render::{Flat, Job, Picture, Size, View};
//! use mipless::{Options, Texture};
//!
//! let texture = Texture::from_json(r#"{ "version": 1, "name": "clouds",
//!     "nodes": { "noise": { "type": "noise2d", "inputs": { "frequency": 8 } } },
//!     "outputs": { "height": { "node": "noise" } } }"#).expect("no mistakes");
//! let evaluator = texture.evaluator(&Options::default());
//! assert_eq!(evaluator.channels()[0].to_string(), "height");
//!
//! let view = View::Flat(Flat { window: [0.0, 0.0, 1.0, 1.0] });
//! let picture = Picture::of_view(&view, Size::new(64, 32));
//! let mut pixels = vec![0.0; picture.numbers(&evaluator)];
//! evaluator.render(&picture, &mut pixels, Job::default()).expect("nothing stops it");
//!
//! // A tile is bit-equal to that part of the whole.
//! let tile = picture.tile([16, 8], Size::new(16, 16));
//! let mut part = vec![0.0; tile.numbers(&evaluator)];
//! evaluator.render(&tile, &mut part, Job::default()).expect("nothing stops it");
//! assert_eq!(part[..16], pixels[8 * 64 + 16..][..16]);
//! ```

pub use mipless_runtime::view::{Flat, Plane, Size, Sphere, View};

use crate::{Footprint, TextureEvaluator};
use mipless_codegen::cpu::{Position, Scratch};
use rayon::prelude::*;
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

/// Pixels that are evaluated between two looks at whether to go on: one batch of the evaluator.
const BATCH: usize = 128;

/// Gives the pixels of a picture their footprints: a view, or a function of a tool.
pub trait Grid: Sync {
    /// What the pixel around `point` sees, in continuous pixel coordinates: the centre of the pixel in
    /// column i and row j is (i + ½, j + ½). `None` is the background.
    fn pixel(&self, point: [f64; 2]) -> Option<(Footprint, Position)>;
}

/// A grid of a function that gives the footprint of the pixel around a point, on a flat surface.
#[derive(Clone, Copy, Debug)]
pub struct Footprints<F>(pub F);

impl<F: Fn([f64; 2]) -> Option<Footprint> + Sync> Grid for Footprints<F> {
    fn pixel(&self, point: [f64; 2]) -> Option<(Footprint, Position)> {
        let footprint = (self.0)(point)?;
        Some((footprint, Position::flat(&footprint)))
    }
}

impl Grid for &dyn Grid {
    fn pixel(&self, point: [f64; 2]) -> Option<(Footprint, Position)> {
        (**self).pixel(point)
    }
}

/// A view of so many pixels.
struct Seen<'v>(&'v View, Size);

impl Grid for Seen<'_> {
    fn pixel(&self, point: [f64; 2]) -> Option<(Footprint, Position)> {
        let hit = self.0.hit(self.1, point)?;
        Some((hit.footprint()?, hit.space()?))
    }
}

/// What is to be evaluated.
pub struct Picture<'g> {
    grid: Box<dyn Grid + 'g>,
    /// The column and the row of the first pixel.
    first: [u32; 2],
    size: Size,
}

impl<'g> Picture<'g> {
    /// All of a view.
    pub fn of_view(view: &'g View, size: Size) -> Self {
        Self {
            grid: Box::new(Seen(view, size)),
            first: [0; 2],
            size,
        }
    }

    /// The pixels of a grid from (0, 0) on.
    pub fn of_grid(grid: impl Grid + 'g, size: Size) -> Self {
        Self {
            grid: Box::new(grid),
            first: [0; 2],
            size,
        }
    }

    /// A part of it, `size` pixels from a column and a row of it on.
    pub fn tile(&self, [column, row]: [u32; 2], size: Size) -> Picture<'_> {
        let [left, top] = self.first;
        Picture {
            grid: Box::new(&*self.grid),
            first: [left + column, top + row],
            size,
        }
    }

    /// How many pixels it has.
    pub fn size(&self) -> Size {
        self.size
    }

    /// How many numbers its pixels are.
    pub fn numbers(&self, evaluator: &TextureEvaluator) -> usize {
        self.size.pixels() * evaluator.channels().len()
    }
}

/// Takes the side of the blocks of a pass, and the whole picture.
pub type Progress<'a> = &'a mut (dyn FnMut(u32, &[f32]) + 'a);

/// How a picture is evaluated. The default does it once, on all cores, and says nothing.
#[derive(Default)]
pub struct Job<'a> {
    /// Set it to stop: the picture then ends with [`RenderError::Cancelled`] after the batches in flight.
    pub cancel: Option<&'a AtomicBool>,
    /// The sides of the blocks, in pixels, that are evaluated before the pixels themselves, the largest
    /// first. A block is filtered as one large pixel, so that a coarse picture has no noise of its own.
    pub blocks: &'a [u32],
    /// Called with the whole picture after each of these passes, and with the side of its blocks.
    pub progress: Option<Progress<'a>>,
}

impl fmt::Debug for Job<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Job")
            .field("cancel", &self.cancel)
            .field("blocks", &self.blocks)
            .finish_non_exhaustive()
    }
}

/// Why there is no picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RenderError {
    /// It was stopped through [`Job::cancel`].
    Cancelled,
    /// The buffer holds another number of numbers.
    Buffer {
        /// Those of the picture.
        expected: usize,
        /// Those of the buffer.
        given: usize,
    },
}

impl fmt::Display for RenderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cancelled => write!(f, "the picture was cancelled"),
            Self::Buffer { expected, given } => {
                write!(f, "the picture has {expected} numbers, the buffer {given}")
            }
        }
    }
}

impl std::error::Error for RenderError {}

impl TextureEvaluator {
    /// Evaluates a picture into `into`, row by row, the channels of a pixel together, in the order of
    /// [`TextureEvaluator::channels`]. Pixels of the background are 0. Which threads there are changes no
    /// bit of it.
    ///
    /// # Errors
    /// If it is cancelled, or the buffer is of another size.
    pub fn render(
        &self,
        picture: &Picture<'_>,
        into: &mut [f32],
        mut job: Job<'_>,
    ) -> Result<(), RenderError> {
        let expected = picture.numbers(self);
        if into.len() != expected {
            let given = into.len();
            return Err(RenderError::Buffer { expected, given });
        }
        for &side in job.blocks.iter().filter(|&&side| side > 1).chain(&[1]) {
            self.pass(picture, side, into, job.cancel)?;
            if let Some(progress) = &mut job.progress {
                progress(side, into);
            }
        }
        Ok(())
    }

    /// Evaluates blocks of `side` pixels.
    fn pass(
        &self,
        picture: &Picture<'_>,
        side: u32,
        into: &mut [f32],
        cancel: Option<&AtomicBool>,
    ) -> Result<(), RenderError> {
        let channels = self.channels().len();
        let width = picture.size.width as usize;
        let band = side as usize * width * channels;
        let rows = into.par_chunks_mut(band.max(1)).enumerate();
        rows.try_for_each_init(Worker::default, |worker, (row, rows)| {
            let blocks: Vec<u32> = (0..picture.size.width.div_ceil(side)).collect();
            for columns in blocks.chunks(BATCH) {
                if cancel.is_some_and(|flag| flag.load(Ordering::Relaxed)) {
                    return Err(RenderError::Cancelled);
                }
                let at = (row as u32, columns);
                worker.blocks(self, picture, side, at);
                worker.store(rows, (width, channels), side as usize, columns);
            }
            Ok(())
        })
    }
}

/// What one thread holds.
#[derive(Default)]
struct Worker {
    scratch: Scratch<f32>,
    footprints: Vec<Footprint>,
    positions: Vec<Position>,
    /// Which of the blocks see the texture.
    seen: Vec<bool>,
    outputs: Vec<Vec<f32>>,
}

impl Worker {
    /// Evaluates blocks of one row of blocks.
    fn blocks(
        &mut self,
        evaluator: &TextureEvaluator,
        picture: &Picture<'_>,
        side: u32,
        (row, columns): (u32, &[u32]),
    ) {
        self.footprints.clear();
        self.positions.clear();
        self.seen.clear();
        let scale = f64::from(side);
        let [left, top] = picture.first.map(f64::from);
        for &column in columns {
            let point = [
                left + scale * (f64::from(column) + 0.5),
                top + scale * (f64::from(row) + 0.5),
            ];
            let pixel = picture.grid.pixel(point);
            self.seen.push(pixel.is_some());
            if let Some((footprint, position)) = pixel {
                let wide = |change: [f32; 2]| change.map(|x| x * side as f32);
                self.footprints.push(Footprint {
                    du: wide(footprint.du),
                    dv: wide(footprint.dv),
                    ..footprint
                });
                let wide = |change: [f32; 3]| change.map(|x| x * side as f32);
                self.positions.push(Position {
                    dx: wide(position.dx),
                    dy: wide(position.dy),
                    ..position
                });
            }
        }
        let (footprints, positions) = (&self.footprints, &self.positions);
        evaluator.surface(
            &mut self.scratch,
            (footprints, positions),
            &mut self.outputs,
        );
    }

    /// Puts their numbers where their pixels are.
    fn store(
        &self,
        rows: &mut [f32],
        (width, channels): (usize, usize),
        side: usize,
        columns: &[u32],
    ) {
        for rows in rows.chunks_mut(width * channels) {
            let mut lane = 0;
            for (&column, &seen) in columns.iter().zip(&self.seen) {
                let first = column as usize * side;
                let last = width.min(first + side);
                for pixel in rows[first * channels..last * channels].chunks_mut(channels) {
                    for (number, output) in pixel.iter_mut().zip(&self.outputs) {
                        *number = if seen { output[lane] } else { 0.0 };
                    }
                }
                lane += usize::from(seen);
            }
        }
    }
}
