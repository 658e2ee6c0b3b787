//! A wall of bricks with joints and ramps, averaged over two Gaussians.
//!
//! The bricks of the unit cell are rows of a table. Those that the footprint reaches are bits of a
//! number, and are summed one after the other: near a corner three, within a face one, and all of them
//! only where the footprint covers the cell. Bricks do not overlap, so the square of the wall is the
//! sum of their squares.

use super::bits;
use super::bond::{Bond, Brick, Rows};
use super::harmonics::{Factors, Spectrum, unknown};
use super::pulse::{Axis, Pulse, SHORT_RAMP, Series};
use super::separable::{Cell, Place};
use super::taps::{by_place, joined};
use super::wanted::{Wanted, names};
use super::waves::nearest;
use mipless_codegen::ir::{Bool, Builder, Float, FunctionRef, Module};
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

    fn value<'b>(&self, parameters: &[Float<'b>], at: [Float<'b>; 2]) -> Float<'b> {
        let b = at[0].builder();
        b.sum(self.bond.bricks().into_iter().map(|brick| {
            let size = brick.size.map(|size| b.float(size));
            let [x, y] = self.pulses(brick.place(parameters[0]), size, &parameters[1..]);
            x.value(at[0]) * y.value(at[1])
        }))
    }

    fn averaged<'b>(
        &self,
        module: &mut Module,
        parameters: &[Float<'b>],
        place: &Place<'b>,
        of: Wanted,
    ) -> Vec<Float<'b>> {
        let b = place.correlation.builder();
        let known: Vec<Option<f32>> = parameters.iter().map(|v| v.as_constant()).collect();
        let body = self.brick(module, &known, of);
        let near: Vec<Bool<'b>> = (self.bond.bricks().iter())
            .map(|brick| self.reached(brick, parameters[0], &place.axes))
            .collect();
        let [touched, count] = bits::set(b, &near);
        let none = vec![b.float(0.0); of.orders + usize::from(of.squared)];
        let (means, sds) = (
            place.axes.map(|axis| axis.mean),
            place.axes.map(|axis| axis.sd),
        );
        let captures = (means, sds, place.correlation, unknown(parameters, &known));
        let (_, mut out) = b.fold(&body, count, (touched, none), captures);
        by_place(&mut out[..of.orders], sds);
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

    fn along<'b>(
        &self,
        axis: usize,
        frequency: Float<'b>,
        parameters: &[Float<'b>],
    ) -> Vec<[Float<'b>; 2]> {
        let cell = self.bond.cell()[axis];
        let [joint, ramp] = [1, 2].map(|i| parameters[2 * axis + i]);
        (self.sizes().into_iter())
            .map(|size| {
                let face = (size[axis] - joint).max(0.0);
                let ramp = ramp.min(face * 0.5);
                // As of `wave`.
                [(1.0, 1.0), (4.0 / 3.0, 0.816_496_6)].map(|(lost, share): (f32, f32)| {
                    let width = (face - ramp * lost) * (1.0 / cell);
                    let ramp = ramp * (share / cell);
                    width * live_sinc(frequency * width) * live_sinc(frequency * ramp)
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
    fn pulses<'b>(
        &self,
        centre: [Float<'b>; 2],
        size: [Float<'b>; 2],
        joints: &[Float<'b>],
    ) -> [Pulse<'b>; 2] {
        [0, 1].map(|k| {
            let (joint, ramp) = (joints[2 * k], joints[2 * k + 1]);
            let cell = self.bond.cell()[k];
            let outer = (size[k] - joint).max(0.0) * 0.5;
            let short = ramp.as_constant().is_some_and(|w| w / cell <= SHORT_RAMP);
            // No ramp stays one that is known, however small the face.
            let ramp = if ramp.is_zero() {
                ramp
            } else {
                ramp.min(outer)
            };
            let half = outer - ramp * 0.5;
            let [centre, half, bevel] = [centre[k], half, ramp].map(|v| v * (1.0 / cell));
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
    fn reached<'b>(&self, brick: &Brick, offset: Float<'b>, axes: &[Axis<'b>; 2]) -> Bool<'b> {
        let centre = brick.place(offset);
        let mut near = offset.builder().literal(true);
        for k in [0, 1] {
            let cell = self.bond.cell()[k];
            let half = 0.5 * brick.size[k] / cell;
            if half >= 0.5 {
                continue;
            }
            let distance = nearest(axes[k].mean - centre[k] * (1.0 / cell)).abs();
            near = near & distance.lt(axes[k].sd * REACH + half);
        }
        near
    }

    /// One more brick of those whose bits are set, the body of a fold.
    fn brick(&self, module: &mut Module, known: &[Option<f32>], of: Wanted) -> FunctionRef {
        let rows = Rows::of(module, self.bond);
        let b = &Builder::new("brick_face", "One more brick within reach.");
        b.uint_param("index");
        let touched = b.uint_param("touched");
        let names = names(of);
        let sums: Vec<Float<'_>> = names.iter().map(|name| b.float_param(*name)).collect();
        let means = b.float_params(["x", "y"]);
        let sds = b.float_params(["sd_x", "sd_y"]);
        let correlation = b.float_param("correlation");
        let names_of = ["offset", "joint_x", "ramp_x", "joint_y", "ramp_y"];
        let parameters: Vec<Float<'_>> = (names_of.iter().zip(known))
            .map(|(name, known)| match known {
                Some(v) => b.float(*v),
                None => b.float_param(*name),
            })
            .collect();
        let [which, left] = bits::lowest(touched);
        let (centre, size) = rows.brick(which, parameters[0]);
        let pulses = self.pulses(centre, size, &parameters[1..]);
        let mut series = Series::default();
        let [x, y] = [0, 1].map(|k| {
            let axis = Axis {
                mean: means[k],
                sd: sds[k],
            };
            pulses[k].moments((&mut *module, &mut series), axis, of.squared)
        });
        let mut parts = joined(x.own, y.own, correlation)[..of.orders].to_vec();
        if let (Some(x), Some(y)) = (x.square, y.square) {
            parts.push(joined(x, y, correlation)[0]);
        }
        b.result("touched", left);
        b.sums(names.iter().copied(), sums, parts);
        b.finish(module)
    }
}

/// sin πx/(πx) where the shader runs.
fn live_sinc(x: Float<'_>) -> Float<'_> {
    // In turns, less whole ones.
    let [_, sine] = nearest(x * 0.5).circle();
    let angle = x * std::f32::consts::PI;
    let still = angle.abs().lt(1e-4);
    still.select(1.0, sine / still.select(1.0, angle))
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
