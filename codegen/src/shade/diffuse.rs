//! Matt facets: Lambert's law over the slopes that the eye sees.

use super::slopes::{Part, nodes, normal};
use super::{Direction, Seen, dot3};
use crate::ir::Float;

/// E[(n·i)⁺ (o·(−s, 1))⁺] of a part of the facets: its mean over the slopes that the eye sees, by seven
/// nodes, times the area that it shows. RMS .007 to slopes of 1 (Lambert's kink is the rest).
pub(super) fn numerator<'b>(
    part: &Part<'b>,
    view: Direction<'b>,
    light: Direction<'b>,
) -> Float<'b> {
    let seen = Seen::of(view, part.mean, part.covariance);
    let cosines = nodes(seen.mean, seen.covariance)
        .map(|(slope, weight)| weight * dot3(normal(slope), light).max(0.0));
    let mean = part.share.builder().sum(cosines);
    part.share * seen.area * mean
}
