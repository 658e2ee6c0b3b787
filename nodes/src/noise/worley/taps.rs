//! The search for the points that are nearest to several places at once.

use super::shape::{Output, Worley};
use crate::noise::cell::passed::{Passed, passed};
use crate::noise::cell::{hash, row_word, uniform};
use mipless_codegen::ir::{Builder, Float, FunctionRef, Int, Module, Scalar, Scalars, Uint, Vec2};

/// x, y, weight: a unit Gaussian's integral to degree 5 (Stroud, E₂^{r²} 5-1).
pub(super) const NODES: [[f32; 3]; 7] = [
    [0.0, 0.0, 0.5],
    [2.0, 0.0, 1.0 / 12.0],
    [1.0, 1.732_050_8, 1.0 / 12.0],
    [-1.0, 1.732_050_8, 1.0 / 12.0],
    [-2.0, 0.0, 1.0 / 12.0],
    [-1.0, -1.732_050_8, 1.0 / 12.0],
    [1.0, -1.732_050_8, 1.0 / 12.0],
];

/// A squared distance beyond all.
const FAR: f32 = 1e6;

/// What is known of the points nearest to a place: as much as the noise reads.
#[derive(Clone, Copy)]
pub(super) struct Nearest<'b> {
    /// The squared distances of the nearest and of the second.
    first: Float<'b>,
    second: Option<Float<'b>>,
    /// Their numbers.
    value: Option<Float<'b>>,
    other: Option<Float<'b>>,
    /// Where they are.
    at: Option<Vec2<'b>>,
    other_at: Option<Vec2<'b>>,
}

/// What of them is kept.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kept {
    /// The second as well.
    pub(super) second: bool,
    pub(super) numbers: bool,
    pub(super) places: bool,
}

impl Kept {
    /// What the value of a noise needs.
    pub(super) fn of(worley: Worley) -> Self {
        Self {
            second: worley.output != Output::First,
            numbers: worley.solid,
            places: false,
        }
    }
}

impl<'b> Scalars<'b> for Nearest<'b> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        (self.first, self.second, self.value, self.other).each(visit);
        [self.at, self.other_at]
            .map(|at| at.map(|at| at.0))
            .each(visit);
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        let (first, second, value, other) =
            (self.first, self.second, self.value, self.other).replaced(next);
        let places = [self.at, self.other_at].map(|at| at.map(|at| at.0));
        let [at, other_at] = places.replaced(next).map(|at| at.map(Vec2));
        Self {
            first,
            second,
            value,
            other,
            at,
            other_at,
        }
    }
}

impl<'b> Nearest<'b> {
    /// Before any point.
    pub(super) fn none(b: &'b Builder, kept: Kept) -> Self {
        let (far, zero) = (b.float(FAR), b.float(0.0));
        Self {
            first: far,
            second: kept.second.then_some(far),
            value: kept.numbers.then_some(zero),
            other: (kept.numbers && kept.second).then_some(zero),
            at: kept.places.then_some(Vec2::splat(zero)),
            other_at: (kept.places && kept.second).then_some(Vec2::splat(zero)),
        }
    }

    /// The parameters of so many places.
    fn declare(b: &'b Builder, kept: Kept, count: usize) -> Vec<Self> {
        let named = |tap: usize| {
            let none = Self::none(b, kept);
            let mut names = none.names().into_iter();
            none.replaced(&mut || {
                let name = names.next().expect("a name for each part");
                b.float_param(format!("{name}_{tap}")).into()
            })
        };
        (0..count).map(named).collect()
    }

