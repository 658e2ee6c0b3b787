//! Woven threads.

use crate::pattern::checkerboard::tiled;
use crate::pattern::grid::{TEXCOORD, UVOFFSET};
use crate::pattern::pulse::Pulse;
use crate::pattern::separable::{Pattern, Term, Terms, filtered};
use crate::pattern::unless::pattern_unless;
use crate::port;
use mipless_codegen::ir::{Builder, Float};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, Node, NodeSpec, OutputType, Range, Reach, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "weave",
    aliases: &[
        "woven",
        "cloth",
        "fabric",
        "basketweave",
        "wicker",
        "twill",
        "satin",
    ],
    category: Category::Pattern,
    summary: "Threads along both coordinates that go over and under each other.",
    doc: Doc {
        computes: "With (u, v) = texcoord · uvtiling − uvoffset, a weft thread of the given width lies along \
            u in the middle of every unit of v, and a warp thread along v in the middle of every unit of u. \
            Which one is on top where the threads i and j cross is the weave: in `plain`, the weft where \
            i + j is even; in `twill`, where i − j, modulo 4, is 0 or 1; in `satin`, where i − 2j is a \
            multiple of 5. out = 1 where a thread is, with the output `threads`; where a weft thread is \
            seen, with `weft`; a warp thread, with `warp`; else 0.",
        statistics: "A sum of products of two periodic pulses, one a coordinate, as `grid`: each pulse in \
            closed form, their products exact where the coordinates are independent and by a trapezoid \
            rule over what they share where they are not. Variance P(1 − P). Over a large footprint the \
            mean is the share of the plane.",
        accuracy: "The mean is within 1e-3 for footprints along the axes and within 3e-3 for rotated ones up \
            to 8:1. Held by `nodes/tests/sources.rs` against dense sums.",
        references: "Heckbert 1989, *Fundamentals of Texture Mapping and Image Warping*, §3.5.8. Trefethen & \
            Weideman 2014, *The Exponentially Convergent Trapezoidal Rule*. Grünbaum & Shephard 1980, \
            *Satins and Twills: An Introduction to the Geometry of Fabrics*.",
    },
    inputs: &[
        TEXCOORD,
        port::pair(
            "uvtiling",
            [8.0, 8.0],
            "How many threads a unit of texture space holds.",
        )
        .range(Range::soft(1.0, 64.0))
        .unit("threads per uv"),
        UVOFFSET,
        port::choice(
            "weave",
            &["plain", "twill", "satin"],
            "plain",
            "Which thread is on top where.",
        ),
        port::number("width", 0.8, "The width of the threads.")
            .range(Range::hard(0.0, 1.0))
            .unit("cells"),
        port::choice(
            "output",
            &["threads", "weft", "warp"],
            "weft",
            "Which threads are 1.",
        ),
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |_| Reach::of(0.0, 1.0),
    class: |inputs| pattern_unless(inputs, &["uvtiling", "uvoffset", "width"]),
    example: example! { "weave", r#"
    "weave": { "type": "weave", "inputs": { "weave": "twill" } }
"# },
};

/// Which threads are seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Seen {
    All,
    Weft,
    Warp,
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    // After how many threads the weave repeats, and where the weft is on top.
    let (count, over): (i32, fn(i32, i32) -> bool) = match lower.choice(node, "weave") {
        "twill" => (4, |i, j| (i - j).rem_euclid(4) < 2),
        "satin" => (5, |i, j| (i - 2 * j).rem_euclid(5) == 0),
        _ => (2, |i, j| (i + j) % 2 == 0),
    };
    let seen = match lower.choice(node, "output") {
        "weft" => Seen::Weft,
        "warp" => Seen::Warp,
        _ => Seen::All,
    };
    let crossings: Vec<[i32; 2]> = (0..count)
        .flat_map(|j| (0..count).map(move |i| [i, j]))
        .filter(|&[i, j]| over(i, j))
        .collect();
    let position = tiled(lower, node, [1.0 / count as f32; 2]);
    let width = lower.number(node, "width").clamp(0.0, 1.0);
    let terms = Terms {
        key: format!("weave {count} {seen:?}"),
        of: &|b, parameters| (0.0, threads(b, parameters[0], count, seen, &crossings)),
    };
    let pattern = Pattern {
        cell: &terms,
        parameters: vec![width],
        ramps: None,
    };
    vec![filtered(lower, &position, &pattern)]
}

/// With F and W where weft and warp threads are: all are F + W − F W, of which the weft is F − F W + C and
/// the warp W − C, where C are the crossings at which the weft is on top.
fn threads<'b>(
    b: &'b Builder,
    width: Float<'b>,
    count: i32,
    seen: Seen,
    crossings: &[[i32; 2]],
) -> Vec<Term<'b>> {
    let count = count as f32;
    let every = Pulse {
        repeat: count,
        centre: b.float(0.5),
        half: width * 0.5,
        bevel: b.float(0.0),
        short: true,
    };
    let one = |i: i32| Pulse {
        repeat: 1.0,
        centre: b.float((i as f32 + 0.5) / count),
        half: width * (0.5 / count),
        ..every
    };
    let alone = |x, y| Term {
        coefficient: 1.0,
        x,
        y,
    };
    let mut terms = Vec::new();
    if seen != Seen::Warp {
        terms.push(alone(None, Some(every)));
        terms.push(Term::product(every, every).times(-1.0));
    }
    if seen != Seen::Weft {
        terms.push(alone(Some(every), None));
    }
    let sign = match seen {
        Seen::All => return terms,
        Seen::Weft => 1.0,
        Seen::Warp => -1.0,
    };
    let crossed = crossings
        .iter()
        .map(|&[i, j]| Term::product(one(i), one(j)).times(sign));
    terms.extend(crossed);
    terms
}
