//! Maps that are shapes: bands, rings, Voronoi regions, coloured by stops.

use crate::color::stops::{FEW, Segments};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Float, FunctionRef, Module, Vec2};
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
    pub(super) fn of(lower: &Lower<'_, '_>, node: &Node) -> Self {
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
    pub(super) fn at<'b>(
        &self,
        b: &'b Builder,
        module: &mut Module,
        [x, y]: [Float<'b>; 2],
        periodic: bool,
    ) -> Vec<Float<'b>> {
        let t = match self.kind {
            Kind::Bands(angle) => {
                let (sine, cosine) = angle.sin_cos();
                self.repeated(x * cosine + y * sine)
            }
            Kind::Rings([cx, cy]) => {
                let from = Vec2([x + -cx, y + -cy]);
                self.repeated(from.norm2().sqrt() * 2.0)
            }
            Kind::Regions => self.nearest(b, module, [x, y], periodic),
        };
        if self.stops.stops.len() > FEW {
            let segments = Segments::of(&self.stops, self.interpolation);
            let table = module.table("stops", segments.rows().to_vec());
            return segments.at(b, table, t);
        }
        let channel = |i: usize| {
            let stops: Vec<_> = (self.stops.stops.iter())
                .map(|stop| (b.float(stop.at), b.float(stop.value[i])))
                .collect();
            Piecewise::ramp(&stops, self.interpolation).value(t)
        };
        (0..self.stops.ty.components()).map(channel).collect()
    }

    fn repeated<'b>(&self, x: Float<'b>) -> Float<'b> {
        let x = x * self.count as f32;
        x - x.floor()
    }

    /// The stops' place of the site that is nearest to p; in a periodic map, through its edges.
    fn nearest<'b>(
        &self,
        b: &'b Builder,
        module: &mut Module,
        p: [Float<'b>; 2],
        periodic: bool,
    ) -> Float<'b> {
        let sites: Vec<f32> = (0..self.count).flat_map(|i| self.site(i)).collect();
        let table = module.table("sites", sites);
        let nearer = self.nearer(module, table, periodic);
        let (far, none) = (b.float(1e9), b.float(0.0));
        let [_, best] = b.fold(&nearer, b.uint(self.count), [far, none], p);
        best
    }

    /// The body of a fold over the sites: the least squared distance, and the stops' place there.
    fn nearer(&self, module: &mut Module, table: u32, periodic: bool) -> FunctionRef {
        let b = &Builder::new("nearer", "One more site of a Voronoi diagram.");
        let index = b.uint_param("index");
        let [least, best, x, y] = b.float_params(["least", "best", "x", "y"]);
        let first = index * 2;
        let from = [(x, first), (y, first + 1)].map(|(p, at)| {
            let from = p - b.load(table, at);
            if periodic {
                from - (from + 0.5).floor()
            } else {
                from
            }
        });
        let distance = Vec2(from).norm2();
        let place = (index.to_float() + 0.5) * (1.0 / self.count as f32);
        b.result("least", distance.min(least));
        b.result("best", distance.lt(least).select(place, best));
        b.finish(module)
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
