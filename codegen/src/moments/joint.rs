//! Fresh parts that several signals share: a covariance matrix as a factor.

use super::{Algebra, Signal};
use crate::ir::{Builder, Value};

impl Algebra {
    /// Adds correlated fresh parts to the signals: `covariance` holds the rows of the lower
    /// triangle of their covariance matrix, 11, 21, 22, 31, 32, 33, ….
    ///
    /// Signal i gets Σ_k L_ik ε_k with L Lᵀ the matrix. The factor is made so that it exists for any
    /// matrix: each entry is limited to what the rest of its row leaves of the variance, so that the
    /// variances are always those of the diagonal (negative ones are 0), and covariances are right
    /// wherever the matrix is positive semi-definite. Clamping pivots instead is off by up to
    /// 8·10⁴ roundings (MATH §9).
    ///
    /// # Panics
    /// If the numbers of signals and of entries do not fit.
    pub fn attach_joint(&mut self, signals: &mut [Signal], covariance: &[Value]) {
        let n = signals.len();
        assert_eq!(covariance.len(), n * (n + 1) / 2, "entries of a triangle");
        let factor = factor(&mut self.b, n, covariance);
        for (k, column) in factor.iter().enumerate() {
            if k + 1 == n {
                // The last number is the last signal's own.
                let variance = self.b.square(column[0]);
                self.attach_fresh(&mut signals[k], variance);
                continue;
            }
            if column.iter().all(|&entry| self.b.is_zero(entry)) {
                continue;
            }
            let symbol = self.fresh_symbol();
            for (signal, &entry) in signals[k..].iter_mut().zip(column) {
                if !self.b.is_zero(entry) {
                    signal.push_shared(symbol, entry);
                }
            }
        }
    }
}

/// The columns of the factor, each from its diagonal down.
fn factor(b: &mut Builder, n: usize, covariance: &[Value]) -> Vec<Vec<Value>> {
    let zero = b.f32(0.0);
    let entry = |i: usize, k: usize| covariance[i * (i + 1) / 2 + k];
    // What is left of each variance.
    let mut left: Vec<Value> = (0..n).map(|i| b.max(entry(i, i), zero)).collect();
    let mut columns: Vec<Vec<Value>> = Vec::new();
    for k in 0..n {
        let pivot = b.sqrt(left[k]);
        let mut column = vec![pivot];
        // A pivot below the rounding of its variance says nothing of the others.
        let variance = b.max(entry(k, k), zero);
        let floor = b.scale(variance, 1e-6);
        let floor = b.offset(floor, 1e-30);
        let sound = b.lt(floor, left[k]);
        let one = b.f32(1.0);
        let divisor = b.select(sound, pivot, one);
        for i in k + 1..n {
            let mut sum = entry(i, k);
            for (j, other) in columns.iter().enumerate() {
                let product = b.mul(other[i - j], other[k - j]);
                sum = b.sub(sum, product);
            }
            let quotient = b.div(sum, divisor);
            let most = b.sqrt(left[i]);
            let least = b.neg(most);
            let limited = b.max(quotient, least);
            let limited = b.min(limited, most);
            let limited = b.select(sound, limited, zero);
            column.push(limited);
            let square = b.square(limited);
            let rest = b.sub(left[i], square);
            left[i] = b.max(rest, zero);
        }
        columns.push(column);
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cpu::{Evaluator, Input, Scratch};
    use crate::ir::Module;
    use crate::moments::Mode;

    /// The covariance that three signals have after the matrix was attached to them.
    fn attached(matrix: [f32; 6]) -> Vec<f64> {
        let mut b = Builder::new("f", "A test.");
        let parameters: Vec<Value> = (0..6).map(|i| b.param_f32(format!("c{i}"))).collect();
        let mut algebra = Algebra::new(b, Mode::Local);
        let mut signals: Vec<Signal> = (0..3)
            .map(|_| Signal::constant(&mut algebra.b, 0.0))
            .collect();
        algebra.attach_joint(&mut signals, &parameters);
        let mut b = algebra.b;
        for i in 0..3 {
            for k in 0..=i {
                let value = if i == k {
                    signals[i].variance(&mut b)
                } else {
                    signals[i].covariance(&mut b, &signals[k]).total
                };
                b.result(format!("r{i}{k}"), value);
            }
        }
        let mut module = Module::default();
        b.finish(&mut module);
        let inputs: Vec<[f32; 1]> = matrix.map(|x| [x]).to_vec();
        let inputs: Vec<Input<'_>> = inputs.iter().map(|x| Input::Floats(x)).collect();
        let mut out = Vec::new();
        Evaluator::<f32>::new(&module).evaluate(&mut Scratch::new(), &inputs, 1, &mut out);
        out.iter().map(|column| f64::from(column[0])).collect()
    }

    fn near(found: &[f64], wanted: [f32; 6], tolerance: f64) {
        for (found, wanted) in found.iter().zip(wanted) {
            let wanted = f64::from(wanted);
            assert!((found - wanted).abs() <= tolerance, "{found} for {wanted}");
        }
    }

    #[test]
    fn a_covariance_comes_back() {
        let full = [1.0, 0.5, 2.0, -0.3, 0.4, 0.5];
        near(&attached(full), full, 1e-6);
        // Of rank 1, and of rank 2 with a first variance of 0.
        let grey = [0.25, 0.5, 1.0, 0.125, 0.25, 0.0625];
        near(&attached(grey), grey, 1e-6);
        let without = [0.0, 0.0, 2.0, 0.0, 1.0, 1.0];
        near(&attached(without), without, 1e-6);
    }

    #[test]
    fn variances_survive_a_matrix_that_is_none() {
        let wrong = [1e-12, 1.0, 1.0, -1.0, 5.0, 1e-3];
        let found = attached(wrong);
        near(
            &[found[0], found[2], found[5]],
            [1e-12, 1.0, 1e-3, 0.0, 0.0, 0.0],
            1e-6,
        );
        assert!(found.iter().all(|x| x.is_finite()));
        let negative = attached([-1.0, 0.5, -1e-9, 0.0, 0.0, 0.0]);
        near(&negative, [0.0; 6], 1e-6);
    }
}
