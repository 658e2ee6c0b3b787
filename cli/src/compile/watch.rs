//! Compiling again whenever something that was read changes.

use super::{Arguments, round};
use crate::load::folder_of;
use crate::mistake::Mistake;
use crate::report::Report;
use notify::{Event, EventKind, RecursiveMode, Watcher};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver};
use std::time::Duration;

/// How long nothing must change until what has changed is read: editors write in several steps.
const PAUSE: Duration = Duration::from_millis(50);

/// Watches until the process is stopped.
pub(super) fn watch(
    arguments: &Arguments,
    mut read: Vec<PathBuf>,
    report: &mut Report,
) -> Result<(), Mistake> {
    let failed = |error: notify::Error| {
        let message = format!("the graphs cannot be watched: {error}");
        Mistake::usage("unwatchable-file", message).help("leave out `--watch`")
    };
    let (sender, events) = mpsc::channel();
    let mut watcher = notify::recommended_watcher(move |event| {
        // Without a receiver the process ends.
        drop(sender.send(event));
    })
    .map_err(failed)?;
    let mut folders = BTreeSet::new();
    loop {
        // Folders are watched and not files, since editors put a new file in the place of the old one.
        for folder in read.iter().filter_map(|path| place(path)) {
            let Some(folder) = folder.parent().map(Path::to_path_buf) else {
                continue;
            };
            if folders.insert(folder.clone()) {
                let mode = RecursiveMode::NonRecursive;
                watcher.watch(&folder, mode).map_err(failed)?;
            }
        }
        report.flush();
        report.note("watching; Ctrl+C ends it");
        let files: BTreeSet<PathBuf> = read.iter().filter_map(|path| place(path)).collect();
        if !wait(&events, &files) {
            return Ok(());
        }
        match round(arguments, report) {
            // A graph with mistakes says nothing of what it reads: what is known of it stays.
            Ok(found) => read.extend(found),
            Err(mistake) => report.mistake(&mistake),
        }
        read.sort();
        read.dedup();
    }
}

/// Where a file is without links in its folders; it need not exist.
fn place(path: &Path) -> Option<PathBuf> {
    let folder = fs::canonicalize(folder_of(path)).ok()?;
    Some(folder.join(path.file_name()?))
}

/// Waits until one of the files has changed, and then until nothing changes; false if nothing ever will.
fn wait(events: &Receiver<notify::Result<Event>>, files: &BTreeSet<PathBuf>) -> bool {
    let concerns = |event: &Event| {
        let is_change = matches!(
            event.kind,
            EventKind::Any | EventKind::Create(_) | EventKind::Modify(_) | EventKind::Remove(_)
        );
        is_change && event.paths.iter().any(|path| files.contains(path))
    };
    loop {
        match events.recv() {
            Ok(Ok(event)) if concerns(&event) => break,
            Ok(_) => {}
            Err(_) => return false,
        }
    }
    loop {
        match events.recv_timeout(PAUSE) {
            // What else happens in the folder keeps nobody waiting.
            Ok(Ok(event)) if !concerns(&event) => return true,
            Ok(_) => {}
            Err(_) => return true,
        }
    }
}
