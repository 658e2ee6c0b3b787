//! The search for the points that are nearest to several places at once.

use super::shape::{Output, Worley};
use crate::noise::cell::passed::{Passed, passed};
use crate::noise::cell::{hash, row_word, uniform};
use crate::noise::components::Hash;
use crate::noise::jenkins;
use crate::noise::period::wrapped;
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
    /// The squared distances of the nearest, of the second and of the third.
    first: Float<'b>,
    second: Option<Float<'b>>,
    third: Option<Float<'b>>,
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
    /// And the third.
    pub(super) third: bool,
    pub(super) numbers: bool,
    pub(super) places: bool,
}

impl Kept {
    /// What the value of a noise needs.
    pub(super) fn of(worley: Worley) -> Self {
        Self {
            second: worley.output != Output::First,
            third: worley.output == Output::Third,
            numbers: worley.solid,
            places: false,
        }
    }
}

impl<'b> Scalars<'b> for Nearest<'b> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        (self.first, self.second, self.third, self.value, self.other).each(visit);
        [self.at, self.other_at]
            .map(|at| at.map(|at| at.0))
            .each(visit);
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        let all = (self.first, self.second, self.third, self.value, self.other);
        let (first, second, third, value, other) = all.replaced(next);
        let places = [self.at, self.other_at].map(|at| at.map(|at| at.0));
        let [at, other_at] = places.replaced(next).map(|at| at.map(Vec2));
        Self {
            first,
            second,
            third,
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
            third: kept.third.then_some(far),
            value: kept.numbers.then_some(zero),
            other: (kept.numbers && kept.second).then_some(zero),
            at: kept.places.then_some(Vec2::splat(zero)),
            other_at: (kept.places && kept.second).then_some(Vec2::splat(zero)),
        }
    }

    /// The parameters of so many places.
    pub(super) fn declare(b: &'b Builder, kept: Kept, count: usize) -> Vec<Self> {
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
            ("third", self.third),
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
    pub(super) fn results(&self, b: &'b Builder, tap: usize) {
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
            Output::Third => of(self.other, self.third),
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

    /// One more point: its squared distance, its number and, if that is kept, where it is.
    pub(super) fn nearer(self, q: Float<'b>, number: Float<'b>, place: Option<Vec2<'b>>) -> Self {
        let won = q.lt(self.first);
        let second = |second: Float<'b>| second.min(self.first.max(q));
        let other = || {
            let placed = q.lt(self.second?).select(number, self.other?);
            Some(won.select(self.value?, placed))
        };
        let other_at = || {
            let (before, place) = (self.second?, place?);
            let [at, other] = [self.at?, self.other_at?];
            let placed = place.zip(other, |new, old| q.lt(before).select(new, old));
            Some(at.zip(placed, |moved, placed| won.select(moved, placed)))
        };
        // A third is what is left of three sorted numbers and a fourth.
        let third = |third: Float<'b>| {
            let second = self.second.expect("a third follows a second");
            third.min(second.max(q))
        };
        Self {
            first: self.first.min(q),
            second: self.second.map(second),
            third: self.third.map(third),
            value: self.value.map(|value| won.select(number, value)),
            other: other(),
            at: (self.at.zip(place))
                .map(|(at, place)| place.zip(at, |new, old| won.select(new, old))),
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

/// Where in its cell a point lies before the jitter, and its number.
pub(super) fn random<'b>(
    worley: Worley,
    [column, row]: [Int<'b>; 2],
    seed: Uint<'b>,
) -> ([Float<'b>; 2], Float<'b>) {
    let nothing = seed.builder().float(0.0);
    match worley.hash {
        Hash::Mipless => {
            let hash = hash(column, row_word(row, seed, worley.period), worley.period);
            let shares = [hash & 0xffff, hash >> 16].map(|bits| bits.to_float() * (1.0 / 65536.0));
            let channel = u32::from(worley.channel.unwrap_or_default());
            let number = || uniform((hash ^ (0x9e37_79b9 + channel)).scramble());
            (shares, if worley.solid { number() } else { nothing })
        }
        Hash::Materialx => {
            let [x, y] = [column, row].map(|cell| wrapped(cell, worley.period).to_uint());
            let of =
                |channel: u32| jenkins::unit(jenkins::space([x, y, seed.literal(channel)], seed));
            let number = match worley.channel {
                _ if !worley.solid => nothing,
                Some(channel) => of(u32::from(channel)),
                None => jenkins::unit(jenkins::plane([x, y], seed)),
            };
            ([of(0), of(1)], number)
        }
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
    let cell = [row.cell_x + place_x.to_int(), row.row];
    let (shares, number) = random(worley, cell, row.seed);
    let point = [(shares[0], place_x), (shares[1], row.place_y)]
        .map(|(share, place)| place + ((share + -0.5) * worley.jitter + 0.5));
    for (tap, (nearest, place)) in nearest.into_iter().zip(places).enumerate() {
        let square = (place - Vec2(point)).norm2();
        nearest
            .nearer(square, number, Some(Vec2(point)))
            .results(b, tap);
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
