//! Pieces of work on all cores, whose results are taken in order and soon, so that few of them are in
//! memory at a time.

use std::collections::BTreeMap;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// How many pieces a thread may be ahead of what has been taken.
const AHEAD: usize = 3;

/// What the threads share.
struct Line<T> {
    /// The next piece that nobody makes yet.
    next: usize,
    /// The next piece that is taken.
    taken: usize,
    /// What is made and not taken.
    ready: BTreeMap<usize, T>,
    /// Whether nothing more is to be made.
    is_stopped: bool,
}

/// The line, and what tells of changes.
struct Belt<T> {
    line: Mutex<Line<T>>,
    changed: Condvar,
}

impl<T> Belt<T> {
    fn line(&self) -> MutexGuard<'_, Line<T>> {
        self.line.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'a>(&'a self, line: MutexGuard<'a, Line<T>>) -> MutexGuard<'a, Line<T>> {
        let waited = self.changed.wait(line);
        waited.unwrap_or_else(PoisonError::into_inner)
    }

    fn stop(&self) {
        self.line().is_stopped = true;
        self.changed.notify_all();
    }
}

/// Stops all others when its thread ends in a panic, which would wait for it else.
struct Stops<'a, T>(&'a Belt<T>);

impl<T> Drop for Stops<'_, T> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.stop();
        }
    }
}

/// Makes `count` pieces on `threads` threads and takes them one after the other on the calling thread.
///
/// # Errors
/// The first one of what makes or takes; nothing is taken after it.
///
/// # Panics
/// If a piece panics.
pub(crate) fn in_order<T: Send, E: Send>(
    count: usize,
    threads: usize,
    make: impl Fn(usize) -> Result<T, E> + Sync,
    mut take: impl FnMut(usize, T) -> Result<(), E>,
) -> Result<(), E> {
    let belt = Belt {
        line: Mutex::new(Line {
            next: 0,
            taken: 0,
            ready: BTreeMap::new(),
            is_stopped: false,
        }),
        changed: Condvar::new(),
    };
    let threads = threads.clamp(1, count.max(1));
    let work = || {
        let _stops = Stops(&belt);
        loop {
            let mut line = belt.line();
            while !line.is_stopped && line.next < count && line.next >= line.taken + AHEAD * threads
            {
                line = belt.wait(line);
            }
            if line.is_stopped || line.next == count {
                return;
            }
            let piece = line.next;
            line.next += 1;
            drop(line);
            let made = make(piece);
            belt.line().ready.insert(piece, made);
            belt.changed.notify_all();
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(work);
        }
        let _stops = Stops(&belt);
        for piece in 0..count {
            let mut line = belt.line();
            let made = loop {
                if let Some(made) = line.ready.remove(&piece) {
                    break made;
                }
                if line.is_stopped {
                    // A thread has panicked, and the scope says so.
                    return Ok(());
                }
                line = belt.wait(line);
            };
            line.taken = piece + 1;
            drop(line);
            belt.changed.notify_all();
            if let Err(error) = made.and_then(|made| take(piece, made)) {
                belt.stop();
                return Err(error);
            }
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn pieces_are_taken_in_order_and_few_wait() {
        let (made, mut taken) = (AtomicUsize::new(0), Vec::new());
        let make = |piece: usize| {
            // Odd ones are late.
            if piece % 2 == 1 {
                std::thread::yield_now();
            }
            made.fetch_add(1, Ordering::SeqCst);
            Ok::<_, ()>(piece * piece)
        };
        let take = |piece: usize, square: usize| {
            assert_eq!(square, piece * piece);
            assert!(made.load(Ordering::SeqCst) <= piece + 1 + AHEAD * 4 + 4);
            taken.push(piece);
            Ok(())
        };
        assert_eq!(in_order(500, 4, make, take), Ok(()));
        assert_eq!(taken, (0..500).collect::<Vec<_>>());
        assert_eq!(in_order(0, 4, |_| Ok::<(), ()>(()), |_, ()| Ok(())), Ok(()));
    }

    #[test]
    fn the_first_error_ends_it() {
        let make = |piece: usize| if piece == 7 { Err(piece) } else { Ok(()) };
        assert_eq!(in_order(100, 3, make, |_, ()| Ok(())), Err(7));
        let take = |piece: usize, ()| if piece == 3 { Err(piece) } else { Ok(()) };
        assert_eq!(in_order(100, 3, |_| Ok(()), take), Err(3));
    }
}
