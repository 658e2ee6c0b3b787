//! A colour for each pair of values of two signals.

use mipless_codegen::ir::{Builder, Module, Type as Scalar, Value};
use mipless_codegen::moments::{Domain, Piecewise, Shape, Signal, Transfer};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range,
    Stops, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "colormap2d",
    aliases: &["color_map_2d", "bivariate_ramp", "ramp2d", "lut2d"],
    category: Category::Color,
    summary: "A colour or number for each pair of values of two signals.",
    doc: Doc {
        computes: "With p = (in1 − low₁, in2 − low₂) / (high − low), limited to [0, 1]² or wrapped \
            around (`addressmode`), a place t of the stops: `bands`, t = fract(count · (p₁ cos a + p₂ \
            sin a)) for the angle a = `rotate`; `rings`, t = fract(2 count |p − center|); `regions`, \
            t = (i + ½)/count in the Voronoi cell of site i of `count` random ones. out = the value \
            of the stops at t, as in `colorramp`; alpha is a channel like the others.",
        statistics: "The function is sampled when it is compiled; a pyramid of its means under isotropic \
            Gaussians is read by five taps along the major axis of the covariance of the two \
            signals. So the covariance counts in full, whether the signals are correlated as \
            processes or only within this footprint. Slopes and what is left of the variance come \
            from tables of their own where something reads them; the third cumulant is not used, \
            and what channels share beyond their slopes is not carried.",
        accuracy: "For Gaussian inputs with standard deviations up to an eighth of the domain, ratios of up \
            to 16 and any correlation: mean error of at most 0.003 of the range of values for maps \
            with jumps and 0.001 for smooth ones, by tables of less than 1 MB. The manifest states the largest error of \
            each table. Held by `codegen/src/moments/map/tests.rs` against dense numerical \
            integration in f64.",
        references: "Grenier, Sauvage, Dischler & Thery 2022, *Color-mapped noise vector fields for \
            generating procedural micro-patterns*, §5 (two independent noises, axis-aligned \
            Gaussians). Heitz, Nowrouzezahrai, Poulin & Neyret 2013, *Filtering Color Mapped \
            Textures and Surfaces*, §4.",
    },
    inputs: &[
        PortSpec::new(
            "in1",
            PortType::Exactly(Type::Float),
            Default::Float(0.0),
            "The signal along the map's first axis.",
        )
        .range(Range::soft(0.0, 1.0)),
        PortSpec::new(
            "in2",
            PortType::Exactly(Type::Float),
            Default::Float(0.0),
            "The signal along the map's second axis.",
        )
        .range(Range::soft(0.0, 1.0)),
        PortSpec::new(
            "shape",
            PortType::Choice(&["bands", "rings", "regions"]),
            Default::Choice("regions"),
            "What the map looks like.",
        ),
        PortSpec::new(
            "stops",
            PortType::Stops,
            Default::Stops(&[(0.0, 0.0), (1.0, 1.0)]),
            "Places of [0, 1] and values; the type is float if every value is a number, else color3 or \
             color4.",
        ),
        PortSpec::new(
            "interpolation",
            PortType::Choice(&["constant", "linear", "smooth"]),
            Default::Choice("linear"),
            "How the value goes from stop to stop.",
        ),
        PortSpec::new(
            "count",
            PortType::Exactly(Type::Integer),
            Default::Integer(8),
            "How often bands or rings repeat the stops across the map, or how many regions there are.",
        )
        .uniform()
        .range(Range::hard(1.0, 256.0).with_soft(1.0, 32.0)),
        PortSpec::new(
            "low",
            PortType::Exactly(Type::Vector2),
            Default::Vector2([0.0, 0.0]),
            "The signals' values at the map's first corner.",
        )
        .uniform()
        .range(Range::soft(-1.0, 1.0)),
        PortSpec::new(
            "high",
            PortType::Exactly(Type::Vector2),
            Default::Vector2([1.0, 1.0]),
            "The signals' values at the opposite corner, at least 1e-3 from `low`.",
        )
        .uniform()
        .range(Range::soft(-1.0, 1.0)),
        PortSpec::new(
            "rotate",
            PortType::Exactly(Type::Float),
            Default::Float(0.0),
            "The direction across the bands, counter-clockwise from the first axis.",
        )
        .uniform()
        .range(Range::soft(0.0, 360.0))
        .unit("degrees"),
        PortSpec::new(
            "center",
            PortType::Exactly(Type::Vector2),
            Default::Vector2([0.5, 0.5]),
            "The centre of the rings, in the map.",
        )
        .uniform(),
        PortSpec::new(
            "addressmode",
            PortType::Choice(&["clamp", "periodic"]),
            Default::Choice("clamp"),
            "What lies beyond the map: its edge, or the map again.",
        ),
        PortSpec::new(
            "seed",
            PortType::Exactly(Type::Integer),
            Default::Integer(0),
            "Selects the sites of the regions.",
        )
        .uniform()
        .range(Range::hard(i32::MIN as f32, i32::MAX as f32).with_soft(0.0, 100.0)),
    ],
    output: OutputType::Stops,
    class: |_| Behaviour::Function,
    example: r##"{
  "version": 1,
  "name": "colormap2d_example",
  "nodes": {
    "folds": { "type": "spectralnoise2d", "inputs": { "frequency": 5, "pivot": 0.5 } },
    "grain": { "type": "noise2d", "inputs": { "frequency": 9, "pivot": 0.5, "seed": 3 } },
    "colormap2d": { "type": "colormap2d", "inputs": {
        "in1": { "node": "folds" }, "in2": { "node": "grain" },
        "shape": "regions", "count": 12, "interpolation": "linear",
        "stops": [
          { "at": 0, "value": "#7d6b57" }, { "at": 0.5, "value": "#a89078" }, { "at": 1, "value": "#c9bca6" }
        ] } }
  },
  "outputs": { "out": { "node": "colormap2d" } }
}"##,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

