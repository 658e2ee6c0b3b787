//! Products of signals.

use crate::ir::{Builder, SharedFunction, Value};

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
        let second = self.mode == Mode::Quad;
        let (shared_x, shared_y) = (x.shared_variance(b), y.shared_variance(b));
        let common = x.shared_covariance(b, y);
        let of = SharedFunction {
            name: "product",
            variant: u32::from(second),
            doc: "The product of two signals, without their shared symbols.",
        };
        let inputs = [
            ("x_mean", x.mean),
            ("x_gx", x.g[0]),
            ("x_gy", x.g[1]),
            ("x_hxx", x.h[0]),
            ("x_hxy", x.h[1]),
            ("x_hyy", x.h[2]),
            ("x_private", x.private),
            ("x_shared", shared_x),
            ("y_mean", y.mean),
            ("y_gx", y.g[0]),
            ("y_gy", y.g[1]),
            ("y_hxx", y.h[0]),
            ("y_hxy", y.h[1]),
            ("y_hyy", y.h[2]),
            ("y_private", y.private),
            ("y_shared", shared_y),
            ("common", common),
        ];
        let [mean, gx, gy, hxx, hxy, hyy, private, remainder] =
            b.shared(of, &inputs, |b, v| multiplied(b, v, second));
        let mut out = Signal {
            g: [gx, gy],
            h: [hxx, hxy, hyy],
            private,
            ..Signal::certain(b, mean)
        };
        for (symbol, _) in x.shared.iter().chain(&y.shared) {
            if out.coefficient(*symbol).is_none() {
                let zero = b.f32(0.0);
                let [c, d] = [x, y].map(|signal| signal.coefficient(*symbol).unwrap_or(zero));
                let coefficient = b.dot(&[c, d], &[y.mean, x.mean]);
                out.push_shared(*symbol, coefficient);
            }
        }
        out.range = product_range(x.range, y.range);
        out.binary = product_binary(b, x, y);
        self.attach_fresh(&mut out, remainder);
        out
    }
}

/// The product without what shared symbols give; the remainder is the variance of a fresh ε.
fn multiplied(b: &mut Builder, inputs: &[Value], second: bool) -> [(&'static str, Value); 8] {
    let signal = |b: &mut Builder, v: &[Value]| Signal {
        g: [v[1], v[2]],
        h: [v[3], v[4], v[5]],
        private: v[6],
        ..Signal::certain(b, v[0])
    };
    let (x, y) = (signal(b, &inputs[..8]), signal(b, &inputs[8..16]));
    let (shared_x, shared_y, common) = (inputs[7], inputs[15], inputs[16]);
    let covariance = x.covariance(b, &y);
    let beyond = b.add(covariance.rest, common);
    let total = b.add(covariance.linear, beyond);
    let (of_x, of_y) = (x.scale(b, y.mean), y.scale(b, x.mean));
    let mut out = of_x.add(b, &of_y);
    // Both products held the full mean: m_X m_Y twice.
    let mean = b.mul(x.mean, y.mean);
    out.mean = b.add(mean, total);
    let (vx, vy) = (x.linear_variance(b), y.linear_variance(b));
    let (rx, ry) = (x.other_variance(b), y.other_variance(b));
    let (rx, ry) = (b.add(rx, shared_x), b.add(ry, shared_y));
    // var_X var_Y + cov², less what the second order carries: |x|²|y|² + (x·y)².
    let (both, left, right) = (b.mul(rx, ry), b.mul(vx, ry), b.mul(rx, vy));
    let rest = b.add(left, right);
    let rest = b.add(rest, both);
    let twice = b.scale(covariance.linear, 2.0);
    let twice = b.add(twice, beyond);
    let cross = b.mul(beyond, twice);
    let rest = b.add(rest, cross);
    let zero = b.f32(0.0);
    let rest = b.max(rest, zero);
    let remainder = if second {
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
        let (v, c) = (b.mul(vx, vy), b.square(covariance.linear));
        let carried = b.add(v, c);
        b.add(rest, carried)
    };
    [
        ("mean", out.mean),
        ("gx", out.g[0]),
        ("gy", out.g[1]),
        ("hxx", out.h[0]),
        ("hxy", out.h[1]),
        ("hyy", out.h[2]),
        ("private", out.private),
        ("remainder", remainder),
    ]
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
