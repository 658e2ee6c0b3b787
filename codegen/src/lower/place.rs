//! The places among the arguments of an entry, with footprints that are finite.

use super::Arguments;
use super::symbols::reads_position;
use crate::ir::{Builder, FOOTPRINT, Value};
use mipless_graph::Graph;
use std::ops::Range;

/// The largest change of texture coordinates per pixel that is told apart from an infinite one.
const LARGEST_FOOTPRINT: f32 = 1e9;

/// Where among the arguments a place stands: cells, fractions, and the changes of all axes from a
/// pixel to the next one to the right, and to the one below.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    first: usize,
    pub(super) axes: usize,
}

impl Place {
    pub(super) fn cell(self, axis: usize) -> usize {
        self.first + axis
    }

    pub(super) fn fraction(self, axis: usize) -> usize {
        self.first + self.axes + axis
    }

    /// Of all axes to the right, then of all axes down.
    pub(super) fn changes(self) -> Range<usize> {
        let first = self.first + 2 * self.axes;
        first..first + 2 * self.axes
    }
}

/// The places among the arguments: in texture space, and in space if the graph reads it.
pub(super) fn places(graph: &Graph) -> impl Iterator<Item = Place> {
    let space = Place {
        first: FOOTPRINT.len(),
        axes: 3,
    };
    let texture = Place { first: 0, axes: 2 };
    std::iter::once(texture).chain(reads_position(graph).then_some(space))
}

/// The arguments with a footprint that is finite: one that is not is taken for the largest, whose
/// filtered values are the far field's.
pub(super) fn finite(b: &mut Builder, graph: &Graph, arguments: &Arguments) -> Vec<Value> {
    let mut all = arguments.all();
    let limit = b.f32(LARGEST_FOOTPRINT);
    let zero = b.f32(0.0);
    for place in places(graph) {
        let mut regular = b.bool(true);
        for &value in &all[place.changes()] {
            let magnitude = b.abs(value);
            let within = b.lt(magnitude, limit);
            regular = b.and(regular, within);
        }
        for (i, at) in place.changes().enumerate() {
            // The first axis changes to the right, the second one down.
            let far = if i == 0 || i == place.axes + 1 {
                limit
            } else {
                zero
            };
            all[at] = b.select(regular, all[at], far);
        }
        for axis in 0..place.axes {
            let value = &mut all[place.fraction(axis)];
            let magnitude = b.abs(*value);
            let within = b.lt(magnitude, limit);
            *value = b.select(within, *value, zero);
        }
    }
    all
}
