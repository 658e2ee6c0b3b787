//! A wall of bricks with joints and ramps, averaged over two Gaussians.
//!
//! The bricks of the unit cell are rows of a table. Those that the footprint reaches are bits of a
//! number, and are summed one after the other: near a corner three, within a face one, and all of them
//! only where the footprint covers the cell. Bricks do not overlap, so the square of the wall is the
//! sum of their squares.

use super::bits;
use super::bond::{Bond, Brick, Rows};
use super::harmonics::{Factors, Spectrum, nearest, unknown};
use super::pulse::{Axis, Pulse, SHORT_RAMP, Series};
use super::separable::{Cell, Place};
use super::taps::{by_place, joined};
use super::wanted::{Wanted, names};
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use std::f64::consts::{PI, TAU};

/// How far a footprint reaches, in standard deviations: what lies beyond is 3e-5 of it.
const REACH: f32 = 4.0;

/// A wall; its parameters are the running bond's offset, then joint and ramp along x and along y, in
/// bricks and rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wall {
    /// How its bricks are laid.
    pub(crate) bond: Bond,
}

impl Cell for Wall {
    fn key(&self) -> String {
        format!("brick {:?}", self.bond)
    }

    fn value(&self, b: &mut Builder, parameters: &[Value], at: [Value; 2]) -> Value {
        let mut sum = b.f32(0.0);
        for brick in self.bond.bricks() {
            let centre = brick.place(b, parameters[0]);
            let size = brick.size.map(|size| b.f32(size));
            let pulses = self.pulses(b, centre, size, &parameters[1..]);
            let [x, y] = [0, 1].map(|k| pulses[k].value(b, at[k]));
            let part = b.mul(x, y);
            sum = b.add(sum, part);
        }
        sum
    }

    fn averaged(
        &self,
        b: &mut Builder,
        module: &mut Module,
        parameters: &[Value],
        place: &Place,
        of: Wanted,
    ) -> Vec<Value> {
        let bricks = self.bond.bricks();
        let known: Vec<Option<f32>> = parameters.iter().map(|&v| b.as_constant(v)).collect();
        let body = self.brick(module, &known, of);
        let near: Vec<Value> = (bricks.iter())
            .map(|brick| self.reached(b, brick, parameters[0], &place.axes))
            .collect();
        let [touched, count] = bits::set(b, &near);
        let zero = b.f32(0.0);
        let mut state = vec![touched];
        state.resize(1 + of.orders + usize::from(of.squared), zero);
        let [x, y] = place.axes;
        let mut captures = vec![x.mean, y.mean, x.sd, y.sd, place.correlation];
        captures.extend(unknown(parameters, &known));
        let mut out = b.fold(&body, count, &state, &captures).split_off(1);
        by_place(b, &mut out[..of.orders], place.axes.map(|axis| axis.sd));
        out
    }

    fn spectrum(&self, parameters: &[Option<f32>]) -> Option<Spectrum<'_>> {
        let offset = f64::from(parameters[0]?);
        let (middle, shear) = self.bond.symmetry(offset);
        let middle = [0, 1].map(|axis| middle[axis] / f64::from(self.bond.cell()[axis]));
        let known: Option<Vec<f64>> = (parameters.iter())
            .map(|known| known.map(f64::from))
            .collect();
        let wall = *self;
        Some(match known {
            Some(known) => Spectrum::known(middle, shear, move |frequency| {
                wall.wave(&known, middle, frequency)
                    .map(|[even, _]| even)
                    .to_vec()
            }),
            None => Spectrum::of_factors(middle, shear, self, move |frequency| {
                let sizes = wall.sizes();
                let mut sums = vec![0.0; sizes.len()];
                for brick in wall.bond.bricks() {
                    let of = sizes.iter().position(|&size| size == brick.size);
                    let turns = wall.turns(&brick, offset, middle, frequency);
                    sums[of.expect("a size of the bond")] += (TAU * turns).cos();
                }
                sums
            }),
        })
    }
}

impl Factors for Wall {
    fn products(&self) -> usize {
        self.sizes().len()
    }

