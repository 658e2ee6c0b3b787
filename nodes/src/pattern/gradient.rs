//! `ramp`: a gradient of up to ten colours over position, in one of four shapes.

use crate::componentwise::{difference, product, transfer};
use crate::pattern::angle::polar;
use crate::pattern::grid::TEXCOORD;
use crate::pattern::unless::pattern_unless;
use crate::port;
use mipless_codegen::ir::Float;
use mipless_codegen::moments::{Piecewise, Shape, Signal};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Reach, Type,
};

/// How the colour goes from one place to the next, counted as MaterialX does.
const INTERPOLATION: PortSpec = port::choice(
    "interpolation",
    &["linear", "smooth", "step"],
    "smooth",
    "How the colour goes from place to place.",
);

const fn color(name: &'static str, white: bool, doc: &'static str) -> PortSpec {
    let shade = if white { 1.0 } else { 0.0 };
    let ty = PortType::Exactly(Type::Color4);
    PortSpec::new(name, ty, Default::Color3([shade; 3]), doc)
}

const fn place(name: &'static str, default: f32, doc: &'static str) -> PortSpec {
    port::number(name, default, doc)
}

const fn count(name: &'static str, default: i32, doc: &'static str) -> PortSpec {
    port::integer(name, default, doc).uniform()
}

const COLORS: [&str; 10] = [
    "color1", "color2", "color3", "color4", "color5", "color6", "color7", "color8", "color9",
    "color10",
];

const PLACES: [&str; 10] = [
    "interval1",
    "interval2",
    "interval3",
    "interval4",
    "interval5",
    "interval6",
    "interval7",
    "interval8",
    "interval9",
    "interval10",
];

/// The places and colours one after another, as MaterialX has them.
const STOPS: [PortSpec; 20] = {
    let mut ports = [color("color1", false, "The colour at the first place."); 20];
    let mut i = 0;
    while i < 10 {
        let at = if i == 0 { 0.0 } else { 1.0 };
        ports[2 * i] = place(PLACES[i], at, "A place; places rise.");
        ports[2 * i + 1] = color(COLORS[i], i > 0, "The colour at that place.");
        i += 1;
    }
    ports
};

/// All ports of `ramp`.
const PORTS: [PortSpec; 24] = {
    let mut ports = [TEXCOORD; 24];
    ports[1] = port::choice(
        "type",
        &["standard", "radial", "circular", "box"],
        "standard",
        "Along u, around the middle, by the distance from it, or by squares.",
    );
    ports[2] = INTERPOLATION;
    ports[3] = count("num_intervals", 2, "How many of the places count.")
        .range(mipless_graph::Range::hard(2.0, 10.0));
    let mut i = 0;
    while i < 20 {
        ports[4 + i] = STOPS[i];
        i += 1;
    }
    ports
};

