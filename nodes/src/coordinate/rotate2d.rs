//! Rotation of a vector in the plane.

use mipless_codegen::ir::{Builder, SharedFunction, Value};
use mipless_codegen::moments::{Signal, Sine};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Range, Type,
};

use crate::componentwise::{product, transfer};

static SPEC: NodeSpec = NodeSpec {
    name: "rotate2d",
    aliases: &["rotate", "vector_rotate", "rotate_uv"],
    category: Category::Coordinate,
    summary: "Turns a vector.",
    doc: Doc {
        computes: "out = (c x − s y, s x + c y) with c and s the cosine and sine of the amount. A \
            texture that is read at turned coordinates appears turned the other way. MaterialX's \
            node of this name has the opposite direction, (c x + s y, c y − s x): its amount is the \
            negative of this one.",
        statistics: "By a constant angle, linear and exact: a position stays exactly Gaussian, with its \
            footprint turned. A varying angle goes through the closed forms of sine and cosine \
            and a product, as `sin` and `multiply` do.",
        accuracy: "Exact to rounding; multiples of 90 degrees are exact to the bit. Held by \
            `nodes/src/tests.rs`.",
        references: "Bruneton & Neyret 2012, *A Survey of Non-linear Pre-filtering Methods for Efficient \
            and Accurate Surface Shading*, §2.2 (linear maps of a mean and a covariance). The \
            direction is counter-clockwise, as every angle of a document; names and defaults are \
            those of the node `rotate2d` of the MaterialX 1.39 specification.",
    },
    inputs: &[
        PortSpec::new(
            "in",
            PortType::Exactly(Type::Vector2),
            Default::Vector2([0.0, 0.0]),
            "The vector.",
        )
        .unit("uv"),
        PortSpec::new(
            "amount",
            PortType::Exactly(Type::Float),
            Default::Float(0.0),
            "The angle, counter-clockwise.",
        )
        .range(Range::soft(-180.0, 180.0))
        .unit("degrees"),
    ],
    output: OutputType::Exactly(Type::Vector2),
    class,
    example: r#"{
  "version": 1,
  "name": "rotate2d_example",
  "nodes": {
    "uv": { "type": "texcoord" },
    "rotate2d": { "type": "rotate2d", "inputs": { "in": { "node": "uv" }, "amount": 30 } }
  },
  "outputs": { "out": { "node": "rotate2d" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

/// Linear unless the angle varies.
fn class(inputs: &dyn InputView) -> Behaviour {
    match (inputs.varies("in"), inputs.varies("amount")) {
        (_, false) => Behaviour::Linear,
        (false, true) => Behaviour::Function,
        (true, true) => Behaviour::Product,
    }
}

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let vector = lower.bundle(node, "in");
    let angle = lower.signal(node, "amount");
    rotated(lower, [&vector[0], &vector[1]], &angle).to_vec()
}

/// A vector turned counter-clockwise by an angle in degrees.
pub(crate) fn rotated(
    lower: &mut Lower<'_>,
    [x, y]: [&Signal; 2],
    degrees: &Signal,
) -> [Signal; 2] {
    let b = lower.b();
    if degrees.is_certain(b) && b.is_zero(degrees.mean) && degrees.cell.is_none() {
        return [x.clone(), y.clone()];
    }
    let [cosine, sine] = turn(lower, degrees);
    let b = lower.b();
    if let (Some(x), Some(y)) = (place(b, x), place(b, y))
        && cosine.is_certain(b)
        && sine.is_certain(b)
    {
        return turned(b, [x, y], [cosine.mean, sine.mean]);
    }
    let (cx, sy) = (product(lower, x, &cosine), product(lower, y, &sine));
    let (sx, cy) = (product(lower, x, &sine), product(lower, y, &cosine));
    let b = lower.b();
    [cx.sub(b, &sy), sx.add(b, &cy)]
}

/// A coordinate that carries nothing but a cell, a fraction and its response to the footprint.
fn place(b: &Builder, x: &Signal) -> Option<[Value; 4]> {
    let plain = x.shared.is_empty() && b.is_zero(x.private) && x.h.iter().all(|&h| b.is_zero(h));
    plain.then_some([x.cell?, x.mean, x.g[0], x.g[1]])
}

/// Two such coordinates turned by an angle of this cosine and sine.
fn turned(b: &mut Builder, [x, y]: [[Value; 4]; 2], [cosine, sine]: [Value; 2]) -> [Signal; 2] {
    let of = SharedFunction {
        name: "turn",
        variant: 0,
        doc: "A position turned about the origin.",
    };
    let mut inputs = Vec::new();
    for (names, place) in [(X, x), (Y, y)] {
        inputs.extend(names.into_iter().zip(place));
    }
    inputs.extend([("cosine", cosine), ("sine", sine)]);
    let signal = |b: &mut Builder, v: &[Value]| {
        Signal {
            cell: Some(v[0]),
            g: [v[2], v[3]],
            ..Signal::certain(b, v[1])
        }
        .with_range(UNBOUNDED)
    };
    let results = b.shared(of, &inputs, |b, v| {
        let (x, y) = (signal(b, &v[..4]), signal(b, &v[4..8]));
        let (cx, sx) = (x.scale(b, v[8]), x.scale(b, v[9]));
        let (cy, sy) = (y.scale(b, v[8]), y.scale(b, v[9]));
        let (x, y) = (cx.sub(b, &sy), sx.add(b, &cy));
        let cell = |signal: &Signal| signal.cell.expect("sums of positions keep their cells");
        [
            (X[0], cell(&x)),
            (X[1], x.mean),
            (X[2], x.g[0]),
            (X[3], x.g[1]),
            (Y[0], cell(&y)),
            (Y[1], y.mean),
            (Y[2], y.g[0]),
            (Y[3], y.g[1]),
        ]
    });
    [&results[..4], &results[4..]].map(|v| signal(b, v))
}

const X: [&str; 4] = ["cell_x", "x", "x_gx", "x_gy"];
const Y: [&str; 4] = ["cell_y", "y", "y_gx", "y_gy"];
const UNBOUNDED: [f32; 2] = [f32::NEG_INFINITY, f32::INFINITY];

/// The cosine and sine of an angle in degrees.
pub(crate) fn turn(lower: &mut Lower<'_>, degrees: &Signal) -> [Signal; 2] {
    let b = lower.b();
    if let Some(angle) = b
        .as_constant(degrees.mean)
        .filter(|_| degrees.is_certain(b))
    {
        let quarters = (angle / 90.0).rem_euclid(4.0);
        if quarters.fract() == 0.0 {
            // Quarter turns are exact: their cosine in f32 would be 4e-8, and move far cells.
            let [cosine, sine] =
                [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]][quarters as usize % 4];
            return [Signal::constant(b, cosine), Signal::constant(b, sine)];
        }
    }
    let factor = b.f32(std::f32::consts::PI / 180.0);
    let radians = degrees.scale(b, factor);
    let cosine = transfer(
        lower,
        &radians,
        &Sine {
            phase: std::f32::consts::FRAC_PI_2,
        },
    );
    [cosine, transfer(lower, &radians, &Sine { phase: 0.0 })]
}
