//! Smooth functions of several signals, by a cubature of degree 5 at positive weights.
//!
//! With Σ = L Lᵀ the covariance of the inputs, out = μ + Σ a_j z_j + rest for z = L⁻¹(X − m):
//! μ = Σ w f, a = Σ w z f, and the rest's variance Σ w (f − μ − a·z)² (statistical linearisation; the
//! second-order remainder is in it). Weights are positive, so means stay in the function's range and
//! no variance is negative. Exact for quadratics of jointly Gaussian signals; a kink or a jump within
//! the footprint costs what its height is over the few nodes.

use super::{Algebra, Signal};
use crate::ir::{Builder, Value};

/// Standard scores and their weights: the centre with 2/(n + 2), and the vertices of a regular figure
/// at radius √(n + 2): a hexagon, an icosahedron, the 24-cell (Stroud 1971, *Approximate Calculation
/// of Multiple Integrals*, U_n 5; Mysovskikh 1980). Of one number, nine equidistant ones.
fn nodes(dimensions: usize) -> Vec<([f32; 4], f32)> {
    let radius = ((dimensions + 2) as f64).sqrt();
    let mut vertices: Vec<[f64; 4]> = Vec::new();
    match dimensions {
        1 => {
            return (super::curve::scores().into_iter())
                .map(|(z, weight)| ([z, 0.0, 0.0, 0.0], weight))
                .collect();
        }
        2 => {
            for k in 0..6 {
                let angle = std::f64::consts::FRAC_PI_3 * f64::from(k);
                vertices.push([angle.cos(), angle.sin(), 0.0, 0.0]);
            }
        }
        3 => {
            let golden = 0.5 * (1.0 + 5.0f64.sqrt());
            for (s, t) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
                let (p, q) = (s, t * golden);
                vertices.extend([[0.0, p, q, 0.0], [p, q, 0.0, 0.0], [q, 0.0, p, 0.0]]);
            }
        }
        _ => {
            for i in 0..4 {
                for j in 0..i {
                    for (s, t) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
                        let mut vertex = [0.0; 4];
                        (vertex[i], vertex[j]) = (s, t);
                        vertices.push(vertex);
                    }
                }
            }
        }
    }
    let centre = 2.0 / (dimensions as f64 + 2.0);
    let weight = (1.0 - centre) / vertices.len() as f64;
    let mut all = vec![([0.0; 4], centre as f32)];
    for vertex in vertices {
        let norm = vertex.iter().map(|x| x * x).sum::<f64>().sqrt();
        all.push((vertex.map(|x| (x * radius / norm) as f32), weight as f32));
    }
    all
}

/// Three radii, r² = 2x at the nodes x of Gauss–Laguerre, of six angles each: for functions of two
/// numbers that are not near a quadratic within the spread.
fn polar() -> Vec<([f32; 4], f32)> {
    const LAGUERRE: [(f64, f64); 3] = [
        (0.415_774_556_783_479, 0.711_093_009_929_173),
        (2.294_280_360_279_04, 0.278_517_733_569_241),
        (6.289_945_082_937_48, 0.010_389_256_501_586),
    ];
    let mut all = Vec::new();
    for (x, weight) in LAGUERRE {
        for k in 0..6 {
            let (sine, cosine) = (std::f64::consts::FRAC_PI_3 * f64::from(k)).sin_cos();
            let radius = (2.0 * x).sqrt();
            let node = [(radius * cosine) as f32, (radius * sine) as f32, 0.0, 0.0];
            all.push((node, (weight / 6.0) as f32));
        }
    }
    all
}

/// The lower triangle of L with L Lᵀ = Σ, and the inverses of its diagonal.
struct Triangle {
    rows: Vec<Vec<Value>>,
    inverses: Vec<Value>,
}

impl Algebra {
    /// The signals of a function of signals; `ranges` are those of its results.
    ///
    /// # Panics
    /// If more than four inputs have a spread: a bug of the caller.
    pub fn cubature(
        &mut self,
        inputs: &[Signal],
        ranges: &[[f32; 2]],
        function: impl Fn(&mut Builder, &[Value]) -> Vec<Value>,
    ) -> Vec<Signal> {
        self.cubature_by(nodes, inputs, ranges, function)
    }

    /// The same for two signals whose function is not near a quadratic: 18 nodes instead of 7.
    pub fn fine_cubature(
        &mut self,
        inputs: &[Signal; 2],
        ranges: &[[f32; 2]],
        function: impl Fn(&mut Builder, &[Value]) -> Vec<Value>,
    ) -> Vec<Signal> {
        let nodes = |dimensions| match dimensions {
            2 => polar(),
            _ => nodes(dimensions),
        };
        self.cubature_by(nodes, inputs, ranges, function)
    }

