//! What the measure of a region is.

use mipless_codegen::ir::Float;

/// A measure and its derivatives by the mean: the value, ∂x, ∂y, ∂xx, ∂xy, ∂yy.
pub(crate) type Measure<'b> = [Float<'b>; 6];

/// Names of the state of a fold over a measure.
pub(crate) const NAMES: [&str; 6] = ["measure", "dx", "dy", "dxx", "dxy", "dyy"];
