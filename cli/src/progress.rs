//! Progress on work that takes longer than a second, for people at a terminal.

use crate::report::Report;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use mipless_runtime::job::Job;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// How long work may take in silence.
const SILENCE: Duration = Duration::from_secs(1);

/// Does `work` with a job that shows how far it is.
pub(crate) fn watch<R>(report: &Report, label: &str, work: impl FnOnce(Job<'_>) -> R) -> R {
    if !report.shows_progress() {
        return work(Job::default());
    }
    let begun = Instant::now();
    let bar: OnceLock<ProgressBar> = OnceLock::new();
    let progress = |done: u32, all: u32| {
        if begun.elapsed() < SILENCE {
            return;
        }
        let bar = bar.get_or_init(|| {
            let style = ProgressStyle::with_template("{msg} {wide_bar} {percent}% {eta}")
                .unwrap_or_else(|_| ProgressStyle::default_bar());
            ProgressBar::with_draw_target(Some(u64::from(all)), ProgressDrawTarget::stderr())
                .with_style(style)
                .with_message(label.to_owned())
                .with_elapsed(begun.elapsed())
        });
        bar.set_length(u64::from(all));
        bar.set_position(u64::from(done));
    };
    let result = work(Job {
        progress: Some(&progress),
        cancel: None,
    });
    if let Some(bar) = bar.get() {
        bar.finish_and_clear();
    }
    result
}
