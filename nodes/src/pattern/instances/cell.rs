//! The figure of a cell, from the cell's hash.

use crate::noise::cell::uniform;
use crate::pattern::region::{Axes, Outline};
use mipless_codegen::ir::{Bool, Float, Uint, Vec2};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// How wide a footprint may be, as √(σ₁σ₂) in cells: above the first number what is summed fades, at the
/// second it has faded. Of tiles, each of which covers as much of its cell, less is left of so many.
const WIDTHS: [f32; 2] = [1.3, 1.56];
const WIDTHS_OF_TILES: [f32; 2] = [0.78, 0.94];

/// Edges of a quarter of a circle.
const EDGES: usize = 8;

/// What tells the numbers of a cell apart.
const NEXT: u32 = 0x85eb_ca6b;

/// What is scattered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A disc.
    Disc,
    /// A regular polygon of so many corners.
    Polygon(usize),
    /// Bands around two opposite corners of a cell, through the middles of its sides.
    Arcs,
    /// A half of a cell.
    Triangle,
}

/// How it is scattered.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scatter {
    pub(crate) kind: Kind,
    /// The diameter of the largest, in cells, and by what share of it others are smaller.
    pub(crate) size: f64,
    pub(crate) variation: f64,
    /// What share of the room in a cell the places take up.
    pub(crate) jitter: f64,
    /// By how much polygons are turned at most.
    pub(crate) turn: f64,
    /// What share of the cells has a figure.
    pub(crate) density: f64,
    /// The width of a band, in cells.
    pub(crate) band: f64,
    pub(crate) seed: i32,
    /// After how many cells all repeats; 0 for never.
    pub(crate) period: i32,
    /// Whether all figures have the number 1.
    pub(crate) is_mask: bool,
}

impl Scatter {
    /// The outline in its own frame.
    pub(super) fn outline(&self) -> Option<Outline> {
        match self.kind {
            Kind::Disc => None,
            Kind::Polygon(sides) => Some(Outline::around(sides, &[1.0], FRAC_PI_2)),
            Kind::Arcs => Some(self.arc()),
            Kind::Triangle => Some(Outline {
                vertices: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            }),
        }
    }

    /// A quarter of a ring around the origin, of the ring's area.
    fn arc(&self) -> Outline {
        let step = FRAC_PI_2 / EDGES as f64;
        let grown = (step / step.sin()).sqrt();
        let place = |radius: f64, i: usize| {
            let (sine, cosine) = (step * i as f64).sin_cos();
            let radius = radius * grown;
            [(radius * cosine) as f32, (radius * sine) as f32, 0.0]
        };
        let outer = (0..=EDGES).map(|i| place(0.5 + 0.5 * self.band, i));
        let inner = (0..=EDGES).rev().map(|i| place(0.5 - 0.5 * self.band, i));
        Outline {
            vertices: outer.chain(inner).collect(),
        }
    }

    /// Whether each cell is a tile, that has all of its figure.
    pub(super) const fn is_tiled(&self) -> bool {
        matches!(self.kind, Kind::Arcs | Kind::Triangle)
    }

    /// Between which widths of a footprint what is summed fades.
    pub(super) const fn widths(&self) -> [f32; 2] {
        if self.is_tiled() {
            WIDTHS_OF_TILES
        } else {
            WIDTHS
        }
    }

    /// The distances from the frame's origin between which all edges lie.
    pub(super) fn distances(&self, outline: &Outline) -> [f32; 2] {
        if !self.is_tiled() {
            return outline.distances();
        }
        // The origin lies outside, or on the edge.
        let outer = outline.vertices.iter().map(|[x, y, _]| x.hypot(*y));
        [0.0, outer.fold(0.0, f32::max)]
    }

    /// The area of a figure in units of its frame, and the variance of its places along an axis.
    pub(super) fn moments(&self) -> [f64; 2] {
        match self.kind {
            Kind::Disc => [PI, 0.25],
            Kind::Polygon(sides) => {
                let (sine, cosine) = (TAU / sides as f64).sin_cos();
                [0.5 * sides as f64 * sine, (2.0 + cosine) / 12.0]
            }
            // Two quarters of a ring.
            Kind::Arcs => [FRAC_PI_2 * self.band, 0.0],
            Kind::Triangle => [0.5, 0.0],
        }
    }

