//! Inputs that nobody wrote: sound ones of a kind, changed in a few places, run through a target until
//! something gives way.
//!
//! `MIPLESS_FUZZ=600` looks for so many seconds at inputs that no run before has seen; otherwise a
//! fixed number of them is the same in every run. What fails is written to `target/fuzz`, and kept in
//! `tests/fuzz`, where it is tried first.

use crate::random::Random;
use crate::root;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// An input that takes longer hangs.
const LONGEST: Duration = Duration::from_secs(60);

/// Sound inputs of one kind, and what its format is made of.
#[derive(Debug)]
pub struct Kind {
    /// The name of its folder.
    pub name: &'static str,
    /// Sound inputs.
    pub sound: Vec<Vec<u8>>,
    /// Pieces that are put in.
    pub words: &'static [&'static [u8]],
    /// How many inputs are tried in every run.
    pub usual: u64,
}

impl Kind {
    /// Tries inputs: those that are kept, the sound ones, and changed ones.
    ///
    /// # Panics
    /// If an input makes `target` panic, or takes a minute.
    pub fn try_inputs(&self, target: impl Fn(&[u8])) {
        let mut watch = Watch::new(self.name);
        let folder = root().join("tests/fuzz").join(self.name);
        for entry in fs::read_dir(folder).into_iter().flatten() {
            let path = entry.expect("an entry").path();
            let bytes = fs::read(&path).expect("a kept input");
            self.try_one(&path.display().to_string(), &bytes, &target, &watch);
        }
        for (place, bytes) in self.sound.iter().enumerate() {
            self.try_one(&format!("sound {place}"), bytes, &target, &watch);
        }
        let asked = std::env::var("MIPLESS_FUZZ").ok();
        let seconds = asked.and_then(|seconds| seconds.parse().ok());
        let mut count = 0;
        let start = Instant::now();
        let first = seconds.map_or(0, |_: u64| now());
        let more = |count| match seconds {
            Some(seconds) => start.elapsed() < Duration::from_secs(seconds),
            None => count < self.usual,
        };
        while more(count) {
            let seed = first + count;
            let bytes = self.changed(&mut Random::new(seed));
            self.try_one(&format!("seed {seed}"), &bytes, &target, &watch);
            count += 1;
        }
        watch.end();
        println!("{}: {count} inputs in {:.1?}", self.name, start.elapsed());
    }

    fn try_one(&self, name: &str, bytes: &[u8], target: &impl Fn(&[u8]), watch: &Watch) {
        watch.begins(bytes);
        if catch_unwind(AssertUnwindSafe(|| target(bytes))).is_err() {
            let file = written(self.name, name, bytes);
            panic!("{}, {name}: written to {}", self.name, file.display());
        }
    }

    /// A sound input with a few changes.
    fn changed(&self, random: &mut Random) -> Vec<u8> {
        let mut bytes = random.choose(&self.sound).clone();
        // One change is what finds most; many are needed to get past two checks.
        let most = 1 << random.below(5);
        let changes = 1 + random.below(most);
        for _ in 0..changes {
            self.change(&mut bytes, random);
        }
        bytes
    }

    fn change(&self, bytes: &mut Vec<u8>, random: &mut Random) {
        let at = random.below(bytes.len() + 1);
        // Short stretches more often than long ones.
        let most = 1 << random.below(12);
        let end = (at + 1 + random.below(most)).min(bytes.len());
        match random.below(9) {
            0 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
            1 if at < bytes.len() => bytes[at] = random.bits() as u8,
            2 if at < bytes.len() => {
                bytes.drain(at..end);
            }
            3 => {
                let copy = bytes[at.min(end)..end].to_vec();
                let to = random.below(bytes.len() + 1);
                bytes.splice(to..to, copy);
            }
            4 => {
                let other = random.choose(&self.sound);
                let from = random.below(other.len());
                let to = (from + 1 + random.below(most)).min(other.len());
                bytes.splice(at.min(end)..end, other[from..to].iter().copied());
            }
            5 => bytes.truncate(at),
            6 | 7 if !self.words.is_empty() => {
                let word = random.choose(self.words);
                // In the place of something of its length, or between two.
                let until = if random.happens(0.5) {
                    (at + word.len()).min(bytes.len())
                } else {
                    at
                };
                bytes.splice(at..until, word.iter().copied());
            }
            _ => self.number(bytes, at, random),
        }
    }

    /// Puts another number in the place of the next one that is written in digits.
    fn number(&self, bytes: &mut Vec<u8>, at: usize, random: &mut Random) {
        const ODD: [&str; 14] = [
            "0",
            "-0",
            "1",
            "-1",
            "2",
            "1e-45",
            "3.5e38",
            "1e999",
            "65536",
            "4294967296",
            "-2147483649",
            "9007199254740993",
            "NaN",
            "0.1",
        ];
        let digit = |byte: &u8| byte.is_ascii_digit() || b".-+eE".contains(byte);
        let rest = &bytes[at..];
        let Some(begin) = rest.iter().position(u8::is_ascii_digit) else {
            return;
        };
        let length = rest[begin..].iter().take_while(|byte| digit(byte)).count();
        let range = at + begin..at + begin + length;
        bytes.splice(range, random.choose(&ODD).bytes());
    }
}

/// A number that no run before had.
fn now() -> u64 {
    let time = SystemTime::now().duration_since(UNIX_EPOCH);
    time.map_or(1, |time| time.as_micros() as u64)
}

fn written(kind: &str, name: &str, bytes: &[u8]) -> PathBuf {
    let folder = root().join("target/fuzz").join(kind);
    let name = name.rsplit(['/', ' ']).next().unwrap_or(name);
    let file = folder.join(name);
    let result = fs::create_dir_all(&folder).and_then(|()| fs::write(&file, bytes));
    result.unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    file
}

/// Ends the process where an input takes too long, since nothing else ends what never returns.
struct Watch {
    inputs: Option<Sender<Vec<u8>>>,
    thread: Option<JoinHandle<()>>,
}

impl Watch {
    fn new(kind: &'static str) -> Self {
        let (inputs, begun) = channel::<Vec<u8>>();
        let thread = thread::spawn(move || {
            let mut last = Vec::new();
            loop {
                match begun.recv_timeout(LONGEST) {
                    Ok(bytes) => last = bytes,
                    Err(RecvTimeoutError::Disconnected) => return,
                    Err(RecvTimeoutError::Timeout) => {
                        let file = written(kind, "hangs", &last);
                        eprintln!("{kind}: over a minute, written to {}", file.display());
                        std::process::exit(1);
                    }
                }
            }
        });
        Self {
            inputs: Some(inputs),
            thread: Some(thread),
        }
    }

    fn begins(&self, bytes: &[u8]) {
        let inputs = self.inputs.as_ref().expect("it has not ended");
        inputs.send(bytes.to_vec()).expect("it listens");
    }

    fn end(&mut self) {
        self.inputs = None;
        if let Some(thread) = self.thread.take() {
            thread.join().expect("it ends");
        }
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.end();
    }
}
