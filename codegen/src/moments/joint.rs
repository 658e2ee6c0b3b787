//! Fresh parts that several signals share: a covariance matrix as a factor.

use super::{Algebra, Signal};
use crate::ir::Float;

impl<'b> Algebra<'b> {
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
    pub fn attach_joint(&mut self, signals: &mut [Signal<'b>], covariance: &[Float<'b>]) {
        let n = signals.len();
        assert_eq!(covariance.len(), n * (n + 1) / 2, "entries of a triangle");
        for (k, column) in factor(n, covariance).iter().enumerate() {
            if k + 1 == n {
                // The last number is the last signal's own.
                self.attach_fresh(&mut signals[k], column[0].square());
                continue;
            }
            if column.iter().all(|entry| entry.is_zero()) {
                continue;
            }
            let symbol = self.fresh_symbol();
            for (signal, &entry) in signals[k..].iter_mut().zip(column) {
                if !entry.is_zero() {
                    signal.push_shared(symbol, entry);
                }
            }
        }
    }
}

/// The columns of the factor, each from its diagonal down.
fn factor<'b>(n: usize, covariance: &[Float<'b>]) -> Vec<Vec<Float<'b>>> {
    let entry = |i: usize, k: usize| covariance[i * (i + 1) / 2 + k];
    // What is left of each variance.
    let mut left: Vec<Float<'b>> = (0..n).map(|i| entry(i, i).max(0.0)).collect();
    let mut columns: Vec<Vec<Float<'b>>> = Vec::new();
    for k in 0..n {
        let pivot = left[k].sqrt();
        let mut column = vec![pivot];
        // A pivot below the rounding of its variance says nothing of the others.
        let sound = left[k].gt(entry(k, k).max(0.0) * 1e-6 + 1e-30);
        let divisor = sound.select(pivot, 1.0);
        for i in k + 1..n {
            let mut sum = entry(i, k);
            for (j, other) in columns.iter().enumerate() {
                sum -= other[i - j] * other[k - j];
            }
            let most = left[i].sqrt();
            let limited = sound.select((sum / divisor).clamp(-most, most), 0.0);
            column.push(limited);
            left[i] = (left[i] - limited.square()).max(0.0);
        }
        columns.push(column);
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cpu::{Evaluator, Input, Scratch};
    use crate::ir::{Builder, Module};
    use crate::moments::Mode;

    /// The covariance that three signals have after the matrix was attached to them.
    fn attached(matrix: [f32; 6]) -> Vec<f64> {
        let b = &Builder::new("f", "A test.");
        let entries: Vec<Float<'_>> = (0..6).map(|i| b.float_param(format!("c{i}"))).collect();
        let mut signals = [0, 1, 2].map(|_| Signal::constant(b, 0.0));
        Algebra::new(b, Mode::Local).attach_joint(&mut signals, &entries);
        for i in 0..3 {
            for k in 0..=i {
                let value = if i == k {
                    signals[i].variance()
                } else {
                    signals[i].covariance(&signals[k]).total
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
