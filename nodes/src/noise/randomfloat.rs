//! `randomfloat`: a random number for each number.

use crate::componentwise::{exposed, product, sum};
use crate::noise::cell::line::{Line, ROUNDING, filtered};
use crate::noise::cell::{MOST, lattice_seed, number};
use crate::noise::components::{HASH, Hash};
use crate::noise::jenkins;
use crate::noise::source::SEED;
use crate::noise::things::VARIANCE;
use crate::port;
use mipless_codegen::ir::{Float, Int};
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Ensemble, Lower};
use mipless_graph::{
    Behaviour, Category, Doc, Node, NodeSpec, OutputType, PortSpec, Range, Reach, Type,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "randomfloat",
    aliases: &["random", "random_float", "random_value", "hash"],
    category: Category::Noise,
    summary: "A random number between two bounds for each value of a number.",
    doc: Doc {
        computes: "out = min + (max − min) r, where r is the random number of the cell ⌊4096 · in + ½⌋, \
            uniform in [0, 1) and independent of the other cells': values of `in` that lie in different \
            steps of 1/4096 have different numbers. MaterialX has no ½; with it integers and multiples \
            of 1/4096 lie in the middle of their steps, where no rounding parts them.",
        statistics: "r is uniform: mean ½, variance 1/12, range [0, 1); not Gaussian (max |CDF − Φ| is \
            0.058). Its spectrum over `in` is that of a box, sinc². Of an \
            `in` that varies r is a cell noise on a line, filtered as `cellnoise2d` is: `in` is taken \
            for Gaussian, a cell weighs what of the Gaussian lies in it, and mean, slope and variance \
            are sums over the cells within 2.8 standard deviations. From three cells on, a standard \
            deviation of `in` of 7.5e-4, the mean fades to ½, reached at 1e-3, and what is dropped joins the \
            remainder: so few cells are seen one by one. Of what `in` has beyond its response to the position, a \
            standard deviation of 5e-4 is left out, for rounding. An `in` that takes two values, such as a mask, \
            gives what is between their numbers, exactly.",
        accuracy: "Where `in` is linear in the position, exact but for the window up to 2.5 cells, whatever the \
            footprint: the mean is within 0.005 standard deviations of the number, and the local \
            standard deviation within 0.005 (at 0.05 cells 0.04). Where it has faded, at 4.2 cells, the mean loses 0.27 and \
            the standard deviation 0.085, and less beyond. Of an `in` that jumps between more than two values, the footprint at an edge \
            has the mean of all numbers. Held by `nodes/tests/sources.rs` against dense sums.",
        references: "MaterialX 1.39, node `randomfloat` of its standard library, which reads \
            `cellnoise2d` at (4096 in, seed). Johnson & Kotz, *Continuous Univariate Distributions*, \
            ch. 13.",
    },
    inputs: &[
        IN,
        port::number("min", 0.0, "The least number.").range(Range::soft(0.0, 1.0)),
        port::number("max", 1.0, "The largest number.").range(Range::soft(0.0, 1.0)),
        SEED,
        HASH,
        SIGNATURE,
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |inputs| {
        Reach::mixed(
            inputs.reach("min"),
            inputs.reach("max"),
            Reach::of(0.0, 1.0),
        )
    },
    class: |_| Behaviour::Random { deviation: 0.058 },
    example: example! { "randomfloat", r#"
    "tiles": { "type": "brick", "inputs": { "output": "random", "bond": "spanish", "columns": 4 } },
    "randomfloat": { "type": "randomfloat", "inputs": { "in": { "node": "tiles" }, "min": 0.2, "max": 0.9 } }
"# },
};

/// Of what.
pub(crate) const IN: PortSpec =
    port::number("in", 0.0, "The number, of which steps of 1/4096 count.")
        .range(Range::soft(0.0, 1.0));

/// `in` in cells, those of whole numbers or those of steps, of which multiples of 1/4096 are the middles; with MaterialX's hash they begin there.
pub(crate) fn place<'b>(lower: &mut Lower<'_, 'b>, node: &Node, whole: bool) -> Signal<'b> {
    let number = exposed(lower, node, "in").swap_remove(0);
    match (whole, Hash::of(lower, node)) {
        // Whole numbers lie in the middles.
        (true, _) => number.offset(0.5),
        (_, Hash::Mipless) => (number * 4096.0).offset(0.5),
        (_, Hash::Materialx) => number * 4096.0,
    }
}

/// Whether steps of `in` are those of MaterialX's floats or those of its integers.
const SIGNATURE: PortSpec = port::choice(
    "signature",
    &["float", "integer"],
    "float",
    "What counts: steps of 1/4096 of a number, or whole numbers.",
);

/// MaterialX's number of a step: that of a cell of the plane, whose row is the seed.
pub(crate) fn materialx<'b>(cell: Int<'b>, seed: i32) -> Float<'b> {
    let b = cell.builder();
    jenkins::unit(jenkins::plane(
        [cell.to_uint(), b.uint(seed as u32)],
        b.uint(0),
    ))
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let whole = lower.choice(node, "signature") == "integer";
    let place = place(lower, node, whole);
    let seed = lower.integer(node, "seed");
    let hash = Hash::of(lower, node);
    let line = Line {
        key: format!("randomfloat {seed} {hash:?}"),
        parameters: Vec::new(),
        numbers: &|cell, _| {
            if hash == Hash::Materialx {
                return vec![materialx(cell, seed)];
            }
            let seed = lattice_seed(cell.builder(), seed, 0x9b05_688c);
            vec![number([cell, cell.literal(0)], seed, 0)]
        },
        ensemble: &|lower, _| Ensemble {
            means: vec![lower.b().float(0.5)],
            covariance: vec![lower.b().float(VARIANCE)],
        },
        most: MOST,
        rounding: ROUNDING,
    };
    let unit = filtered(lower, &place, &line).swap_remove(0);
    let unit = unit.with_range([0.0, 1.0]);
    let [min, max] = ["min", "max"].map(|port| lower.signal(node, port));
    let part = product(lower, &(max - &min), &unit);
    vec![sum(&part, &min)]
}
