//! A random number for each brick of a bond, filtered, or any function of the numbers.
//!
//! Bricks with half of the joints around them cover the plane: the mean is ½ + Σ w (r − ½), with w
//! the share of the footprint that a brick holds. Narrow footprints sum the bricks that they reach,
//! wide ones the tiles of the bricks. Where that would be too many the sum fades to ½, whose share of
//! the variance is that of the numbers. Of an image the mean over all numbers takes the place of ½.

mod near;
mod wide;

use super::bond::{Bond, Brick};
use super::separable::{orders, rest};
use super::taps::Taps;
use crate::noise::field::{Field, Spread};
use crate::noise::things::{VARIANCE, attach, channels, ensemble, named};
use mipless_codegen::ir::{
    Builder, Float, FunctionRef, Int, Module, Scalar, Scalars, Sym2, Uint, Vec2,
};
use mipless_codegen::moments::{Mode, Signal};
use mipless_codegen::{Image, Lower, pairs};

/// Standard deviations along a coordinate, in unit cells, without what the coordinates share: above
/// the first the sum fades, at the second it has faded.
const ALONE: [f32; 2] = [1.1, 1.6];

/// The same for √det Σ, the area of the whole footprint, in bricks: 4π of it are averaged, and what the
/// mean of so many numbers has left of a deviation is 0.03 at both. Each brick is summed: more would take
/// longer than anything else of a texture.
const BRICKS: [f32; 2] = [8.5, 10.0];

/// The most copies along a coordinate.
const MOST: f32 = 32.0;

/// What tells the bricks of a cell apart, times their numbers.
const BRICK: u32 = 0x85eb_ca6b;

/// A mean and its derivatives by the place.
const ORDERS: [&str; 6] = ["value", "dx", "dy", "dxx", "dxy", "dyy"];

/// The names of lists of numbers for each component of an image, one component after the other, and
/// those for each pair of components, a list after the other; then of the weight.
fn names(image: &Image, of_each: &[&str], of_pairs: &[&str]) -> Vec<String> {
    let count = image.channels();
    let each = (0..count).flat_map(|i| {
        of_each.iter().map(move |name| match count {
            1 => (*name).to_owned(),
            _ => format!("{name}_{i}"),
        })
    });
    let pairs = of_pairs.iter().map(|&name| (name, pairs(count).count()));
    let rest = named(&pairs.chain([("weight", 1)]).collect::<Vec<_>>());
    each.chain(rest).collect()
}

/// Names of the sums of w(r − ½) and derivatives, and of w(r − ½)² and w.
fn sums(image: &Image) -> Vec<String> {
    names(image, &ORDERS, &["square"])
}

/// Parameters of these names.
fn declared<'b>(b: &'b Builder, names: &[String]) -> Vec<Float<'b>> {
    names.iter().map(|name| b.float_param(name)).collect()
}

/// What is summed of the numbers of bricks: an image less what it is over all of them.
struct Summed<'a, 'c> {
    image: &'a Image,
    /// What it reads of the graph's inputs.
    parameters: Vec<Scalar<'c>>,
    /// What it is over all; of the number itself it is known.
    far: Vec<Float<'c>>,
}

impl<'a, 'c> Summed<'a, 'c> {
    /// As parameters of a function.
    fn declare(b: &'c Builder, image: &'a Image) -> Self {
        let count = if image.is_identity() {
            0
        } else {
            image.channels()
        };
        Self {
            image,
            far: channels(b, "far", count),
            parameters: image.declare(b),
        }
    }

    /// Of the brick's cell along x and of what its row shares.
    fn of(&self, cell: Int<'c>, row: Uint<'c>) -> Vec<Float<'c>> {
        if self.image.is_identity() {
            return vec![random(cell, row)];
        }
        let values = self.image.of(random(cell, row) + 0.5, &self.parameters);
        values
            .iter()
            .zip(&self.far)
            .map(|(&value, &far)| value - far)
            .collect()
    }
}

impl<'c> Scalars<'c> for Summed<'_, 'c> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'c>)) {
        self.far.each(visit);
        self.parameters.each(visit);
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'c>) -> Self {
        Self {
            image: self.image,
            far: self.far.replaced(next),
            parameters: self.parameters.replaced(next),
        }
    }
}

