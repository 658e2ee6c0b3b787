//! A colour for each pair of values of two signals.

mod shape;

use crate::picture::port::{COLORSPACE, FILE, planes};
use crate::picture::texels::Texels;
use crate::port;
use crate::port::number;
use mipless_codegen::ir::{Builder, Float, Module};
use mipless_codegen::moments::{Domain, Signal};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range, Reach,
};
use shape::Shape;
use std::sync::Arc;

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "colormap2d",
    aliases: &["color_map_2d", "bivariate_ramp", "ramp2d", "lut2d"],
    category: Category::Color,
    summary: "A colour or number for each pair of values of two signals.",
    doc: Doc {
        computes: "With p = (in1 − low₁, in2 − low₂) / (high − low), limited to [0, 1]² or wrapped \
            around (`addressmode`): with a `file`, its picture at p by bilinear interpolation, the \
            first row at p₂ = 0. Without one, a place t of the stops: `bands`, t = fract(count · (p₁ \
            cos a + p₂ sin a)) for the angle a = `rotate`; `rings`, t = fract(2 count |p − center|); \
            `regions`, t = (i + ½)/count in the Voronoi cell of site i of `count` random ones; out = \
            the value of the stops at t, as in `colorramp`. Alpha is a channel like the others.",
        statistics: "The function is sampled when it is compiled; a pyramid of its means under isotropic \
            Gaussians is read by five taps along the major axis of the covariance of the two \
            signals. So the covariance counts in full, whether the signals are correlated as \
            processes or only within this footprint. Slopes and what is left of the variance come \
            from tables of their own where something reads them; the third cumulant is not used, \
            and what channels share beyond their slopes is not carried.",
        accuracy: "For Gaussian inputs with standard deviations up to an eighth of the domain, ratios of up \
            to 16 and any correlation: mean error of at most 0.003 of the range of values for maps \
            with jumps and 0.001 for smooth ones, by tables of less than 1 MB (and the texels of a \
            picture, 4 bytes a channel). A picture with more than 2048 texels over the \
            map's domain is averaged to that. The manifest states the largest error of \
            each table. Held by `codegen/src/moments/map/tests.rs` against dense numerical \
            integration in f64, for pictures by `nodes/tests/colormap.rs`.",
        references: cite!(
            "Grenier, Sauvage, Dischler & Thery 2022, *Color-mapped noise vector fields for \
             generating procedural micro-patterns*, §5 (two independent noises, axis-aligned \
             Gaussians).",
            color_mapped
        ),
    },
    inputs: &[
        number("in1", 0.0, "The signal along the map's first axis.").range(Range::soft(0.0, 1.0)),
        number("in2", 0.0, "The signal along the map's second axis.").range(Range::soft(0.0, 1.0)),
        FILE,
        port::choice("signature", &["color3", "color4", "float"], "color3", "The type of the result with a file."),
        COLORSPACE,
        port::choice("shape", &["bands", "rings", "regions"], "regions", "What the map looks like without a file."),
        PortSpec::new(
            "stops",
            PortType::Stops,
            Default::Stops(&[(0.0, 0.0), (1.0, 1.0)]),
            "Places of [0, 1] and values; the type is float if every value is a number, else color3 or \
             color4.",
        ),
        port::choice("interpolation", &["constant", "linear", "smooth"], "linear", "How the value goes from stop to stop."),
        port::integer("count", 8, "How often bands or rings repeat the stops across the map, or how many regions there are.")
        .uniform()
        .range(Range::hard(1.0, 256.0).with_soft(1.0, 32.0)),
        port::pair("low", [0.0, 0.0], "The signals' values at the map's first corner.")
        .uniform()
        .range(Range::soft(-1.0, 1.0)),
        port::pair("high", [1.0, 1.0], "The signals' values at the opposite corner, at least 1e-3 from `low`.")
        .uniform()
        .range(Range::soft(-1.0, 1.0)),
        number("rotate", 0.0, "The direction across the bands, counter-clockwise from the first axis.")
        .uniform()
        .range(Range::soft(0.0, 360.0))
        .unit("degrees"),
        port::pair("center", [0.5, 0.5], "The centre of the rings, in the map.")
        .uniform(),
        port::choice("addressmode", &["clamp", "periodic"], "clamp", "What lies beyond the map: its edge, or the map again."),
        port::integer("seed", 0, "Selects the sites of the regions.")
        .uniform()
        .range(Range::hard(i32::MIN as f32, i32::MAX as f32).with_soft(0.0, 100.0)),
    ],
    output: OutputType::Picture {
        file: "file",
        named: "signature",
    },
    reach: |_| Reach::ANY,
    class: |_| Behaviour::Function,
    example: example! { "colormap2d", r##"
    "folds": { "type": "spectralnoise2d", "inputs": { "frequency": 5, "pivot": 0.5 } },
    "grain": { "type": "noise2d", "inputs": { "frequency": 9, "pivot": 0.5, "seed": 3 } },
    "colormap2d": { "type": "colormap2d", "inputs": {
        "in1": { "node": "folds" }, "in2": { "node": "grain" },
        "shape": "regions", "count": 12, "interpolation": "linear",
        "stops": [
          { "at": 0, "value": "#7d6b57" }, { "at": 0.5, "value": "#a89078" }, { "at": 1, "value": "#c9bca6" }
        ] } }
"## },
};