static RAMP: NodeSpec = NodeSpec {
    name: "ramp",
    aliases: &["gradient_ramp", "position_gradient"],
    category: Category::Pattern,
    summary: "A gradient of up to ten colours over position: straight, radial, circular or square.",
    doc: Doc {
        computes: "With d = texcoord − ½, the place x is u (`standard`), atan2(d_u, d_v)/2π + ½ \
            (`radial`), 1.414 |d| (`circular`) or 2 max(|d_u|, |d_v|) (`box`). out = color1 up to \
            interval1, then from each color to the next between their places, `linear`, `smooth` \
            (3t² − 2t³) or in a `step` at the next place. Places rise; the first num_intervals \
            count. A gradient over a signal instead of a position is `colorramp`.",
        statistics: "The place as `texcoord`, `polar` or `max` has it, then a piecewise function in \
            closed form, as `colorramp`: exact for a Gaussian. Between varying colours a product, \
            as `mix`. Of varying places the means are used.",
        accuracy: "`standard` as `colorramp`; `circular` and `radial` as `polar`, whose distance is \
            taken for Gaussian: of a footprint that is much wider than the circles they keep 0.03 \
            of the range, where nothing should be left. At a point held by `tests/tests/parity.rs`.",
        references: cite!(color_mapped, bussgang; "ramp"),
    },
    inputs: &PORTS,
    output: OutputType::Exactly(Type::Color4),
    reach: |inputs| {
        let colors = COLORS.map(|port| inputs.reach(port));
        colors.into_iter().fold(colors[0], Reach::hull)
    },
    class: |inputs| match inputs.choice("type") {
        "standard" => pattern_unless(inputs, &COLORS),
        _ => Behaviour::Rough {
            error: 0.05,
            place: "has a mean that is off by up to 0.03 of its range far away, where a distance or an \
                angle is not Gaussian",
        },
    },
    example: example! { "ramp", r##"
"ramp": { "type": "ramp", "inputs": {
    "num_intervals": 3, "color1": "#20303c", "interval2": 0.4, "color2": "#e8c27a", "color3": "#7a4a2b" } }
"## },
};

static STAGE: NodeSpec = NodeSpec {
    name: "ramp_gradient",
    aliases: &["gradient_stage"],
    category: Category::Pattern,
    summary: "One stage of a gradient: beyond a place, from one colour to another.",
    doc: Doc {
        computes: "prev_color where x ≤ interval1, or everywhere where interval_num ≥ num_intervals; \
            else from color1 at interval1 to color2 at interval2, `linear`, `smooth` (3t² − 2t³) or \
            in a `step` at interval2. `ramp` is up to nine of these.",
        statistics: "A piecewise function in closed form between the colours, a product where they \
            vary, and the choice of an interval as `ifgreater`. Of varying places the means are used.",
        accuracy: "As `ifgreater` and `mix`. At a point held by `tests/tests/parity.rs`.",
        references: cite!(color_mapped, truncated; "ramp_gradient"),
    },
    inputs: &[
        place("x", 0.0, "The place."),
        place("interval1", 0.0, "Where the stage begins."),
        place("interval2", 1.0, "Where it ends."),
        color("color1", false, "The colour at its beginning."),
        color("color2", true, "The colour at its end."),
        INTERPOLATION,
        color("prev_color", false, "The colour before it."),
        count("interval_num", 1, "Which stage it is."),
        count("num_intervals", 2, "How many places there are."),
    ],
    output: OutputType::Exactly(Type::Color4),
    reach: |inputs| {
        let colors = ["color1", "color2", "prev_color"].map(|port| inputs.reach(port));
        colors.into_iter().fold(colors[0], Reach::hull)
    },
    class: |inputs: &dyn InputView| match inputs.varies("x") {
        true => Behaviour::Function,
        false => Behaviour::Linear,
    },
    example: example! { "ramp_gradient", r##"
"noise": { "type": "noise2d", "inputs": { "frequency": 5, "pivot": 0.5 } },
"ramp_gradient": { "type": "ramp_gradient", "inputs": {
    "x": { "node": "noise" }, "interval1": 0.4, "interval2": 0.7, "color1": "#7a4a2b", "color2": "#e8c27a", "prev_color": "#20303c" } }
"## },
};

/// One row a node: what it is and how it is made.
macro_rules! gradients {
    ($($node:ident: $spec:ident, $lower:ident,)*) => {$(
        pub(crate) const fn $node() -> NodeDef {
            NodeDef::new(&$spec, $lower)
        }
    )*};
}

gradients! {
    ramp: RAMP, lower,
    ramp_gradient: STAGE, stage,
}

/// The place of a gradient's shape.
fn along<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Signal<'b> {
    let texcoord = lower.bundle(node, "texcoord");
    let half = Signal::constant(lower.b(), 0.5);
    let [x, y] = [0, 1].map(|i| difference(&texcoord[i], &half));
    match lower.choice(node, "type") {
        // Half a turn from the angle of (v, u).
        "radial" => polar(lower, [&-y, &-x])[0].clone(),
        // MaterialX's √2.
        "circular" => polar(lower, [&x, &y])[1].clone() * 1.414,
        "box" => {
            let absolute = Piecewise::absolute(lower.b());
            let [x, y] = [x, y].map(|x| transfer(lower, &x, &absolute));
            lower.algebra.maximum(&x, &y) * 2.0
        }
        _ => texcoord[0].clone(),
    }
}

fn shape(lower: &Lower<'_, '_>, node: &Node) -> Shape {
    match lower.choice(node, "interpolation") {
        "linear" => Shape::Linear,
        "step" => Shape::Constant,
        _ => Shape::Smooth,
    }
}

fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let mut x = along(lower, node);
    let shape = shape(lower, node);
    let count = lower.integer(node, "num_intervals").clamp(2, 10) as usize;
    let mut places: Vec<_> = (PLACES[..count].iter())
        .map(|port| lower.number(node, port))
        .collect();
    // Of intervals out of order the last one that begins before a place counts there.
    for i in (1..count).rev() {
        places[i - 1] = places[i - 1].min(places[i]);
    }
    let colors: Vec<Bundle<'b>> = (COLORS[..count].iter())
        .map(|port| lower.bundle(node, port))
        .collect();
    if x.hermite.is_none() && lower.mode().spreads() {
        // The channels bend with one another: what each bends is not independent.
        x.hermite = Some(lower.algebra.fresh_symbol());
    }
    let certain = colors.iter().flatten().all(Signal::is_certain);
    let steps: Vec<Signal<'b>> = if certain {
        Vec::new()
    } else {
        let ends = [0.0, 1.0].map(|end| lower.b().float(end));
        (places.windows(2))
            .map(|places| {
                let step = [(places[0], ends[0]), (places[1], ends[1])];
                transfer(lower, &x, &Piecewise::ramp(&step, shape))
            })
            .collect()
    };
    (0..4)
        .map(|i| {
            if certain {
                let stops: Vec<_> = (places.iter().zip(&colors))
                    .map(|(&place, color)| (place, color[i].flat_mean()))
                    .collect();
                let ends = stops.iter().map(|(_, value)| *value);
                let low = ends.clone().reduce(Float::min).expect("two stops");
                let high = ends.reduce(Float::max).expect("two stops");
                let value = transfer(lower, &x, &Piecewise::ramp(&stops, shape));
                // Places that all but coincide cost digits.
                return Signal {
                    mean: value.mean.clamp(low, high),
                    ..value
                };
            }
            let pairs = colors.windows(2).zip(&steps);
            pairs.fold(colors[0][i].clone(), |sum, (colors, step)| {
                sum + product(lower, &(&colors[1][i] - &colors[0][i]), step)
            })
        })
        .collect()
}

