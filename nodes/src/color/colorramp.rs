//! A function of one number by stops.

use crate::color::stops::{FEW, Segments};
use crate::componentwise::transfer;
use crate::port;
use crate::port::number;
use mipless_codegen::ir::Builder;
use mipless_codegen::moments::{Piecewise, Shape, Signal};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "colorramp",
    aliases: &[
        "colorize",
        "gradient",
        "gradient_map",
        "color_ramp",
        "curve",
        "float_curve",
        "tonality",
        "tones_map",
    ],
    category: Category::Color,
    summary: "A colour or number for each value of a signal, by stops.",
    doc: Doc {
        computes: "out = the value of the stops at `in`: that of the last stop at or before it \
            (`constant`), a + t (b − a) between neighbours (`linear`), the same with 3t² − 2t³ for \
            t (`smooth`), or a monotone cubic whose slope is continuous everywhere and 0 at the \
            first and last stop (`cubic`: Steffen’s; no value leaves those of its two stops); the \
            first and last values outside. Two stops at one place make \
            a jump. Values are linear Rec. 709 numbers or `#rrggbb`.",
        statistics: "Each channel is a piecewise function in closed form: with z_k = (m − t_k)/σ at the \
            stops t_k, E = c₀ + Σ J_k Φ(z_k) + B_k σ(z_kΦ(z_k) + φ(z_k)) for jumps J_k and \
            changes of slope B_k; `smooth` and `cubic` add the truncated moments of cubics. Exact for a \
            Gaussian. The channels share their second Hermite part, so that their sums keep the \
            right variance to second order.",
        accuracy: "For a Gaussian input the mean is within 1e-5 (`smooth`, `cubic`: 3e-4) of the range of the \
            values. For a noise, the error is the distance of its distribution from a Gaussian \
            times the largest jump. Held by `codegen/src/moments/tests.rs` against dense \
            numerical integration in f64.",
        references: cite!(
            "Heitz, Nowrouzezahrai, Poulin & Neyret 2013, *Filtering Color Mapped Textures and \
             Surfaces*, §4 (the expectation of a colour map).",
            bussgang,
            "Steffen 1990, *A simple method for monotonic interpolation in one dimension*, eqs. \
             8 and 11."
        ),
    },
    inputs: &[
        number("in", 0.0, "The signal.").range(Range::soft(-1.0, 1.0)),
        PortSpec::new(
            "stops",
            PortType::Stops,
            Default::Stops(&[(0.0, 0.0), (1.0, 1.0)]),
            "Places and values; the type is float if every value is a number, else color3 or color4.",
        ),
        port::choice(
            "interpolation",
            &["constant", "linear", "smooth", "cubic"],
            "linear",
            "How the value goes from stop to stop.",
        ),
    ],
    output: OutputType::Stops,
    reach: |inputs| inputs.reach("stops"),
    class: |_| Behaviour::Function,
    example: example! { "colorramp", r##"
    "uv": { "type": "texcoord" },
    "u": { "type": "extract", "inputs": { "in": { "node": "uv" }, "index": 0 } },
    "turns": { "type": "multiply", "inputs": { "in1": { "node": "u" }, "in2": 25 } },
    "wave": { "type": "sin", "inputs": { "in": { "node": "turns" } } },
    "colorramp": { "type": "colorramp", "inputs": {
        "in": { "node": "wave" },
        "stops": [
          { "at": -1, "value": "#1d2b3a" }, { "at": 0.2, "value": "#c9b28a" }, { "at": 1, "value": "#f4efe4" }
        ] } }
"## },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let mut x = lower.signal(node, "in");
    let shape = match lower.choice(node, "interpolation") {
        "constant" => Shape::Constant,
        "smooth" => Shape::Smooth,
        "cubic" => Shape::Cubic,
        _ => Shape::Linear,
    };
    let stops = lower.stops(node, "stops");
    let channels = stops.ty.components();
    if channels > 1 && x.hermite.is_none() && lower.mode().spreads() {
        // The channels bend with one another: what each bends is not independent.
        x.hermite = Some(lower.algebra.fresh_symbol());
    }
    let span = stops.stops[stops.stops.len() - 1].at - stops.stops[0].at;
    if stops.stops.len() > FEW && span > 1e-3 {
        return long(lower, node, &x, shape);
    }
    let b = lower.b();
    let channel = |i: usize| {
        let stops: Vec<_> = (stops.stops.iter())
            .map(|stop| (b.float(stop.at), b.float(stop.value[i])))
            .collect();
        transfer(lower, &x, &Piecewise::ramp(&stops, shape))
    };
    (0..channels).map(channel).collect()
}

/// A ramp of many stops, by tables.
fn long<'b>(lower: &mut Lower<'_, 'b>, node: &Node, x: &Signal<'b>, shape: Shape) -> Bundle<'b> {
    let stops = lower.stops(node, "stops");
    let key = format!("ramp {}", node.name);
    let segments = lower.once(&key, || Segments::of(stops, shape));
    let table = lower.table(&format!("{key} stops"), "stops", || {
        segments.rows().to_vec().into()
    });
    let of = lower.function(&format!("{key} of"), |module| {
        let b = &Builder::new("ramp_of", "A ramp of many stops.");
        let x = b.float_param("x");
        let channels = segments.at(b, table, x);
        b.results((0..channels.len()).map(|i| format!("value_{i}")), channels);
        b.finish(module)
    });
    let ends = [0, stops.stops.len() - 1].map(|i| stops.stops[i].at);
    let ranges: Vec<[f32; 2]> = (0..stops.ty.components())
        .map(|i| {
            let values = stops.stops.iter().map(|stop| stop.value[i]);
            values.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], x| {
                [low.min(x), high.max(x)]
            })
        })
        .collect();
    let values = move |x| segments.value(x);
    let tables = lower.tabulate_all(&key, "ramp", (ends, &ranges), &of, values);
    tables.iter().map(|t| transfer(lower, x, t)).collect()
}
