//! Rotation of a vector in the plane.

use crate::componentwise::{product, transfer};
use crate::port;
use crate::port::number;
use mipless_codegen::ir::{Float, Scalar, SharedFunction, Vec2};
use mipless_codegen::moments::{Signal, Sine};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Doc, InputView, Node, NodeSpec, OutputType, Range, Reach, Type,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "rotate2d",
    aliases: &["rotate", "vector_rotate", "rotate_uv"],
    category: Category::Coordinate,
    summary: "Turns a vector.",
    doc: Doc {
        computes: "out = (c x + s y, c y − s x) with c and s the cosine and sine of the amount: \
            clockwise, so that a texture that is read at turned coordinates appears turned \
            counter-clockwise, as in MaterialX.",
        statistics: "By a constant angle, linear and exact: a position stays exactly Gaussian, with its \
            footprint turned. A varying angle goes through the closed forms of sine and cosine \
            and a product, as `sin` and `multiply` do.",
        accuracy: "Exact to rounding; multiples of 90 degrees are exact to the bit. Held by \
            `nodes/src/tests.rs`.",
        references: cite!(linear; "rotate2d"),
    },
    inputs: &[
        port::pair("in", [0.0, 0.0], "The vector.").unit("uv"),
        number("amount", 0.0, "The angle, clockwise.")
            .range(Range::soft(-180.0, 180.0))
            .unit("degrees"),
    ],
    output: OutputType::Exactly(Type::Vector2),
    reach: |_| Reach::ANY,
    class,
    example: example! { "rotate2d", r#"
    "uv": { "type": "texcoord" },
    "rotate2d": { "type": "rotate2d", "inputs": { "in": { "node": "uv" }, "amount": 30 } }
"# },
};

/// Linear unless the angle varies.
fn class(inputs: &dyn InputView) -> Behaviour {
    match (inputs.varies("in"), inputs.varies("amount")) {
        (_, false) => Behaviour::Linear,
        (false, true) => Behaviour::Function,
        (true, true) => Behaviour::Product,
    }
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let vector = lower.bundle(node, "in");
    let angle = lower.signal(node, "amount");
    rotated(lower, [&vector[0], &vector[1]], &-angle).to_vec()
}

/// A vector turned counter-clockwise by an angle in degrees.
pub(crate) fn rotated<'b>(
    lower: &mut Lower<'_, 'b>,
    [x, y]: [&Signal<'b>; 2],
    degrees: &Signal<'b>,
) -> [Signal<'b>; 2] {
    if degrees.is_certain() && degrees.mean.is_zero() && degrees.cell.is_none() {
        return [x.clone(), y.clone()];
    }
    let [cosine, sine] = turn(lower, degrees);
    if let (Some(x), Some(y)) = (place(x), place(y))
        && cosine.is_certain()
        && sine.is_certain()
    {
        return turned([x, y], [cosine.mean, sine.mean]);
    }
    let (cx, sy) = (product(lower, x, &cosine), product(lower, y, &sine));
    let (sx, cy) = (product(lower, x, &sine), product(lower, y, &cosine));
    [cx - sy, sx + cy]
}

/// What a coordinate carries that has nothing but a cell, a fraction and its response to the
/// footprint.
fn place<'b>(x: &Signal<'b>) -> Option<[Scalar<'b>; 4]> {
    let plain = x.shared.is_empty() && x.private.is_zero() && x.h.iter().all(|h| h.is_zero());
    let cell = x.cell.filter(|_| plain)?;
    Some([cell.into(), x.mean.into(), x.g[0].into(), x.g[1].into()])
}

/// The coordinate of these.
fn coordinate<'b>(place: &[Scalar<'b>]) -> Signal<'b> {
    Signal {
        cell: Some(place[0].int()),
        g: Vec2([place[2].float(), place[3].float()]),
        ..Signal::certain(place[1].float())
    }
    .with_range([f32::NEG_INFINITY, f32::INFINITY])
}

/// Two such coordinates turned by an angle of this cosine and sine.
fn turned<'b>(places: [[Scalar<'b>; 4]; 2], circle: [Float<'b>; 2]) -> [Signal<'b>; 2] {
    let of = SharedFunction {
        name: "turn",
        variant: 0,
        doc: "A position turned about the origin.",
    };
    let names = PLACES.into_iter().chain(["cosine", "sine"]);
    let values = (places.into_iter().flatten()).chain(circle.map(Scalar::from));
    let inputs: Vec<_> = names.zip(values).collect();
    let results = circle[0].builder().shared_scalars(of, &inputs, |_, v| {
        let (x, y) = (coordinate(&v[..4]), coordinate(&v[4..8]));
        let [cosine, sine] = [v[8], v[9]].map(Scalar::float);
        let turned = [&x * cosine - &y * sine, &x * sine + &y * cosine];
        let [x, y] = turned.map(|x| place(&x).expect("sums of positions keep their cells"));
        let mut values = x.into_iter().chain(y);
        PLACES.map(|name| (name, values.next().expect("one for each name")))
    });
    [&results[..4], &results[4..]].map(coordinate)
}

/// The names of what two coordinates carry.
const PLACES: [&str; 8] = ["cell_x", "x", "x_gx", "x_gy", "cell_y", "y", "y_gx", "y_gy"];

/// The cosine and sine of an angle in degrees.
pub(crate) fn turn<'b>(lower: &mut Lower<'_, 'b>, degrees: &Signal<'b>) -> [Signal<'b>; 2] {
    let number = degrees.mean.as_constant().filter(|_| degrees.is_certain());
    let quarters = number.map(|angle| (angle / 90.0).rem_euclid(4.0));
    if let Some(quarters) = quarters.filter(|quarters| quarters.fract() == 0.0) {
        // Quarter turns are exact: their cosine in f32 would be 4e-8, and move far cells.
        let circle = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
        return circle[quarters as usize % 4].map(|x| Signal::constant(lower.b(), x));
    }
    let radians = degrees * (std::f32::consts::PI / 180.0);
    [std::f32::consts::FRAC_PI_2, 0.0].map(|phase| transfer(lower, &radians, &Sine { phase }))
}