fn stage<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let previous = lower.bundle(node, "prev_color");
    if lower.integer(node, "interval_num") >= lower.integer(node, "num_intervals") {
        return previous;
    }
    let x = lower.signal(node, "x");
    let [from, to] = ["interval1", "interval2"].map(|port| lower.number(node, port));
    // Beyond a stage that ends before it begins there is its end.
    let to = to.max(from);
    let colors = ["color1", "color2"].map(|port| lower.bundle(node, port));
    let ends = [0.0, 1.0].map(|end| lower.b().float(end));
    let step = Piecewise::ramp(&[(from, ends[0]), (to, ends[1])], shape(lower, node));
    let certain = colors
        .iter()
        .flatten()
        .chain(&previous)
        .all(Signal::is_certain);
    if certain {
        // One function of x, with a jump.
        return (0..4)
            .map(|i| {
                let [before, first, last] =
                    [&previous, &colors[0], &colors[1]].map(|c| c[i].flat_mean());
                let stops = [(from, before), (from, first), (to, last)];
                transfer(lower, &x, &Piecewise::ramp(&stops, shape(lower, node)))
            })
            .collect();
    }
    let share = transfer(lower, &x, &step);
    let beyond = x.offset(-from);
    (0..4)
        .map(|i| {
            let inside = lower.algebra.mix(&colors[0][i], &colors[1][i], &share);
            let branches = [previous[i].clone(), inside];
            lower.algebra.selection(&beyond, &[0.0], &branches)
        })
        .collect()
}
