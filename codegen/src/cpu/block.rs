//! Straight code over registers of lanes: the loops that the compiler vectorises.

use super::code::{Code, Register, Step};
use crate::float::Float;
use crate::ir::for_each_op;
use std::any::Any;
use std::marker::PhantomData;
use std::mem::swap;

/// How many evaluations a register holds. A register of f32 is eight cache lines: long enough to
/// hide the choice of a step's code, short enough for some ninety registers in 48 KiB of L1.
pub(super) const LANES: usize = 128;

/// One register.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct Lanes<T>(pub(super) [T; LANES]);

/// The registers of both banks. Truth values are the words 0 and 1.
///
/// A step writes to the spare register of the bank, which then trades places with the step's
/// destination: so no destination is ever an operand, and no step allocates or copies.
#[derive(Debug)]
pub(super) struct Registers<F> {
    pub(super) floats: Vec<Box<Lanes<F>>>,
    #[expect(clippy::vec_box, reason = "registers trade places by their addresses")]
    pub(super) words: Vec<Box<Lanes<u32>>>,
    spare_float: Box<Lanes<F>>,
    spare_word: Box<Lanes<u32>>,
    /// How many steps have been taken.
    pub(super) steps: u64,
}

fn zeroed<T: Copy + Default>() -> Box<Lanes<T>> {
    Box::new(Lanes([T::default(); LANES]))
}

impl<F: Float> Registers<F> {
    pub(super) fn new() -> Self {
        Self {
            floats: Vec::new(),
            words: Vec::new(),
            spare_float: zeroed(),
            spare_word: zeroed(),
            steps: 0,
        }
    }

    /// Makes at least so many registers.
    pub(super) fn reserve(&mut self, floats: usize, words: usize) {
        self.floats
            .resize_with(self.floats.len().max(floats), zeroed);
        self.words.resize_with(self.words.len().max(words), zeroed);
    }
}

/// The element of the bank that holds a row's type.
macro_rules! stored {
    (F, $F:ident) => {
        $F
    };
    ($t:tt, $F:ident) => {
        u32
    };
}

/// A bank's element as a value of a row's type.
macro_rules! read {
    (F, $e:expr) => {
        $e
    };
    (i32, $e:expr) => {
        $e as i32
    };
    (u32, $e:expr) => {
        $e
    };
    (bool, $e:expr) => {
        $e != 0
    };
}

/// A value of a row's type as its bank's element.
macro_rules! write {
    (F, $e:expr) => {
        $e
    };
    (i32, $e:expr) => {
        $e as u32
    };
    (u32, $e:expr) => {
        $e
    };
    (bool, $e:expr) => {
        u32::from($e)
    };
}

/// The register of a row's type.
macro_rules! register {
    (F, $registers:ident, $index:expr) => {
        &$registers.floats[$index as usize].0
    };
    ($t:tt, $registers:ident, $index:expr) => {
        &$registers.words[$index as usize].0
    };
}

/// Runs a loop over the spare register of a row's result type, then puts it in place.
macro_rules! into_destination {
    (F, $registers:ident, $step:ident, |$out:ident| $run:expr) => {{
        let $out = &mut $registers.spare_float.0;
        $run;
        swap(
            &mut $registers.spare_float,
            &mut $registers.floats[$step.destination as usize],
        );
    }};
    ($t:tt, $registers:ident, $step:ident, |$out:ident| $run:expr) => {{
        let $out = &mut $registers.spare_word.0;
        $run;
        swap(
            &mut $registers.spare_word,
            &mut $registers.words[$step.destination as usize],
        );
    }};
}

/// Runs a row: the loop is a function of references, so that the compiler knows them apart.
macro_rules! run_row {
    ($registers:ident, $step:ident, ($($p:ident: $pt:tt),*) -> $rt:tt { $cpu:expr }) => {{
        #[inline(always)]
        fn lanes<F: Float>(
            _bank: PhantomData<F>,
            out: &mut [stored!($rt, F); LANES],
            $($p: &[stored!($pt, F); LANES]),*
        ) {
            for lane in 0..LANES {
                $(let $p = read!($pt, $p[lane]);)*
                let result: $rt = $cpu;
                out[lane] = write!($rt, result);
            }
        }
        let [$($p,)* ..] = $step.operands;
        into_destination!($rt, $registers, $step, |out| {
            lanes(PhantomData::<F>, out, $(register!($pt, $registers, $p)),*)
        });
    }};
}

