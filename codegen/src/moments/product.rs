//! Products of signals.

use crate::ir::{Builder, Value};

use super::{Algebra, Mode, Signal, signal::UNBOUNDED};

impl Algebra {
    /// `X · Y` (Isserlis): mean m_X m_Y + cov, coefficients m_Y·x + m_X·y, second order
    /// m_Y H_X + m_X H_Y + x yᵀ + y xᵀ; what is left of Var = … + var_X var_Y + cov² joins a fresh ε.
    /// Exact in mean, variance and covariance with Gaussians, for Gaussian operands.
    pub fn product(&mut self, x: &Signal, y: &Signal) -> Signal {
        let b = &mut self.b;
        // Where nothing spreads, a position is certain as well: it keeps its cell.
        let keeps = x.cell.is_some() && y.is_certain(b);
        if x.is_certain(b) && !keeps {
            let by = x.flat_mean(b);
            return y.scale(b, by);
        }
        if y.is_certain(b) {
            let by = y.flat_mean(b);
            return x.scale(b, by);
        }
        self.bent = true;
        let (x, y) = (&x.flat(b), &y.flat(b));
        let covariance = x.covariance(b, y);
        let linear = {
            let (of_x, of_y) = (x.scale(b, y.mean), y.scale(b, x.mean));
            let mut sum = of_x.add(b, &of_y);
            // Both products held the full mean: m_X m_Y twice.
            let mean = b.mul(x.mean, y.mean);
            sum.mean = b.add(mean, covariance.total);
            sum
        };
        let mut out = linear;
        let (vx, vy) = (x.linear_variance(b), y.linear_variance(b));
        let (rx, ry) = (x.other_variance(b), y.other_variance(b));
        // var_X var_Y + cov², less what the second order carries: |x|²|y|² + (x·y)².
        let (both, left, right) = (b.mul(rx, ry), b.mul(vx, ry), b.mul(rx, vy));
        let rest = b.add(left, right);
        let rest = b.add(rest, both);
        let twice = b.scale(covariance.linear, 2.0);
        let twice = b.add(twice, covariance.rest);
        let cross = b.mul(covariance.rest, twice);
        let rest = b.add(rest, cross);
        let zero = b.f32(0.0);
        let rest = b.max(rest, zero);
        let (v, c) = (b.mul(vx, vy), b.square(covariance.linear));
        let second = b.add(v, c);
        let remainder = if self.mode == Mode::Quad {
            let [x1, x2] = x.g;
            let [y1, y2] = y.g;
            let (p, q) = (b.mul(x1, y1), b.mul(x2, y2));
            let (r, s) = (b.mul(x1, y2), b.mul(x2, y1));
            let outer = [b.add(p, p), b.add(r, s), b.add(q, q)];
            for (h, o) in out.h.iter_mut().zip(outer) {
                *h = b.add(*h, o);
            }
            rest
        } else {
            b.add(rest, second)
        };
        out.range = product_range(x.range, y.range);
        out.binary = product_binary(b, x, y);
        self.attach_fresh(&mut out, remainder);
        out
    }
}

/// The two values of the product of two waves between −p and p, −q and q: ±pq.
fn product_binary(b: &mut Builder, x: &Signal, y: &Signal) -> Option<[Value; 2]> {
    let amplitude = |signal: &Signal| {
        let [low, high] = signal.binary?.map(|v| b.as_constant(v));
        (low? == -high?).then_some(high?)
    };
    let product = amplitude(x)? * amplitude(y)?;
    Some([-product, product].map(|v| b.f32(v)))
}

fn product_range(x: [f32; 2], y: [f32; 2]) -> [f32; 2] {
    if x.iter().chain(&y).any(|e| !e.is_finite()) {
        return UNBOUNDED;
    }
    let corners = [x[0] * y[0], x[0] * y[1], x[1] * y[0], x[1] * y[1]];
    corners
        .iter()
        .fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], &c| {
            [low.min(c), high.max(c)]
        })
}