    fn cubature_by(
        &mut self,
        nodes: impl Fn(usize) -> Vec<([f32; 4], f32)>,
        inputs: &[Signal],
        ranges: &[[f32; 2]],
        function: impl Fn(&mut Builder, &[Value]) -> Vec<Value>,
    ) -> Vec<Signal> {
        let inputs: Vec<Signal> = inputs.iter().map(|x| x.flat(&mut self.b)).collect();
        let means: Vec<Value> = inputs.iter().map(|x| x.mean).collect();
        let uncertain: Vec<usize> = (0..inputs.len())
            .filter(|&i| self.mode.spreads() && !inputs[i].is_certain(&self.b))
            .collect();
        let results = |b: &mut Builder, arguments: &[Value]| {
            let values = function(b, arguments);
            assert_eq!(values.len(), ranges.len(), "results of the function");
            values
        };
        let centre = results(&mut self.b, &means);
        if uncertain.is_empty() {
            let signals = centre.into_iter().zip(ranges);
            return signals
                .map(|(value, &range)| Signal::certain(&mut self.b, value).with_range(range))
                .collect();
        }
        self.bent = true;
        self.period = None;
        let spread: Vec<Signal> = uncertain.iter().map(|&i| self.expose(&inputs[i])).collect();
        let triangle = self.triangle(&spread);
        let b = &mut self.b;
        let mut rows: Vec<([f32; 4], f32, Vec<Value>)> = Vec::new();
        for (z, weight) in nodes(spread.len()) {
            let mut arguments = means.clone();
            for (row, &i) in triangle.rows.iter().zip(&uncertain) {
                for (&l, &z) in row.iter().zip(&z) {
                    let step = b.scale(l, z);
                    arguments[i] = b.add(arguments[i], step);
                }
            }
            let values = if z == [0.0; 4] {
                centre.clone()
            } else {
                results(b, &arguments)
            };
            rows.push((z, weight, values));
        }
        let mut out = Vec::with_capacity(ranges.len());
        for (k, &range) in ranges.iter().enumerate() {
            let b = &mut self.b;
            // Of the difference from the centre: a footprint of 0 gives the value.
            let mut mean = b.f32(0.0);
            let mut slopes = vec![mean; spread.len()];
            for (z, weight, values) in &rows {
                let beyond = b.sub(values[k], centre[k]);
                let part = b.scale(beyond, *weight);
                mean = b.add(mean, part);
                for (slope, &z) in slopes.iter_mut().zip(z) {
                    let part = b.scale(beyond, weight * z);
                    *slope = b.add(*slope, part);
                }
            }
            let mut distortion = b.f32(0.0);
            for (z, weight, values) in &rows {
                let beyond = b.sub(values[k], centre[k]);
                let mut residual = b.sub(beyond, mean);
                for (&slope, &z) in slopes.iter().zip(z) {
                    let line = b.scale(slope, z);
                    residual = b.sub(residual, line);
                }
                let square = b.square(residual);
                let part = b.scale(square, *weight);
                distortion = b.add(distortion, part);
            }
            // β = L⁻ᵀ a: the coefficients of the inputs themselves.
            let mut signal = Signal::constant(b, 0.0);
            for j in (0..spread.len()).rev() {
                slopes[j] = b.mul(slopes[j], triangle.inverses[j]);
                for i in 0..j {
                    let part = b.mul(triangle.rows[j][i], slopes[j]);
                    slopes[i] = b.sub(slopes[i], part);
                }
                let part = spread[j].scale(b, slopes[j]);
                signal = signal.add(b, &part);
            }
            signal.mean = b.add(centre[k], mean);
            signal.range = range;
            if range[0].is_finite() && range[1].is_finite() {
                signal.mean = b.clamp(signal.mean, range[0], range[1]);
            }
            self.attach_fresh(&mut signal, distortion);
            out.push(signal);
        }
        out
    }

    fn triangle(&mut self, inputs: &[Signal]) -> Triangle {
        let mut rows: Vec<Vec<Value>> = Vec::new();
        let mut inverses: Vec<Value> = Vec::new();
        for (j, x) in inputs.iter().enumerate() {
            let mut row = Vec::new();
            let mut left = x.variance(&mut self.b);
            for i in 0..j {
                let b = &mut self.b;
                let mut covariance = x.covariance(b, &inputs[i]).total;
                for (&p, &q) in row.iter().zip(&rows[i]) {
                    let part = b.mul(p, q);
                    covariance = b.sub(covariance, part);
                }
                let entry = b.mul(covariance, inverses[i]);
                let square = b.square(entry);
                left = b.sub(left, square);
                row.push(entry);
            }
            let zero = self.b.f32(0.0);
            let left = self.b.max(left, zero);
            let (sd, inverse) = super::spread(&mut self.b, left);
            row.push(sd);
            rows.push(row);
            inverses.push(inverse);
        }
        Triangle { rows, inverses }
    }
}

#[cfg(test)]
mod tests {
    use super::nodes;

    #[test]
    fn rules_are_exact_for_quadratics_and_fourth_moments() {
        for dimensions in 1..=4 {
            let nodes = nodes(dimensions);
            let mean = |f: &dyn Fn(&[f32; 4]) -> f32| -> f32 {
                nodes.iter().map(|(z, weight)| weight * f(z)).sum()
            };
            assert!((mean(&|_| 1.0) - 1.0).abs() < 1e-6);
            for i in 0..dimensions {
                assert!(mean(&|z| z[i]).abs() < 1e-6);
                assert!((mean(&|z| z[i] * z[i]) - 1.0).abs() < 1e-5);
                assert!((mean(&|z| z[i].powi(4)) - 3.0).abs() < 3e-3, "{dimensions}");
                for j in 0..i {
                    assert!(mean(&|z| z[i] * z[j]).abs() < 1e-6);
                    assert!((mean(&|z| z[i] * z[i] * z[j] * z[j]) - 1.0).abs() < 1e-5);
                }
            }
        }
    }
}