macro_rules! define_run {
    ($($variant:ident $name:literal ($($p:ident: $pt:tt),*) -> $rt:tt { $cpu:expr } $wgsl:literal $error:literal $doc:literal;)*) => {
        /// Runs the steps in order. Every loop is inlined, so that it is compiled once for each
        /// instruction set.
        #[inline(always)]
        fn run<F: Float>(steps: &[Step<Register>], registers: &mut Registers<F>, tables: &[Box<[F]>]) {
            for step in steps {
                match step.code {
                    $(Code::$variant => run_row!(registers, step, ($($p: $pt),*) -> $rt { $cpu }),)*
                    Code::MulAdd => run_row!(registers, step, (a: F, b: F, c: F) -> F { a * b + c }),
                    Code::MulSub => run_row!(registers, step, (a: F, b: F, c: F) -> F { a * b - c }),
                    Code::SubMul => run_row!(registers, step, (a: F, b: F, c: F) -> F { c - a * b }),
                    Code::Load => {
                        let table = &*tables[step.operands[1] as usize];
                        let last = table.len() - 1;
                        let index = register!(u32, registers, step.operands[0]);
                        into_destination!(F, registers, step, |out| {
                            for lane in 0..LANES {
                                out[lane] = table[(index[lane] as usize).min(last)];
                            }
                        });
                    }
                    Code::Copy => run_row!(registers, step, (a: F) -> F { a }),
                    Code::CopyWord => run_row!(registers, step, (a: u32) -> u32 { a }),
                    Code::Exchange => {
                        registers.floats.swap(step.destination as usize, step.operands[0] as usize);
                    }
                    Code::ExchangeWord => {
                        registers.words.swap(step.destination as usize, step.operands[0] as usize);
                    }
                }
            }
        }
    };
}
for_each_op!(define_run);

/// The instruction set that the loops over lanes are compiled for. The bits of the results are the
/// same for each; none contracts a product and a sum into one rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// What every machine of the target has: SSE2 or NEON.
    Baseline,
    /// AVX2.
    Avx2,
    /// AVX-512 F, BW, DQ and VL.
    Avx512,
}

impl Level {
    /// Every level, in ascending order.
    pub const ALL: [Self; 3] = [Self::Baseline, Self::Avx2, Self::Avx512];

    /// The highest level that this machine has.
    pub fn detect() -> Self {
        Self::ALL
            .into_iter()
            .rev()
            .find(|level| level.is_available())
            .unwrap_or(Self::Baseline)
    }

    /// Whether this machine has the level.
    pub fn is_available(self) -> bool {
        match self {
            Self::Baseline => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => is_x86_feature_detected!("avx2"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512bw")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
            }
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => false,
        }
    }
}

/// A function that runs steps.
pub(super) type Runner<F> = fn(&[Step<Register>], &mut Registers<F>, &[Box<[F]>]);

/// The function that runs steps at `level`. The banks' are made here by functions that are not
/// generic, so that they are compiled and optimised with this crate, and not with each that evaluates.
///
/// # Panics
/// If this machine does not have the level.
pub(super) fn runner<F: Float>(level: Level) -> Runner<F> {
    assert!(level.is_available(), "this machine does not have {level:?}");
    let banks: [&dyn Any; 2] = [&single(level), &double(level)];
    let runner = banks.iter().find_map(|bank| bank.downcast_ref());
    *runner.expect("the banks are f32 and f64")
}

#[inline(never)]
fn single(level: Level) -> Runner<f32> {
    of_bank(level)
}

#[inline(never)]
fn double(level: Level) -> Runner<f64> {
    of_bank(level)
}

fn of_bank<F: Float>(level: Level) -> Runner<F> {
    match level {
        Level::Baseline => run::<F>,
        // SAFETY: the assertion of `runner` found the instruction set on this machine.
        #[cfg(target_arch = "x86_64")]
        Level::Avx2 => |steps, registers, tables| unsafe { run_avx2(steps, registers, tables) },
        // SAFETY: the assertion of `runner` found the instruction set on this machine.
        #[cfg(target_arch = "x86_64")]
        Level::Avx512 => |steps, registers, tables| unsafe { run_avx512(steps, registers, tables) },
        #[cfg(not(target_arch = "x86_64"))]
        Level::Avx2 | Level::Avx512 => unreachable!("the level is available"),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn run_avx2<F: Float>(steps: &[Step<Register>], registers: &mut Registers<F>, tables: &[Box<[F]>]) {
    run(steps, registers, tables);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
fn run_avx512<F: Float>(
    steps: &[Step<Register>],
    registers: &mut Registers<F>,
    tables: &[Box<[F]>],
) {
    run(steps, registers, tables);
}