/// The smallest width of a map.
const NARROWEST: f32 = 1e-3;

/// The most texels of a picture along a side of its domain: four of each sample of the map.
const DENSEST: usize = 4;

/// A map: what it shows, and where.
struct Map {
    picture: Picture,
    low: [f32; 2],
    width: [f32; 2],
    periodic: bool,
}

/// What a map shows in the unit square.
enum Picture {
    File(Arc<Texels>),
    Shape(Shape),
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let (x, y) = (lower.signal(node, "in1"), lower.signal(node, "in2"));
    let pair = |port: &str| {
        let numbers = node.literal(port).numbers();
        [numbers[0], numbers[1]]
    };
    let (low, high) = (pair("low"), pair("high"));
    let width = [0, 1].map(|i| {
        let width: f32 = high[i] - low[i];
        if width.abs() < NARROWEST {
            NARROWEST.copysign(width)
        } else {
            width
        }
    });
    let picture = match lower.picture(node, "file") {
        Some(file) => {
            let (planes, key) = planes(lower, node, &file, node.ty);
            let make = || Texels::of(&planes);
            Picture::File(lower.once(&format!("texels {key}"), make))
        }
        None => Picture::Shape(Shape::of(lower, node)),
    };
    let map = Map {
        picture,
        low,
        width,
        periodic: lower.choice(node, "addressmode") == "periodic",
    };
    let ranges = match &map.picture {
        Picture::File(texels) => texels.ranges().to_vec(),
        Picture::Shape(shape) => shape.ranges(),
    };
    let domain = map.domain([&x, &y]);
    lower.map(node, [&x, &y], domain, &ranges, move |b, module, place| {
        map.value(b, module, place)
    })
}

impl Map {
    /// Where the map is sampled: one period, or what the signals reach of the map and of half a map
    /// around it.
    fn domain(&self, signals: [&Signal<'_>; 2]) -> Domain {
        let bounds = [0, 1].map(|i| {
            let (low, width) = (self.low[i], self.width[i]);
            let [from, to] = if width < 0.0 {
                [low + width, low]
            } else {
                [low, low + width]
            };
            if self.periodic {
                return [from, to];
            }
            let margin = 0.5 * width.abs();
            let [least, most] = signals[i].range;
            let reached = [least.max(from - margin), most.min(to + margin)];
            // A signal that stays at one place has no domain of its own.
            if reached[1] - reached[0] < NARROWEST {
                [from - margin, to + margin]
            } else {
                reached
            }
        });
        let detail = match &self.picture {
            Picture::Shape(_) => 1,
            Picture::File(texels) => {
                let texels = [0, 1].map(|i| {
                    let [from, to] = bounds[i];
                    let maps = (to - from) / self.width[i].abs();
                    (texels.size()[i] as f32 * maps / Domain::SAMPLES as f32).ceil()
                });
                (texels[0].max(texels[1]) as usize).clamp(1, DENSEST)
            }
        };
        Domain {
            bounds,
            periodic: self.periodic,
            detail,
        }
    }

    /// The channels at a place.
    fn value<'b>(
        &self,
        b: &'b Builder,
        module: &mut Module,
        place: [Float<'b>; 2],
    ) -> Vec<Float<'b>> {
        let p = [0, 1].map(|i| {
            let p = (place[i] + -self.low[i]) * (1.0 / self.width[i]);
            if self.periodic {
                p - p.floor()
            } else {
                // The far edge belongs to the last band.
                p.clamp(0.0, 1.0 - 1e-6)
            }
        });
        match &self.picture {
            Picture::File(texels) => texels.at(module, p, self.periodic),
            Picture::Shape(shape) => shape.at(b, module, p, self.periodic),
        }
    }
}
