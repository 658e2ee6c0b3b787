//! Watching and stopping work that takes long.

use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use crate::view::Size;

/// How to report and stop a render. The default does neither.
#[derive(Clone, Copy, Default)]
pub struct Job<'a> {
    /// Called from any thread as rows get done, with the number of rows done so far and the number
    /// of all rows. The numbers of one thread never decrease.
    pub progress: Option<&'a (dyn Fn(u32, u32) + Sync)>,
    /// Set this to stop; the render then ends with [`Cancelled`] after the tiles in flight.
    pub cancel: Option<&'a AtomicBool>,
}

impl fmt::Debug for Job<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Job")
            .field("cancel", &self.cancel)
            .finish_non_exhaustive()
    }
}

/// The render was stopped through [`Job::cancel`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cancelled;

impl fmt::Display for Cancelled {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the render was cancelled")
    }
}

impl std::error::Error for Cancelled {}

/// The pixels done of one render.
pub(crate) struct Tally<'a> {
    job: Job<'a>,
    size: Size,
    done: AtomicUsize,
}

impl<'a> Tally<'a> {
    pub(crate) fn new(job: Job<'a>, size: Size) -> Self {
        Self {
            job,
            size,
            done: AtomicUsize::new(0),
        }
    }

    /// Whether to go on.
    pub(crate) fn proceed(&self) -> Result<(), Cancelled> {
        let cancelled = self
            .job
            .cancel
            .is_some_and(|flag| flag.load(Ordering::Relaxed));
        if cancelled { Err(Cancelled) } else { Ok(()) }
    }

    /// Counts `pixels` more as done.
    pub(crate) fn add(&self, pixels: usize) {
        let done = self.done.fetch_add(pixels, Ordering::Relaxed) + pixels;
        if let Some(progress) = self.job.progress {
            progress((done / self.size.width as usize) as u32, self.size.height);
        }
    }
}
