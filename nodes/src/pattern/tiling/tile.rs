//! Figures of a size that is known when the graph is compiled.

use super::lattice::Lattice;
use super::rows::{Figure, Shape};
use super::series::Harmonics;
use super::{CROSSOVER, Place, Tiling, highest};
use crate::pattern::region::Outline;
use mipless_codegen::ir::{Bool, Builder};
use std::f64::consts::{PI, TAU};

/// What stands in a cell, around its centre.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Tile {
    /// A disc of a radius.
    Disc(f64),
    /// A polygon, symmetric in both axes, by half of its width at each of these heights, from the
    /// axis up; the last is its top.
    Polygon(Vec<[f64; 2]>),
}

impl Tile {
    /// One at every site of a lattice.
    pub(crate) fn on<'b>(&self, b: &'b Builder, lattice: Lattice) -> Tiling<'b> {
        let shape = match self {
            Self::Disc(radius) => Shape::Disc(*radius),
            Self::Polygon(sides) => Shape::Polygon(outline(sides)),
        };
        let reach = self.reach();
        let figure = Figure {
            shape: shape.clone(),
            reach,
            at: [0.0; 2],
            rise: 0.0,
        };
        Tiling {
            key: format!("{self:?}"),
            lattice,
            size: b.float(1.0),
            // What has no extent has no corners either.
            figures: Vec::from_iter((reach > 0.0).then_some(figure)),
            extent: reach,
            harmonics: self.harmonics(lattice),
            thinnest: CROSSOVER,
            inside: Box::new(move |place| point(lattice, &shape, place)),
            holes: false,
        }
    }

    /// Half of the width at a height.
    fn half_width(&self, y: f64) -> f64 {
        match self {
            Self::Disc(radius) => (radius * radius - y * y).max(0.0).sqrt(),
            Self::Polygon(sides) => {
                for pair in sides.windows(2) {
                    let [[low, wide], [high, narrow]] = [pair[0], pair[1]];
                    if y <= high {
                        let share = if high > low {
                            (y - low) / (high - low)
                        } else {
                            0.0
                        };
                        return wide + share * (narrow - wide);
                    }
                }
                0.0
            }
        }
    }

    /// The heights between which the half width is smooth.
    fn heights(&self) -> Vec<f64> {
        match self {
            Self::Disc(radius) => vec![0.0, *radius],
            Self::Polygon(sides) => sides.iter().map(|side| side[0]).collect(),
        }
    }

    /// From the centre to the farthest point.
    fn reach(&self) -> f64 {
        match self {
            Self::Disc(radius) => *radius,
            Self::Polygon(sides) => sides.iter().map(|[y, x]| x.hypot(*y)).fold(0.0, f64::max),
        }
    }

    /// ∫∫ cos 2π(kx + ly): four times a quadrant's, over heights that crowd at the top of a disc.
    fn transform(&self, k: f64, l: f64) -> f64 {
        const STEPS: usize = 400;
        let mut sum = 0.0;
        for pair in self.heights().windows(2) {
            let (low, span) = (pair[0], pair[1] - pair[0]);
            for i in 0..STEPS {
                // y = sin θ of the span.
                let angle = 0.5 * PI * (i as f64 + 0.5) / STEPS as f64;
                let y = low + span * angle.sin();
                let width = self.half_width(y);
                let across = if k == 0.0 {
                    width
                } else {
                    (TAU * k * width).sin() / (TAU * k)
                };
                let weight = span * angle.cos() * 0.5 * PI / STEPS as f64;
                sum += 4.0 * weight * across * (TAU * l * y).cos();
            }
        }
        sum
    }

    /// The series of one at every site.
    fn harmonics(&self, lattice: Lattice) -> Harmonics {
        let area = lattice.row();
        let rows = lattice
            .frequencies(highest(CROSSOVER))
            .into_iter()
            .map(|[k, l]| {
                let turned = TAU * lattice.origin() * (k + l * lattice.height());
                [k, l, 2.0 * turned.cos() * self.transform(k, l) / area]
            });
        Harmonics::known(self.transform(0.0, 0.0) / area, rows.collect())
    }
}

/// Counter-clockwise corners of a polygon that is symmetric in both axes.
fn outline(sides: &[[f64; 2]]) -> Outline {
    let corner = |x: f64, y: f64| [x as f32, y as f32, 0.0];
    // Up along the right, down along the left, and the same below; the axis has no corner.
    let half: Vec<[f64; 2]> = sides.iter().copied().filter(|[y, _]| *y > 0.0).collect();
    let mut vertices: Vec<[f32; 3]> = half.iter().map(|&[y, x]| corner(x, y)).collect();
    vertices.extend(
        half.iter()
            .rev()
            .filter(|s| s[1] > 0.0)
            .map(|&[y, x]| corner(-x, y)),
    );
    vertices.extend(half.iter().map(|&[y, x]| corner(-x, -y)));
    vertices.extend(
        half.iter()
            .rev()
            .filter(|s| s[1] > 0.0)
            .map(|&[y, x]| corner(x, -y)),
    );
    Outline { vertices }
}

/// Whether a place lies inside a figure: of each row next to it, the nearest.
fn point<'b>(lattice: Lattice, shape: &Shape, [x, y]: Place<'b>) -> Bool<'b> {
    let b = x.builder();
    let (zero, one) = (b.float(0.0), b.float(1.0));
    let mut inside = b.literal(false);
    for [shift, height] in lattice.rows() {
        let from = x + -shift as f32;
        let dx = from - (from + 0.5).floor();
        let dy = y + -height as f32;
        inside = inside
            | match shape {
                Shape::Polygon(outline) => {
                    outline.holds([[-dx, -dy], [one, zero], [zero, one], [zero, zero]])
                }
                Shape::Disc(radius) => (dx * dx + dy * dy).lt((radius * radius) as f32),
            };
    }
    inside
}