    /// The share of the plane that the figures cover.
    pub(super) fn coverage(&self) -> f64 {
        let [area, _] = self.moments();
        if self.is_tiled() {
            return area;
        }
        let v = self.variation;
        // E[(1 − v t)²] of a uniform t.
        let square = (0.5 * self.size).powi(2) * (1.0 - v + v * v / 3.0);
        self.density * area * square
    }
}

/// The figure of a cell, in cells from the cell's corner.
pub(super) struct Instance<'b> {
    pub(super) is_there: Bool<'b>,
    /// The origin of its frame.
    origin: [Float<'b>; 2],
    /// The first axis of its frame, and its length.
    along: [Float<'b>; 2],
    pub(super) size: Float<'b>,
    pub(super) number: Float<'b>,
}

impl<'b> Instance<'b> {
    /// Of a cell's hash.
    pub(super) fn of(scatter: &Scatter, word: Uint<'b>) -> Self {
        let b = word.builder();
        let random = |index: u32| uniform((word + NEXT.wrapping_mul(index)).scramble());
        let number = if scatter.is_mask {
            b.float(1.0)
        } else {
            uniform(word)
        };
        if scatter.is_tiled() {
            // Of the four corners one, or of opposite ones one pair.
            let aside = random(1).lt(0.5);
            let over = match scatter.kind {
                Kind::Triangle => random(2).lt(0.5),
                _ => b.literal(false),
            };
            let sign = over.select(-1.0, b.float(1.0));
            let corner = [aside.select(1.0, b.float(0.0)), b.float(0.0)];
            return Self {
                is_there: b.literal(true),
                origin: corner.map(|x| over.select(1.0 - x, x)),
                along: [aside.select(0.0, sign), aside.select(sign, 0.0)],
                size: b.float(1.0),
                number,
            };
        }
        let [size, variation, jitter, turn, density] = [
            scatter.size,
            scatter.variation,
            scatter.jitter,
            scatter.turn,
            scatter.density,
        ]
        .map(|x| x as f32);
        let diameter = random(1) * (-variation * size) + size;
        let room = (1.0 - diameter) * jitter;
        let radius = diameter * 0.5;
        let along = match scatter.kind {
            Kind::Polygon(_) => {
                let angle = (random(4) + -0.5) * (2.0 * turn);
                [angle.cos() * radius, angle.sin() * radius]
            }
            _ => [radius, b.float(0.0)],
        };
        Self {
            is_there: random(5).lt(density),
            origin: [2, 3].map(|index| (random(index) + -0.5) * room + 0.5),
            along,
            size: radius,
            number,
        }
    }

    /// The origins and first axes of its frames: of arcs there are two.
    pub(super) fn frames(&self, kind: Kind) -> Vec<[[Float<'b>; 2]; 2]> {
        let mut frames = vec![[self.origin, self.along]];
        if kind == Kind::Arcs {
            frames.push([self.origin.map(|x| 1.0 - x), self.along.map(|x| -x)]);
        }
        frames
    }

    /// Whether it holds the place that the cell's corner is at an offset from.
    pub(super) fn holds(&self, scatter: &Scatter, corner: [Float<'b>; 2]) -> Bool<'b> {
        let outline = scatter.outline();
        let mut inside = self.size.builder().literal(false);
        for [origin, along] in self.frames(scatter.kind) {
            let offset = [0, 1].map(|k| corner[k] + origin[k]);
            let own = match &outline {
                None => Vec2(offset).norm2().lt(self.size.square()),
                Some(outline) => outline.holds(axes(offset, along)),
            };
            inside = inside | own;
        }
        inside & self.is_there
    }
}

/// A frame of orthogonal axes.
pub(super) fn axes<'b>(origin: [Float<'b>; 2], [c, s]: [Float<'b>; 2]) -> Axes<'b> {
    let zero = c.literal(0.0);
    [origin, [c, s], [-s, c], [zero, zero]]
}