/// A random number in [0, 1] of the brick at a position in unit cells, or the image of it that is asked
/// for; `offset` as of the bond, `seed` chooses among walls.
pub(crate) fn numbered<'b>(
    lower: &mut Lower<'_, 'b>,
    position: &[Signal<'b>; 2],
    bond: Bond,
    offset: Float<'b>,
    seed: i32,
) -> Vec<Signal<'b>> {
    let mode = lower.mode();
    let b = lower.b();
    let (image, parameters) = lower.image();
    let places = [0, 1].map(|i| position[i].place());
    let (cells, place) = (places.map(|(cell, _)| cell), places.map(|(_, rest)| rest));
    let seed = b.uint(seed as u32);
    let fixed = offset.as_constant();
    let live = fixed.is_none().then_some(offset);
    let key = format!("random {bond:?} {fixed:?}");
    lower.algebra.bent = true;
    if mode == Mode::Point || position.iter().all(Signal::is_certain) {
        let function = lower.function(&format!("{key} point"), |module| {
            point_function(module, bond, fixed)
        });
        let value = b.call(&function, (place, cells, seed, live))[0];
        if image.is_identity() {
            return vec![Signal::certain(value).with_range([0.0, 1.0])];
        }
        let values = image.of(value, &parameters).into_iter();
        return values.map(Signal::certain).collect();
    }
    let spread = Spread::of(position);
    let key = format!("{key} {}", image.key());
    let tap = lower.function(&key, |module| near::tap(module, bond, fixed, &image));
    let tiles = lower.function(&format!("{key} wide"), |module| {
        wide::function(module, bond, fixed, &image)
    });
    // Each is counted from the mean of all, wherever the footprint is.
    let ensemble = ensemble(lower, &image, || b.literal(true));
    let summed = Summed {
        image: &image,
        parameters,
        far: ensemble
            .as_ref()
            .map_or_else(Vec::new, |all| all.means.clone()),
    };

    // Bricks one by one, or as Gaussians: the other sums are 0.
    let [xx, xy, yy] = *spread.covariance;
    let area = (xx * yy - xy.square()).max(0.0).sqrt();
    let kept = faded(area * bond.bricks().len() as f32, BRICKS);
    let taps = Taps::of(spread.covariance);
    let (parts, is_wide) = wide::parts(bond, spread.covariance, &taps);
    let count = is_wide.select(0, taps.count);
    let captures = (place, taps.nodes, kept, cells, seed, live, &summed);
    let none = vec![b.float(0.0); sums(&image).len() + 1];
    let near = b.fold(&tap, count, none, captures);
    let kept = is_wide.select(kept, 0.0);
    let arguments = (
        place,
        spread.covariance,
        parts,
        cells,
        seed,
        kept,
        live,
        &summed,
    );
    let far = b.call(&tiles, arguments);
    // Of no nodes, everything is 0.
    let inverse = 1.0 / near[0].max(1e-30);
    let sums: Vec<Float<'b>> = (far.iter().enumerate())
        .map(|(i, &far)| near[i + 1] * inverse + far)
        .collect();
    let (of_each, others) = sums.split_at(ORDERS.len() * image.channels());
    let (squares, weight) = others.split_at(others.len() - 1);

    let orders = orders(mode);
    let at = |i: usize, sums: &[Float<'b>]| if i < orders { sums[i] } else { b.float(0.0) };
    let means: Vec<Float<'b>> = (of_each.chunks(ORDERS.len()))
        .map(|sums| match image.is_identity() {
            true => sums[0].clamp(-0.5, 0.5),
            false => sums[0],
        })
        .collect();
    let mut fields: Vec<Field<'b>> = (of_each.chunks(ORDERS.len()).zip(&means).enumerate())
        .map(|(i, (sums, &centred))| Field {
            mean: match &ensemble {
                None => centred + 0.5,
                Some(ensemble) => centred + ensemble.means[i],
            },
            gradient: Vec2([1, 2].map(|i| at(i, sums))),
            hessian: Sym2([3, 4, 5].map(|i| at(i, sums))),
            rest: b.float(0.0),
        })
        .collect();
    let mut left = Vec::new();
    if mode.spreads() {
        for ((i, k), (place, &square)) in pairs(means.len()).zip(squares.iter().enumerate()) {
            let lost = (1.0 - weight[0]).max(0.0);
            let lost = match &ensemble {
                None => lost * VARIANCE,
                Some(ensemble) => lost * ensemble.covariance[place],
            };
            if i == k {
                let variance = square + lost - means[i].square();
                left.push(rest(&mut fields[i], &spread, variance));
            } else {
                let linear = fields[i]
                    .gradient
                    .dot(spread.covariance.times(fields[k].gradient));
                left.push(square + lost - means[i] * means[k] - linear);
            }
        }
    }
    let mut signals: Vec<Signal<'b>> = (fields.iter())
        .map(|field| field.at(lower, position))
        .collect();
    attach(lower, &image, &mut signals, &left);
    signals
}