    fn names(&self) -> Vec<&'static str> {
        let parts = [
            ("first", Some(self.first)),
            ("second", self.second),
            ("value", self.value),
            ("other", self.other),
            ("at_x", self.at.map(|at| at[0])),
            ("at_y", self.at.map(|at| at[1])),
            ("other_x", self.other_at.map(|at| at[0])),
            ("other_y", self.other_at.map(|at| at[1])),
        ];
        let known = parts.into_iter().filter(|(_, part)| part.is_some());
        known.map(|(name, _)| name).collect()
    }

    /// Gives it as the results of a place.
    fn results(&self, b: &'b Builder, tap: usize) {
        for (name, part) in self.names().into_iter().zip(self.scalars()) {
            b.result(format!("{name}_{tap}"), part);
        }
    }

    /// The value at the place.
    pub(super) fn value(&self, worley: Worley) -> Float<'b> {
        let of = |number: Option<Float<'b>>, square: Option<Float<'b>>| match worley.solid {
            true => number.expect("a solid has numbers"),
            false => square.expect("distances that are read are kept").sqrt(),
        };
        let first = || of(self.value, Some(self.first));
        let second = || of(self.other, self.second);
        match worley.output {
            Output::First => first(),
            Output::Second => second(),
            Output::Difference => second() - first(),
        }
    }

    /// The number of the nearest.
    pub(super) fn number(&self) -> Float<'b> {
        self.value.expect("numbers that are read are kept")
    }

    /// Where the nearest is.
    pub(super) fn at(&self) -> Vec2<'b> {
        self.at.expect("places that are read are kept")
    }

    /// From the nearest to the second.
    pub(super) fn apart(&self) -> Vec2<'b> {
        self.other_at.expect("places that are read are kept") - self.at()
    }

    /// One more point: its squared distance, its number and where it is.
    fn nearer(self, q: Float<'b>, number: Float<'b>, place: Vec2<'b>) -> Self {
        let won = q.lt(self.first);
        let second = |second: Float<'b>| second.min(self.first.max(q));
        let other = || {
            let placed = q.lt(self.second?).select(number, self.other?);
            Some(won.select(self.value?, placed))
        };
        let other_at = || {
            let before = self.second?;
            let [at, other] = [self.at?, self.other_at?];
            let placed = place.zip(other, |new, old| q.lt(before).select(new, old));
            Some(at.zip(placed, |moved, placed| won.select(moved, placed)))
        };
        Self {
            first: self.first.min(q),
            second: self.second.map(second),
            value: self.value.map(|value| won.select(number, value)),
            other: other(),
            at: (self.at).map(|at| place.zip(at, |new, old| won.select(new, old))),
            other_at: other_at(),
        }
    }
}

/// The parameters of so many places.
fn declared_places(b: &Builder, count: usize) -> Vec<Vec2<'_>> {
    let places = (0..count).map(|tap| [format!("x_{tap}"), format!("y_{tap}")]);
    places
        .map(|names| Vec2(names.map(|name| b.float_param(name))))
        .collect()
}

passed! {
    /// What the cells of a row have in common.
    struct Row {
        start_x: Float,
        place_y: Float,
        cell_x: Int,
        row: Int,
        seed: Uint,
    }
}

/// The point of one cell, the body of a fold over columns.
fn column(module: &mut Module, worley: Worley, kept: Kept, count: usize) -> FunctionRef {
    let b = &Builder::new("worley_column", "The point of one cell.");
    let index = b.uint_param("index");
    let nearest = Nearest::declare(b, kept, count);
    let row = Row::declare(b);
    let places = declared_places(b, count);
    let place_x = row.start_x + index.to_float();
    let word = row_word(row.row, row.seed, worley.period);
    let hash = hash(row.cell_x + place_x.to_int(), word, worley.period);
    let point = [(hash & 0xffff, place_x), (hash >> 16, row.place_y)].map(|(bits, place)| {
        let share = bits.to_float() * (1.0 / 65536.0);
        place + ((share + -0.5) * worley.jitter + 0.5)
    });
    let number = if kept.numbers {
        uniform((hash ^ 0x9e37_79b9).scramble())
    } else {
        b.float(0.0)
    };
    for (tap, (nearest, place)) in nearest.into_iter().zip(places).enumerate() {
        let square = (place - Vec2(point)).norm2();
        nearest.nearer(square, number, Vec2(point)).results(b, tap);
    }
    b.finish(module)
}

passed! {
    /// What all rows have in common.
    pub(super) struct Rows {
        start_y: Float,
        start_x: Float,
        columns: Uint,
        cell_x: Int,
        cell_y: Int,
        seed: Uint,
    }
}

/// The points of one row of cells, the body of a fold.
pub(super) fn row(module: &mut Module, worley: Worley, kept: Kept, count: usize) -> FunctionRef {
    let column = column(module, worley, kept, count);
    let b = &Builder::new("worley_row", "The points of one row of cells.");
    let index = b.uint_param("index");
    let nearest = Nearest::declare(b, kept, count);
    let rows = Rows::declare(b);
    let places = declared_places(b, count);
    let place_y = rows.start_y + index.to_float();
    let row = Row {
        start_x: rows.start_x,
        place_y,
        cell_x: rows.cell_x,
        row: rows.cell_y + place_y.to_int(),
        seed: rows.seed,
    };
    let nearest = b.fold(&column, rows.columns, nearest, (row, places));
    for (tap, nearest) in nearest.iter().enumerate() {
        nearest.results(b, tap);
    }
    b.finish(module)
}