    fn along(
        &self,
        b: &mut Builder,
        axis: usize,
        frequency: Value,
        parameters: &[Value],
    ) -> Vec<[Value; 2]> {
        let cell = self.bond.cell()[axis];
        let [joint, ramp] = [1, 2].map(|i| parameters[2 * axis + i]);
        (self.sizes().into_iter())
            .map(|size| {
                let size = b.f32(size[axis]);
                let face = b.sub(size, joint);
                let zero = b.f32(0.0);
                let face = b.max(face, zero);
                let outer = b.scale(face, 0.5);
                let ramp = b.min(ramp, outer);
                // As of `wave`.
                [(1.0, 1.0), (4.0 / 3.0, 0.816_496_6)].map(|(lost, share)| {
                    let lost = b.scale(ramp, lost);
                    let width = b.sub(face, lost);
                    let width = b.scale(width, 1.0 / cell);
                    let ramp = b.scale(ramp, share / cell);
                    let (turns, ramped) = (b.mul(frequency, width), b.mul(frequency, ramp));
                    let (face, edge) = (live_sinc(b, turns), live_sinc(b, ramped));
                    let face = b.mul(width, face);
                    b.mul(face, edge)
                })
            })
            .collect()
    }
}

impl Wall {
    /// The sizes of bricks that differ.
    fn sizes(&self) -> Vec<[f32; 2]> {
        let mut sizes = Vec::new();
        for brick in self.bond.bricks() {
            if !sizes.contains(&brick.size) {
                sizes.push(brick.size);
            }
        }
        sizes
    }

    /// The phase of a wave at a brick, from a point.
    fn turns(&self, brick: &Brick, offset: f64, from: [f64; 2], frequency: [f64; 2]) -> f64 {
        let shift = if brick.shifted { offset } else { 0.0 };
        let shift = [shift, 0.0];
        let along = [0, 1].map(|axis| {
            let centre = f64::from(brick.centre[axis]) + shift[axis];
            let centre = centre / f64::from(self.bond.cell()[axis]);
            frequency[axis] * (centre - from[axis])
        });
        along[0] + along[1]
    }

    /// The integrals over the unit cell of the wall and of its square times cos and sin of 2π times the
    /// frequency times the distance from a point.
    fn wave(&self, parameters: &[f64], from: [f64; 2], frequency: [f64; 2]) -> [[f64; 2]; 2] {
        let mut sums = [[0.0; 2]; 2];
        for brick in self.bond.bricks() {
            let turns = self.turns(&brick, parameters[0], from, frequency);
            let mut both = [1.0; 2];
            for axis in [0, 1] {
                let cell = f64::from(self.bond.cell()[axis]);
                let (joint, ramp) = (parameters[1 + 2 * axis], parameters[2 + 2 * axis]);
                let outer = 0.5 * (f64::from(brick.size[axis]) - joint).max(0.0);
                let ramp = ramp.min(outer);
                // As of `Pulse`: a squared ramp rises later and has less spread.
                let faces = [
                    (outer - 0.5 * ramp, ramp),
                    (outer - ramp * 2.0 / 3.0, ramp * 0.816_496_6),
                ];
                for (product, (half, ramp)) in both.iter_mut().zip(faces) {
                    let (width, ramp) = (2.0 * half / cell, ramp / cell);
                    *product *=
                        width * sinc(frequency[axis] * width) * sinc(frequency[axis] * ramp);
                }
            }
            let (sine, cosine) = (TAU * turns).sin_cos();
            for (sum, product) in sums.iter_mut().zip(both) {
                sum[0] += product * cosine;
                sum[1] += product * sine;
            }
        }
        sums
    }

    /// The pulses of a brick's face along both coordinates, in unit cells.
    fn pulses(
        &self,
        b: &mut Builder,
        centre: [Value; 2],
        size: [Value; 2],
        joints: &[Value],
    ) -> [Pulse; 2] {
        [0, 1].map(|k| {
            let (joint, ramp) = (joints[2 * k], joints[2 * k + 1]);
            let cell = self.bond.cell()[k];
            let face = b.sub(size[k], joint);
            let zero = b.f32(0.0);
            let face = b.max(face, zero);
            let outer = b.scale(face, 0.5);
            let short = b.as_constant(ramp).is_some_and(|w| w / cell <= SHORT_RAMP);
            // No ramp stays one that is known, however small the face.
            let ramp = if b.is_zero(ramp) {
                ramp
            } else {
                b.min(ramp, outer)
            };
            let lost = b.scale(ramp, 0.5);
            let half = b.sub(outer, lost);
            let [centre, half, bevel] = [centre[k], half, ramp].map(|v| b.scale(v, 1.0 / cell));
            Pulse {
                repeat: 1.0,
                centre,
                half,
                bevel,
                short,
            }
        })
    }

