//! Affine map from a range to a range.

use mipless_codegen::moments::{Piecewise, Reciprocal, Transfer};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Type,
};

use crate::componentwise::{numbers, product, transfer};

static SPEC: NodeSpec = NodeSpec {
    name: "range",
    aliases: &["remap", "map_range", "maprange", "fit", "histogram_range"],
    category: Category::Transfer,
    summary: "Maps one range of numbers to another.",
    doc: Doc {
        computes: "out = outlow + t (outhigh − outlow) with t = (in − inlow)/(inhigh − inlow), limited \
            to [0, 1] if `doclamp` is set, for each component. A range narrower than 1e-6 counts \
            as 1e-6 wide.",
        statistics: "Without `doclamp`, linear and exact; varying outlow or outhigh multiply t as \
            `multiply` does. With it, the transfer min(max(t, 0), 1) in closed form, exact for a \
            Gaussian input. Of inlow and inhigh the means are used: their own spread is ignored, \
            and the class says so.",
        accuracy: "Without `doclamp`, exact to rounding. With it, the mean is within 1e-5 of the output \
            range for a Gaussian input. Held by `codegen/src/moments/tests.rs` against dense \
            numerical integration in f64.",
        references: "Bruneton & Neyret 2012, *A Survey of Non-linear Pre-filtering Methods for Efficient \
            and Accurate Surface Shading*, §2.2 (linear maps of a mean and a covariance). \
            Bussgang 1952, *Crosscorrelation functions of amplitude-distorted Gaussian signals*; \
            Stein 1981, *Estimation of the mean of a multivariate normal distribution*, lemma 1. \
            MaterialX 1.39 specification, node `range`.",
    },
    inputs: &[
        PortSpec::new("in", PortType::Any, Default::Float(0.0), "The signal."),
        PortSpec::new(
            "inlow",
            PortType::Any,
            Default::Float(0.0),
            "What maps to outlow.",
        ),
        PortSpec::new(
            "inhigh",
            PortType::Any,
            Default::Float(1.0),
            "What maps to outhigh.",
        ),
        PortSpec::new(
            "outlow",
            PortType::Any,
            Default::Float(0.0),
            "The result at inlow.",
        ),
        PortSpec::new(
            "outhigh",
            PortType::Any,
            Default::Float(1.0),
            "The result at inhigh.",
        ),
        PortSpec::new(
            "doclamp",
            PortType::Exactly(Type::Boolean),
            Default::Boolean(false),
            "Whether the result is limited to lie between outlow and outhigh.",
        )
        .uniform(),
    ],
    output: OutputType::Widest,
    class,
    example: r#"{
  "version": 1,
  "name": "range_example",
  "nodes": {
    "uv": { "type": "texcoord" },
    "u": { "type": "extract", "inputs": { "in": { "node": "uv" }, "index": 0 } },
    "turns": { "type": "multiply", "inputs": { "in1": { "node": "u" }, "in2": 25 } },
    "wave": { "type": "sin", "inputs": { "in": { "node": "turns" } } },
    "range": { "type": "range", "inputs": { "in": { "node": "wave" }, "inlow": -0.5, "inhigh": 0.5, "doclamp": true } }
  },
  "outputs": { "out": { "node": "range" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

/// Limiting bends; varying bounds of the output multiply, and of the input count by their means.
fn class(inputs: &dyn InputView) -> Behaviour {
    let varies = |ports: &[&str]| ports.iter().any(|port| inputs.varies(port));
    if inputs.flag("doclamp") || varies(&["inlow", "inhigh"]) {
        Behaviour::Function
    } else if inputs.varies("in") && varies(&["outlow", "outhigh"]) {
        Behaviour::Product
    } else {
        Behaviour::Linear
    }
}

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let limited = lower.flag(node, "doclamp");
    let (input, low, high) = (
        lower.bundle(node, "in"),
        numbers(lower, node, "inlow"),
        numbers(lower, node, "inhigh"),
    );
    let (outlow, outhigh) = (lower.bundle(node, "outlow"), lower.bundle(node, "outhigh"));
    let component = |lower: &mut Lower<'_>, i: usize| {
        let b = lower.b();
        let width = b.sub(high[i], low[i]);
        let gain = Reciprocal.value(b, width);
        let minus = b.neg(low[i]);
        // The share of the range that is passed, 0 at inlow and 1 at inhigh.
        let mut share = input[i].offset(b, minus).scale(b, gain);
        if limited {
            let (zero, one) = (b.f32(0.0), b.f32(1.0));
            let clamp = Piecewise::clamp(b, zero, one);
            share = transfer(lower, &share, &clamp);
        }
        let span = outhigh[i].sub(lower.b(), &outlow[i]);
        let rise = product(lower, &span, &share);
        outlow[i].add(lower.b(), &rise)
    };
    (0..input.len()).map(|i| component(lower, i)).collect()
}
