//! Maps that are shapes: bands, rings, Voronoi regions, coloured by stops.

use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Module, Type as Scalar, Value};
use mipless_codegen::moments::{self, Piecewise, Transfer};
use mipless_graph::{Node, Stops};

/// A shape in the unit square.
pub(super) struct Shape {
    kind: Kind,
    interpolation: moments::Shape,
    stops: Stops,
    count: u32,
    seed: u32,
}

enum Kind {
    /// Across the direction of this angle, in radians.
    Bands(f32),
    /// Around this place.
    Rings([f32; 2]),
    Regions,
}

impl Shape {
    /// The shape that the ports describe.
    pub(super) fn of(lower: &Lower<'_>, node: &Node) -> Self {
        Self {
            kind: match lower.choice(node, "shape") {
                "bands" => Kind::Bands(lower.float(node, "rotate").to_radians()),
                "rings" => {
                    let center = node.literal("center").numbers();
                    Kind::Rings([center[0], center[1]])
                }
                _ => Kind::Regions,
            },
            interpolation: match lower.choice(node, "interpolation") {
                "constant" => moments::Shape::Constant,
                "smooth" => moments::Shape::Smooth,
                _ => moments::Shape::Linear,
            },
            stops: lower.stops(node, "stops").clone(),
            count: lower.integer(node, "count").unsigned_abs(),
            seed: lower.integer(node, "seed") as u32,
        }
    }

    /// The least and the largest value of each channel.
    pub(super) fn ranges(&self) -> Vec<[f32; 2]> {
        (0..self.stops.ty.components())
            .map(|i| {
                let values = self.stops.stops.iter().map(|stop| stop.value[i]);
                values.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], value| {
                    [low.min(value), high.max(value)]
                })
            })
            .collect()
    }

    /// The channels at a place of the unit square.
    pub(super) fn at(
        &self,
        b: &mut Builder,
        module: &mut Module,
        p: [Value; 2],
        periodic: bool,
    ) -> Vec<Value> {
        let t = match self.kind {
            Kind::Bands(angle) => {
                let (sine, cosine) = angle.sin_cos();
                let (cosine, sine) = (b.f32(cosine), b.f32(sine));
                let across = b.dot(&p, &[cosine, sine]);
                self.repeated(b, across)
            }
            Kind::Rings(center) => {
                let from = [0, 1].map(|i| b.offset(p[i], -center[i]));
                let square = b.dot(&from, &from);
                let distance = b.sqrt(square);
                let distance = b.scale(distance, 2.0);
                self.repeated(b, distance)
            }
            Kind::Regions => self.nearest(b, module, p, periodic),
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
    fn nearest(
        &self,
        b: &mut Builder,
        module: &mut Module,
        p: [Value; 2],
        periodic: bool,
    ) -> Value {
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
            if periodic {
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