/// The smallest width of a map.
const NARROWEST: f32 = 1e-3;

/// What a map looks like: everything but its place.
struct Look {
    shape: String,
    interpolation: Shape,
    stops: Stops,
    count: u32,
    rotate: f32,
    center: [f32; 2],
    seed: u32,
    low: [f32; 2],
    width: [f32; 2],
    periodic: bool,
}

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let (x, y) = (lower.signal(node, "in1"), lower.signal(node, "in2"));
    let pair = |port: &str| {
        let numbers = node.literal(port).numbers();
        [numbers[0], numbers[1]]
    };
    let (low, high) = (pair("low"), pair("high"));
    let stops = lower.stops(node, "stops").clone();
    let look = Look {
        shape: lower.choice(node, "shape").to_owned(),
        interpolation: match lower.choice(node, "interpolation") {
            "constant" => Shape::Constant,
            "smooth" => Shape::Smooth,
            _ => Shape::Linear,
        },
        count: lower.integer(node, "count").unsigned_abs(),
        rotate: lower.float(node, "rotate").to_radians(),
        center: pair("center"),
        seed: lower.integer(node, "seed") as u32,
        low,
        width: [0, 1].map(|i| {
            let width: f32 = high[i] - low[i];
            if width.abs() < NARROWEST {
                NARROWEST.copysign(width)
            } else {
                width
            }
        }),
        periodic: lower.choice(node, "addressmode") == "periodic",
        stops,
    };
    let ranges: Vec<[f32; 2]> = (0..look.stops.ty.components())
        .map(|i| {
            let values = look.stops.stops.iter().map(|stop| stop.value[i]);
            values.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], value| {
                [low.min(value), high.max(value)]
            })
        })
        .collect();
    let domain = look.domain([&x, &y]);
    lower.map(node, [&x, &y], domain, &ranges, move |b, module, place| {
        look.value(b, module, place)
    })
}

