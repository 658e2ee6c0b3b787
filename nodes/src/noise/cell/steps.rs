//! What follows the whole parts of coordinates, summed over the steps in the footprint: cells of a line
//! or of a plane, of which the image that is asked for is a function.

use super::line::{self, Line};
use super::{Content, filtered};
use mipless_codegen::Lower;
use mipless_codegen::ir::Bool;
use mipless_codegen::moments::Signal;

/// The most steps of one coordinate that are summed: twice as many as of each of two, since what the mean of
/// so few cells of a line has left of their deviation is seen.
const MOST: f32 = 48.0;

/// The image of the whole parts of one coordinate or of two.
pub(crate) fn summed<'b>(lower: &mut Lower<'_, 'b>, coordinates: &[Signal<'b>]) -> Vec<Signal<'b>> {
    let [coordinate] = coordinates else {
        return filtered(lower, coordinates, Content::Wholes);
    };
    let (image, parameters) = lower.image();
    let line = Line {
        key: format!("{} of steps", image.key()),
        parameters,
        numbers: &|cell, parameters| image.of_cell(&[cell], parameters),
        ensemble: &|lower, wanted: Bool<'b>| lower.ensemble(&image, wanted),
        most: MOST,
        rounding: 0.0,
    };
    line::filtered(lower, coordinate, &line)
}
