//! Where the sites of a tiling are.

/// The distance of rows of a triangular lattice, as MaterialX has it.
const ROW: f64 = 0.866_025;

/// Sites that are 1 apart along rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Lattice {
    /// The middles of unit squares.
    Square,
    /// The origin, and rows that are half a cell apart, so that each site has six neighbours.
    Triangular,
    /// The origin, and rows that are half a cell apart, each as high as a cell is wide.
    Staggered,
    /// The corners and the middles of unit squares.
    Quincunx,
}

impl Lattice {
    /// The height of the unit cell, which is 1 wide.
    pub(crate) const fn height(self) -> f64 {
        if self.alternates() {
            2.0 * self.row()
        } else {
            self.row()
        }
    }

    /// Whether odd rows are shifted by half a cell.
    pub(super) const fn alternates(self) -> bool {
        !matches!(self, Self::Square)
    }

    /// From a row to the next.
    pub(super) const fn row(self) -> f64 {
        match self {
            Self::Square | Self::Staggered => 1.0,
            Self::Triangular => ROW,
            Self::Quincunx => 0.5,
        }
    }

    /// Both coordinates of the first site.
    pub(super) const fn origin(self) -> f64 {
        match self {
            Self::Square => 0.5,
            Self::Triangular | Self::Staggered | Self::Quincunx => 0.0,
        }
    }

    /// (shift, height) of the rows that are next to a place in the unit cell.
    pub(super) fn rows(self) -> Vec<[f64; 2]> {
        if self.alternates() {
            vec![[0.0, 0.0], [0.5, self.row()], [0.0, 2.0 * self.row()]]
        } else {
            vec![[self.origin(), self.origin()]]
        }
    }

    /// Half of the frequencies up to the highest that the lattice has, in cycles per cell, without 0: of
    /// two that are opposite, one.
    pub(super) fn frequencies(self, highest: f64) -> Vec<[f64; 2]> {
        let most = highest as i32 + 1;
        let mut found = Vec::new();
        for m in 0..=most {
            for n in -2 * most..=2 * most {
                let [k, l] = [f64::from(m), f64::from(n) / self.height()];
                let first = m > 0 || n > 0;
                let between = self.alternates() && (m + n) % 2 != 0;
                if first && !between && k.hypot(l) <= highest {
                    found.push([k, l]);
                }
            }
        }
        found
    }
}
