//! The form that the machine runs: steps over whole registers, and the control flow around them.

use crate::ir::{FunctionId, Op, for_each_op};

macro_rules! define_code {
    ($($variant:ident $name:literal ($($p:ident: $pt:tt),*) -> $rt:tt { $cpu:expr } $wgsl:literal $error:literal $doc:literal;)*) => {
        /// What a step does: a row of the op table, or one of the machine's own.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(super) enum Code {
            $($variant,)*
            /// `a · b + c` with both roundings.
            MulAdd,
            /// `a · b − c` with both roundings.
            MulSub,
            /// `c − a · b` with both roundings.
            SubMul,
            /// A number of the table `b` at index `a`.
            Load,
            /// A copy between float registers.
            Copy,
            /// A copy between word registers.
            CopyWord,
            /// Float registers trade places: a copy that leaves its source meaningless.
            Exchange,
            /// Word registers trade places.
            ExchangeWord,
        }

        impl From<Op> for Code {
            fn from(op: Op) -> Self {
                match op {
                    $(Op::$variant => Self::$variant,)*
                }
            }
        }
    };
}
for_each_op!(define_code);

/// The number of a register: graphs may have more constants than sixteen bits count.
pub(super) type Register = u32;

/// One pass over the lanes: registers of type `R` go in and one comes out.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step<R> {
    pub(super) code: Code,
    pub(super) destination: R,
    /// As many as the code reads; the others are never read.
    pub(super) operands: [R; 3],
}

/// A part of a function's code.
#[derive(Clone, Debug)]
pub(super) enum Node<R> {
    /// Straight code.
    Block(Box<[Step<R>]>),
    /// The code of another function, between copies that belong to blocks.
    Call(FunctionId),
    /// See [`crate::ir::Inst::Fold`].
    Fold(Box<Fold<R>>),
}

/// A loop over the code of a function.
#[derive(Clone, Debug)]
pub(super) struct Fold<R> {
    pub(super) function: FunctionId,
    /// How many turns each lane asks for.
    pub(super) count: R,
    /// How many turns each lane takes: none where it is not active. Written by the loop.
    pub(super) limit: R,
    /// The lanes that are active in a turn. Written by the loop.
    pub(super) mask: R,
    /// The body's parameter for the number of the turn.
    pub(super) index: R,
    /// From the caller's registers to the body's state.
    pub(super) init: Box<[Step<R>]>,
    /// From the caller's registers to the body's captures.
    pub(super) captures: Box<[Step<R>]>,
    /// From the body's results to its state, in all lanes.
    pub(super) update: Box<[Step<R>]>,
    /// From the body's results to its state, where `mask` holds.
    pub(super) masked_update: Box<[Step<R>]>,
    /// From the body's state to the caller's registers.
    pub(super) results: Box<[Step<R>]>,
}

impl<R: Copy> Step<R> {
    fn renamed<S>(&self, rename: &impl Fn(R) -> S) -> Step<S> {
        Step {
            code: self.code,
            destination: rename(self.destination),
            operands: self.operands.map(rename),
        }
    }
}

impl<R: Copy> Node<R> {
    /// The same code with other registers.
    pub(super) fn renamed<S>(&self, rename: &impl Fn(R) -> S) -> Node<S> {
        let block = |steps: &[Step<R>]| steps.iter().map(|step| step.renamed(rename)).collect();
        match self {
            Self::Block(steps) => Node::Block(block(steps)),
            Self::Call(function) => Node::Call(*function),
            Self::Fold(fold) => Node::Fold(Box::new(Fold {
                function: fold.function,
                count: rename(fold.count),
                limit: rename(fold.limit),
                mask: rename(fold.mask),
                index: rename(fold.index),
                init: block(&fold.init),
                captures: block(&fold.captures),
                update: block(&fold.update),
                masked_update: block(&fold.masked_update),
                results: block(&fold.results),
            })),
        }
    }
}