/// What the bricks of a row of cells share of their numbers; `which` is the brick's number times
/// [`BRICK`].
fn row_hash<'b>(cell: Int<'b>, which: Uint<'b>, seed: Uint<'b>) -> Uint<'b> {
    ((cell.to_uint() * 0x9e37_79b1 + which) ^ seed).scramble()
}

/// The number of a brick less ½, from its cell along x and what its row shares.
fn random<'b>(cell: Int<'b>, row: Uint<'b>) -> Float<'b> {
    let leading = (cell.to_uint() ^ row).scramble() >> 8;
    leading.to_float() * (1.0 / (1u32 << 24) as f32) + -0.5
}

/// The brick's centre and size in unit cells.
fn in_cells<'b>(bond: Bond, brick: &Brick, offset: Float<'b>) -> ([Float<'b>; 2], [f32; 2]) {
    let cell = bond.cell();
    let centre = brick.place(offset);
    let centre = [0, 1].map(|i| centre[i] * (1.0 / cell[i]));
    (centre, [0, 1].map(|i| brick.size[i] / cell[i]))
}

fn offset_parameter(b: &Builder, fixed: Option<f32>) -> Float<'_> {
    match fixed {
        Some(x) => b.float(x),
        None => b.float_param("offset"),
    }
}

/// The parameters of a function that takes a cell.
fn declared_cells(b: &Builder) -> [Int<'_>; 2] {
    ["cell_x", "cell_y"].map(|name| b.int_param(name))
}

/// The number at a place.
fn point_function(module: &mut Module, bond: Bond, fixed: Option<f32>) -> FunctionRef {
    let b = &Builder::new("brick_number", "The random number of the brick at a place.");
    let place = b.float_params(["x", "y"]);
    let cells = declared_cells(b);
    let seed = b.uint_param("seed");
    let offset = offset_parameter(b, fixed);
    let mut sum = b.float(0.5);
    // At an edge two neighbours may both hold a place, or none, by the rounding of their sizes: the
    // first that does has it, and the last brick has what is left.
    let mut free = b.float(1.0);
    let last = bond.bricks().len() - 1;
    for (i, brick) in bond.bricks().iter().enumerate() {
        let (centre, size) = in_cells(bond, brick, offset);
        let mut inside = free;
        // The copy of the brick whose centre is next.
        let cells = [0, 1].map(|k| {
            let from = place[k] - centre[k];
            let rounded = (from + 0.5).floor();
            let from = from - rounded;
            // Half open, so that a place belongs to one brick.
            let within = from.ge(-0.5 * size[k]) & from.lt(0.5 * size[k]);
            if i < last {
                inside = within.select(inside, 0.0);
            }
            cells[k] + rounded.to_int()
        });
        let which = b.uint((i as u32).wrapping_mul(BRICK));
        sum += inside * random(cells[0], row_hash(cells[1], which, seed));
        free -= inside;
    }
    b.result("number", sum);
    b.finish(module)
}

/// The first whole number within `reach` of a place, and how many there are, at most [`MOST`].
fn within<'b>(place: Float<'b>, reach: Float<'b>) -> [Float<'b>; 2] {
    let below = (place - reach).floor();
    let last = (place + reach).floor();
    [below + 1.0, (last - below).clamp(0.0, MOST)]
}

/// 1 below the first number, 0 above the second.
fn faded(x: Float<'_>, [from, to]: [f32; 2]) -> Float<'_> {
    ((to - x) * (1.0 / (to - from))).clamp(0.0, 1.0)
}
