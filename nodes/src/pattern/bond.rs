//! Where the bricks of a bond lie in its unit cell.

use super::harmonics::Shear;
use mipless_codegen::ir::{Float, Module, Uint};

/// How bricks are laid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Bond {
    /// Every other row is shifted.
    Running,
    /// Rows of stretchers and of headers.
    English,
    /// Stretchers and headers in each row.
    Flemish,
    /// Lying and standing bricks in a zigzag.
    Herringbone,
    /// Pairs of lying and of standing bricks.
    Basket,
    /// Lying and standing bricks around a square.
    Spanish,
}

/// A brick: its centre and its size, in bricks along x and rows along y.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Brick {
    /// The centre.
    pub(crate) centre: [f32; 2],
    /// Whether the running bond's offset is added to the centre's x.
    pub(crate) shifted: bool,
    /// Width and height.
    pub(crate) size: [f32; 2],
}

impl Brick {
    /// The centre for an offset of the running bond.
    pub(crate) fn place<'b>(&self, offset: Float<'b>) -> [Float<'b>; 2] {
        let [x, y] = self.centre.map(|v| offset.literal(v));
        // The shift moves the pattern along +x, so that the brick's start moves with it.
        [if self.shifted { offset + x } else { x }, y]
    }
}

/// The bricks of a unit cell as a table of a module.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rows {
    table: u32,
    has_shift: bool,
}

impl Rows {
    /// Of a bond.
    pub(crate) fn of(module: &mut Module, bond: Bond) -> Self {
        let bricks = bond.bricks();
        let rows: Vec<f32> = (bricks.iter())
            .flat_map(|brick| {
                let ([x, y], [width, height]) = (brick.centre, brick.size);
                [x, y, width, height, if brick.shifted { 1.0 } else { 0.0 }]
            })
            .collect();
        Self {
            table: module.table("bricks", rows),
            has_shift: bricks.iter().any(|brick| brick.shifted),
        }
    }

    /// Centre and size of one of them, in bricks and rows, for an offset of the running bond.
    pub(crate) fn brick<'b>(
        self,
        which: Uint<'b>,
        offset: Float<'b>,
    ) -> ([Float<'b>; 2], [Float<'b>; 2]) {
        let entry = |i: u32| offset.builder().load(self.table, which * 5 + i);
        let [mut x, y, width, height] = [0, 1, 2, 3].map(entry);
        if self.has_shift {
            x += entry(4) * offset;
        }
        ([x, y], [width, height])
    }
}

impl Bond {
    /// The bond of this name.
    ///
    /// # Panics
    /// If there is none: names are checked by the document's reader.
    pub(crate) fn named(name: &str) -> Self {
        match name {
            "running" => Self::Running,
            "english" => Self::English,
            "flemish" => Self::Flemish,
            "herringbone" => Self::Herringbone,
            "basket" => Self::Basket,
            "spanish" => Self::Spanish,
            _ => panic!("{name} is a bond"),
        }
    }

    /// The size of the unit cell, in bricks and rows.
    pub(crate) const fn cell(self) -> [f32; 2] {
        match self {
            Self::Running | Self::English => [1.0, 2.0],
            Self::Flemish => [1.5, 2.0],
            Self::Herringbone | Self::Basket => [2.0, 4.0],
            Self::Spanish => [1.5, 3.0],
        }
    }

    /// A point around which a half turn leaves the wall as it is, in bricks and rows, and what makes the
    /// cell primitive.
    pub(crate) fn symmetry(self, offset: f64) -> ([f64; 2], Shear) {
        let whole = Shear { lean: 0, tall: 1 };
        // The middle of the cell is as its corners.
        let centred = Shear { lean: 1, tall: 2 };
        match self {
            // Between a brick and the one above it.
            Self::Running if offset == 0.5 => ([0.75, 1.0], centred),
            Self::Running => ([0.5 + 0.5 * offset, 1.0], whole),
            Self::English => ([0.5, 0.5], whole),
            Self::Flemish => ([0.5, 0.5], centred),
            // A half brick further and a row up all is the same.
            Self::Herringbone => ([0.5, 0.5], Shear { lean: -1, tall: 4 }),
            // Where four bricks meet that stand and lie in pairs.
            Self::Basket => ([0.5, 1.0], centred),
            Self::Spanish => ([0.75, 1.5], whole),
        }
    }

    /// The bricks of a unit cell; those that leave it on one side enter it on the other.
    pub(crate) fn bricks(self) -> Vec<Brick> {
        let rows: Vec<[f32; 4]> = match self {
            Self::Running => vec![[0.5, 0.5, 1.0, 1.0], [0.5, 1.5, 1.0, 1.0]],
            // A header stands in the middle of every joint and of every stretcher.
            Self::English => vec![
                [0.5, 0.5, 1.0, 1.0],
                [0.0, 1.5, 0.5, 1.0],
                [0.5, 1.5, 0.5, 1.0],
            ],
            Self::Flemish => vec![
                [0.5, 0.5, 1.0, 1.0],
                [1.25, 0.5, 0.5, 1.0],
                [1.25, 1.5, 1.0, 1.0],
                [0.5, 1.5, 0.5, 1.0],
            ],
            // In half bricks: row i holds a lying brick from i to i + 2; the column i + 3 holds a
            // standing one in the rows i and i + 1.
            Self::Herringbone => (0..4)
                .map(|i| i as f32)
                .flat_map(|i| {
                    [
                        [0.5 * (i + 1.0), i + 0.5, 1.0, 1.0],
                        [0.5 * (i + 3.5), i + 1.0, 0.5, 2.0],
                    ]
                })
                .collect(),
            Self::Basket => (0..2)
                .map(|i| i as f32)
                .flat_map(|i| {
                    let other = 1.0 - i;
                    [
                        [i + 0.5, 2.0 * i + 0.5, 1.0, 1.0],
                        [i + 0.5, 2.0 * i + 1.5, 1.0, 1.0],
                        [other + 0.25, 2.0 * i + 1.0, 0.5, 2.0],
                        [other + 0.75, 2.0 * i + 1.0, 0.5, 2.0],
                    ]
                })
                .collect(),
            // Each brick begins where the one before it ends, around the square.
            Self::Spanish => vec![
                [0.25, 1.0, 0.5, 2.0],
                [1.0, 0.5, 1.0, 1.0],
                [1.25, 2.0, 0.5, 2.0],
                [0.5, 2.5, 1.0, 1.0],
                [0.75, 1.5, 0.5, 1.0],
            ],
        };
        (rows.into_iter().enumerate())
            .map(|(i, [x, y, width, height])| Brick {
                centre: [x, y],
                shifted: self == Self::Running && i == 1,
                size: [width, height],
            })
            .collect()
    }
}
