//! The IR, the moment algebra, the planner, the WGSL emitter and the CPU batch evaluator.
//!
//! This crate knows no node by name: it receives node definitions as a slice.
//!
//! The feature `targets`, on by default, brings naga: `target::validate` and `target::translate`.

#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod cpu;
pub mod float;
#[cfg(feature = "targets")]
pub mod form;
pub mod ir;
mod lower;
pub mod moments;
pub mod shade;
pub mod target;
pub mod wgsl;

pub use lower::{
    Audit, AuditedBand, AuditedOutput, Bundle, Ensemble, Image, Lower, Method, NodeDef, NodeRule,
    Options, Over, ParseMethodError, PartNames, PixelFilter, Remedy, Replaced, Slopes, SumOfSteps,
    Upstream, Widened, audit, compile, compile_audited, jumps, pairs,
};