    /// Whether a brick, with its joints, is within reach.
    fn reached(&self, b: &mut Builder, brick: &Brick, offset: Value, axes: &[Axis; 2]) -> Value {
        let centre = brick.place(b, offset);
        let mut near = b.bool(true);
        for k in [0, 1] {
            let cell = self.bond.cell()[k];
            let half = 0.5 * brick.size[k] / cell;
            if half >= 0.5 {
                continue;
            }
            let centre = b.scale(centre[k], 1.0 / cell);
            let from = b.sub(axes[k].mean, centre);
            let rounded = b.offset(from, 0.5);
            let rounded = b.floor(rounded);
            let from = b.sub(from, rounded);
            let distance = b.abs(from);
            let reach = b.scale(axes[k].sd, REACH);
            let reach = b.offset(reach, half);
            let along = b.lt(distance, reach);
            near = b.and(near, along);
        }
        near
    }

    /// One more brick of those whose bits are set, the body of a fold.
    fn brick(&self, module: &mut Module, known: &[Option<f32>], of: Wanted) -> FunctionRef {
        let rows = Rows::of(module, self.bond);
        let doc = "One more brick within reach.";
        let mut builder = Builder::new("brick_face", doc);
        let b = &mut builder;
        b.param("index", Type::U32);
        let touched = b.param("touched", Type::U32);
        let names = names(of);
        let sums: Vec<Value> = names.iter().map(|name| b.param_f32(*name)).collect();
        let [x, y, sd_x, sd_y, correlation] =
            ["x", "y", "sd_x", "sd_y", "correlation"].map(|name| b.param_f32(name));
        let names_of = ["offset", "joint_x", "ramp_x", "joint_y", "ramp_y"];
        let parameters: Vec<Value> = (names_of.iter().zip(known))
            .map(|(name, known)| match known {
                Some(v) => b.f32(*v),
                None => b.param_f32(*name),
            })
            .collect();
        let [which, left] = bits::lowest(b, touched);
        let (centre, size) = rows.brick(b, which, parameters[0]);
        let pulses = self.pulses(b, centre, size, &parameters[1..]);
        let axes = [(x, sd_x), (y, sd_y)].map(|(mean, sd)| Axis { mean, sd });
        let mut series = Series::default();
        let [x, y] =
            [0, 1].map(|k| pulses[k].moments(b, (&mut *module, &mut series), axes[k], of.squared));
        let mut parts = joined(b, x.own, y.own, correlation)[..of.orders].to_vec();
        if let (Some(x), Some(y)) = (x.square, y.square) {
            parts.push(joined(b, x, y, correlation)[0]);
        }
        b.result("touched", left);
        for ((name, sum), part) in names.iter().zip(sums).zip(parts) {
            let sum = b.add(sum, part);
            b.result(*name, sum);
        }
        builder.finish(module)
    }
}

/// sin πx/(πx) where the shader runs.
fn live_sinc(b: &mut Builder, x: Value) -> Value {
    // In turns, less whole ones.
    let turns = b.scale(x, 0.5);
    let turns = nearest(b, turns);
    let [_, sine] = b.circle(turns);
    let angle = b.scale(x, std::f32::consts::PI);
    let (magnitude, least, one) = (b.abs(angle), b.f32(1e-4), b.f32(1.0));
    let still = b.lt(magnitude, least);
    let angle = b.select(still, one, angle);
    let ratio = b.div(sine, angle);
    b.select(still, one, ratio)
}

/// sin πx/(πx).
fn sinc(x: f64) -> f64 {
    let angle = PI * x;
    if angle.abs() < 1e-9 {
        1.0
    } else {
        angle.sin() / angle
    }
}

#[cfg(test)]
mod tests {
    use super::{Bond, Wall};

    #[test]
    fn the_waves_of_a_wall_are_even_and_those_of_its_primitive_cell() {
        for name in [
            "running",
            "english",
            "flemish",
            "herringbone",
            "basket",
            "spanish",
        ] {
            let bond = Bond::named(name);
            for offset in [0.0, 0.3, 0.5] {
                let parameters = [offset, 0.1, 0.2, 0.15, 0.3];
                let (middle, shear) = bond.symmetry(offset);
                let middle = [0, 1].map(|axis| middle[axis] / f64::from(bond.cell()[axis]));
                let mut most = 0.0f64;
                for k in -6..=6 {
                    for l in -6..=6 {
                        let frequency = [k, l].map(f64::from);
                        let waves = Wall { bond }.wave(&parameters, middle, frequency);
                        for [even, odd] in waves {
                            assert!(odd.abs() < 1e-9, "{name} {offset} {k} {l}: {odd}");
                            if (l - shear.lean * k) % shear.tall != 0 {
                                assert!(even.abs() < 1e-9, "{name} {offset} {k} {l}: {even}");
                            } else if k != 0 && l != 0 {
                                most = most.max(even.abs());
                            }
                        }
                    }
                }
                assert!(most > 1e-3, "{name} has waves");
            }
        }
    }
}
