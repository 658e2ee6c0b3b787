//! Smooth functions of several signals, by a cubature of degree 5 at positive weights.
//!
//! With Σ = L Lᵀ the covariance of the inputs, out = μ + Σ a_j z_j + rest for z = L⁻¹(X − m):
//! μ = Σ w f, a = Σ w z f, and the rest's variance Σ w (f − μ − a·z)² (statistical linearisation; the
//! second-order remainder is in it). Weights are positive, so means stay in the function's range and
//! no variance is negative. Exact for quadratics of jointly Gaussian signals; a kink or a jump within
//! the footprint costs what its height is over the few nodes.

use super::{Algebra, Signal};
use crate::ir::Float;

/// Standard scores and their weights: the centre with 2/(n + 2), and the vertices of a regular figure
/// at radius √(n + 2): a hexagon, an icosahedron, the 24-cell (Stroud 1971, *Approximate Calculation
/// of Multiple Integrals*, U_n 5; Mysovskikh 1980). Of one number, nine equidistant ones.
fn nodes(dimensions: usize) -> Vec<([f32; 4], f32)> {
    let radius = ((dimensions + 2) as f64).sqrt();
    let mut vertices: Vec<[f64; 4]> = Vec::new();
    match dimensions {
        1 => {
            return (super::curve::scores::<9>(1.1).into_iter())
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

/// Four radii of six angles each, for functions of two numbers that are not near a quadratic within the
/// spread: r² = 2x with e^{−x} at the nodes of Gauss–Legendre, so that what happens near the middle and
/// what saturates far out count by their probability; x is scaled so that quadratics are exact. E[n_x²] of
/// normals whose slopes have a standard deviation of 1.6 is within 0.003; at the nodes of
/// Gauss–Laguerre it is 0.02 off with three radii, and 0.01 with five.
fn polar() -> Vec<([f32; 4], f32)> {
    const LEGENDRE: [(f64, f64); 4] = [
        (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
        (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
        (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
        (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
    ];
    let rings = LEGENDRE.map(|(share, weight)| (-(1.0 - share).ln(), weight));
    let mean: f64 = rings.iter().map(|(x, weight)| x * weight).sum();
    let mut all = Vec::new();
    for (x, weight) in rings {
        for k in 0..6 {
            let (sine, cosine) = (std::f64::consts::FRAC_PI_3 * f64::from(k)).sin_cos();
            let radius = (2.0 * x / mean).sqrt();
            let node = [(radius * cosine) as f32, (radius * sine) as f32, 0.0, 0.0];
            all.push((node, (weight / 6.0) as f32));
        }
    }
    all
}

/// The share of a variance that counts as explained by the others where no more is left.
const EXPLAINED: f32 = 1e-6;
/// The least variance that is told from none.
const NARROWEST: f32 = 1e-13;

/// The lower triangle of L with L Lᵀ = Σ, and the inverses of its diagonal.
struct Triangle<'b> {
    rows: Vec<Vec<Float<'b>>>,
    inverses: Vec<Float<'b>>,
}

impl<'b> Triangle<'b> {
    /// Of the covariances of signals.
    fn of(inputs: &[Signal<'b>]) -> Self {
        let mut rows: Vec<Vec<Float<'b>>> = Vec::new();
        let mut inverses: Vec<Float<'b>> = Vec::new();
        for (j, x) in inputs.iter().enumerate() {
            let mut row: Vec<Float<'b>> = Vec::new();
            let variance = x.variance();
            let mut left = variance;
            for i in 0..j {
                let products = row.iter().zip(&rows[i]).map(|(&p, &q)| p * q);
                let covariance = x.covariance(&inputs[i]).total;
                let covariance = products.fold(covariance, |left, product| left - product);
                let entry = covariance * inverses[i];
                left -= entry.square();
                row.push(entry);
            }
            // What rounding leaves of a variance that others explain is no spread: the hue of a grey
            // would take every value.
            let own = left.gt(variance * EXPLAINED + NARROWEST);
            let sd = left.max(NARROWEST).sqrt();
            row.push(own.select(sd, 0.0));
            rows.push(row);
            inverses.push(own.select(1.0 / sd, 0.0));
        }
        Self { rows, inverses }
    }
}

impl<'b> Algebra<'b> {
    /// The signals of a function of signals; `ranges` are those of its results.
    ///
    /// # Panics
    /// If more than four inputs have a spread: a bug of the caller.
    pub fn cubature(
        &mut self,
        inputs: &[Signal<'b>],
        ranges: &[[f32; 2]],
        function: impl Fn(&[Float<'b>]) -> Vec<Float<'b>>,
    ) -> Vec<Signal<'b>> {
        self.cubature_by(nodes, inputs, ranges, function)
    }

    /// The same for two signals whose function is not near a quadratic: 24 nodes instead of 7.
    pub fn fine_cubature(
        &mut self,
        inputs: &[Signal<'b>; 2],
        ranges: &[[f32; 2]],
        function: impl Fn(&[Float<'b>]) -> Vec<Float<'b>>,
    ) -> Vec<Signal<'b>> {
        let nodes = |dimensions| match dimensions {
            2 => polar(),
            _ => nodes(dimensions),
        };
        self.cubature_by(nodes, inputs, ranges, function)
    }

    fn cubature_by(
        &mut self,
        nodes: impl Fn(usize) -> Vec<([f32; 4], f32)>,
        inputs: &[Signal<'b>],
        ranges: &[[f32; 2]],
        function: impl Fn(&[Float<'b>]) -> Vec<Float<'b>>,
    ) -> Vec<Signal<'b>> {
        let b = self.b;
        let inputs: Vec<Signal<'b>> = inputs.iter().map(Signal::flat).collect();
        let means: Vec<Float<'b>> = inputs.iter().map(|x| x.mean).collect();
        let uncertain: Vec<usize> = (0..inputs.len())
            .filter(|&i| self.mode.spreads() && !inputs[i].is_certain())
            .collect();
        let results = |arguments: &[Float<'b>]| {
            let values = function(arguments);
            assert_eq!(values.len(), ranges.len(), "results of the function");
            values
        };
        let centre = results(&means);
        if uncertain.is_empty() {
            let signals = centre.into_iter().zip(ranges);
            return signals
                .map(|(value, &range)| Signal::certain(value).with_range(range))
                .collect();
        }
        self.bent = true;
        self.period = None;
        let spread: Vec<Signal<'b>> = uncertain.iter().map(|&i| self.expose(&inputs[i])).collect();
        let triangle = Triangle::of(&spread);
        let plain: Vec<Signal<'b>> = (spread.iter())
            .map(|x| x.clone().with_slope(None))
            .collect();
        let rows: Vec<([f32; 4], f32, Vec<Float<'b>>)> = (nodes(spread.len()).into_iter())
            .map(|(z, weight)| {
                if z == [0.0; 4] {
                    return (z, weight, centre.clone());
                }
                let mut arguments = means.clone();
                for (row, &i) in triangle.rows.iter().zip(&uncertain) {
                    let steps = row.iter().zip(z).map(|(&l, z)| l * z);
                    arguments[i] = steps.fold(arguments[i], |at, step| at + step);
                }
                (z, weight, results(&arguments))
            })
            .collect();
        let mut out = Vec::with_capacity(ranges.len());
        for (k, &range) in ranges.iter().enumerate() {
            // Of the difference from the centre: a footprint of 0 gives the value.
            let beyond = |values: &[Float<'b>]| values[k] - centre[k];
            let parts = rows.iter().map(|(_, weight, f)| beyond(f) * *weight);
            let mean = b.sum(parts);
            let mut slopes: Vec<Float<'b>> = (0..spread.len())
                .map(|j| {
                    b.sum(
                        rows.iter()
                            .map(|(z, weight, f)| beyond(f) * (weight * z[j])),
                    )
                })
                .collect();
            let distortion = b.sum(rows.iter().map(|(z, weight, f)| {
                let lines = slopes.iter().zip(z).map(|(&slope, &z)| slope * z);
                let residual = lines.fold(beyond(f) - mean, |residual, line| residual - line);
                residual.square() * *weight
            }));
            // β = L⁻ᵀ a: the coefficients of the inputs themselves.
            let mut signal = Signal::constant(b, 0.0);
            let mut lines = Vec::new();
            for j in (0..spread.len()).rev() {
                slopes[j] *= triangle.inverses[j];
                for i in 0..j {
                    let part = triangle.rows[j][i] * slopes[j];
                    slopes[i] -= part;
                }
                signal = signal + plain[j].scale(slopes[j]);
                lines.push((&spread[j], slopes[j]));
            }
            signal.mean = centre[k] + mean;
            signal.range = range;
            if range[0].is_finite() && range[1].is_finite() {
                signal.mean = signal.mean.clamp(range[0], range[1]);
            }
            self.attach_fresh(&mut signal, distortion);
            if self.derives() {
                signal.slope = self.slopes_of_linear(&lines, distortion);
            }
            out.push(signal);
        }
        out
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