impl Look {
    /// Where the map is sampled: one period, or what the signals reach of the map and of half a map
    /// around it.
    fn domain(&self, signals: [&Signal; 2]) -> Domain {
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
        Domain {
            bounds,
            periodic: self.periodic,
        }
    }

    /// The channels at a place.
    fn value(&self, b: &mut Builder, module: &mut Module, place: [Value; 2]) -> Vec<Value> {
        let p = [0, 1].map(|i| {
            let from = b.offset(place[i], -self.low[i]);
            let p = b.scale(from, 1.0 / self.width[i]);
            if self.periodic {
                let whole = b.floor(p);
                b.sub(p, whole)
            } else {
                // The far edge belongs to the last band.
                b.clamp(p, 0.0, 1.0 - 1e-6)
            }
        });
        let t = match self.shape.as_str() {
            "bands" => {
                let (sine, cosine) = self.rotate.sin_cos();
                let (cosine, sine) = (b.f32(cosine), b.f32(sine));
                let across = b.dot(&p, &[cosine, sine]);
                self.repeated(b, across)
            }
            "rings" => {
                let from = [0, 1].map(|i| b.offset(p[i], -self.center[i]));
                let square = b.dot(&from, &from);
                let distance = b.sqrt(square);
                let distance = b.scale(distance, 2.0);
                self.repeated(b, distance)
            }
            _ => self.nearest(b, module, p),
        };
        (0..self.stops.ty.components())
            .map(|i| {
                let stops: Vec<_> = (self.stops.stops.iter())
                    .map(|stop| (b.f32(stop.at), b.f32(stop.value[i])))
                    .collect();
                Piecewise::ramp(b, &stops, self.interpolation).value(b, t)
            })
            .collect()
    }

    fn repeated(&self, b: &mut Builder, x: Value) -> Value {
        let x = b.scale(x, self.count as f32);
        let whole = b.floor(x);
        b.sub(x, whole)
    }

    /// The stops' place of the site that is nearest to p; in a periodic map, through its edges.
    fn nearest(&self, b: &mut Builder, module: &mut Module, p: [Value; 2]) -> Value {
        let sites: Vec<f32> = (0..self.count).flat_map(|i| self.site(i)).collect();
        let table = module.table("sites", sites);
        let mut turn = Builder::new("nearer", "One more site of a Voronoi diagram.");
        let index = turn.param("index", Scalar::U32);
        let (least, best) = (turn.param_f32("least"), turn.param_f32("best"));
        let p_of = ["x", "y"].map(|name| turn.param_f32(name));
        let two = turn.u32(2);
        let first = turn.mul_u(index, two);
        let one = turn.u32(1);
        let second = turn.add_u(first, one);
        let from = [(p_of[0], first), (p_of[1], second)].map(|(p, at)| {
            let site = turn.load(table, at);
            let from = turn.sub(p, site);
            if self.periodic {
                let shifted = turn.offset(from, 0.5);
                let whole = turn.floor(shifted);
                turn.sub(from, whole)
            } else {
                from
            }
        });
        let distance = turn.dot(&from, &from);
        let nearer = turn.lt(distance, least);
        let least = turn.min(distance, least);
        let number = turn.float_u(index);
        let number = turn.offset(number, 0.5);
        let number = turn.scale(number, 1.0 / self.count as f32);
        let best = turn.select(nearer, number, best);
        turn.result("least", least);
        turn.result("best", best);
        let turn = turn.finish(module);
        let (count, far, none) = (b.u32(self.count), b.f32(1e9), b.f32(0.0));
        b.fold(&turn, count, &[far, none], &p)[1]
    }

    /// The place of site i in the map.
    fn site(&self, i: u32) -> [f32; 2] {
        [0, 1].map(|axis| {
            let mut x = self.seed ^ (2 * i + axis).wrapping_mul(0x9e37_79b1);
            for _ in 0..2 {
                x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
                x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
                x ^= x >> 16;
            }
            (x >> 8) as f32 / (1u32 << 24) as f32
        })
    }
}
