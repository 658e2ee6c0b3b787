//! Products of signals.

use crate::ir::{Builder, SharedFunction, Value};

use super::{Algebra, Mode, Signal, Symbol, signal::UNBOUNDED};
use smallvec::SmallVec;

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
        let mut inputs = named(X, x);
        inputs.extend(named(Y, y));
        inputs.extend([
            ("x_shared", shared_x),
            ("y_shared", shared_y),
            ("common", common),
        ]);
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
        out.range = x.range_of_product(y);
        out.binary = product_binary(b, x, y);
        self.attach_fresh(&mut out, remainder);
        out
    }
}

/// How many values are a signal's own: the mean, g, H and the private variance.
const PARTS: usize = 7;
const X: [&str; PARTS] = [
    "x_mean",
    "x_gx",
    "x_gy",
    "x_hxx",
    "x_hxy",
    "x_hyy",
    "x_private",
];
const Y: [&str; PARTS] = [
    "y_mean",
    "y_gx",
    "y_gy",
    "y_hxx",
    "y_hxy",
    "y_hyy",
    "y_private",
];
const M: [&str; PARTS] = [
    "m_mean",
    "m_gx",
    "m_gy",
    "m_hxx",
    "m_hxy",
    "m_hyy",
    "m_private",
];

/// The named arguments of a shared function for the parts of a signal.
type Inputs = SmallVec<[(&'static str, Value); 24]>;

fn named(names: [&'static str; PARTS], signal: &Signal) -> Inputs {
    let [gx, gy] = signal.g;
    let [hxx, hxy, hyy] = signal.h;
    let parts = [signal.mean, gx, gy, hxx, hxy, hyy, signal.private];
    names.into_iter().zip(parts).collect()
}

/// The signal of these parts.
fn of_parts(b: &mut Builder, v: &[Value]) -> Signal {
    Signal {
        g: [v[1], v[2]],
        h: [v[3], v[4], v[5]],
        private: v[6],
        ..Signal::certain(b, v[0])
    }
}

impl Algebra {
    /// `X + M (Y − X)`: the product rule for M (Y − X) with all that it shares with X, whose private
    /// variance passes with (1 − m)². Exact where the product is.
    pub fn mix(&mut self, x: &Signal, y: &Signal, mask: &Signal) -> Signal {
        let b = &mut self.b;
        if mask.is_certain(b) || !self.mode.spreads() {
            let by = mask.flat_mean(b);
            match b.as_constant(by) {
                Some(0.0) => return x.clone(),
                Some(1.0) => return y.clone(),
                _ => {}
            }
            if !self.mode.spreads() {
                let part = y.sub(b, x).scale(b, by);
                return x.add(b, &part);
            }
            let one = b.f32(1.0);
            let rest = b.sub(one, by);
            let (of_x, of_y) = (x.scale(b, rest), y.scale(b, by));
            return of_x.add(b, &of_y);
        }
        self.bent = true;
        let (x, y, mask) = (&x.flat(b), &y.flat(b), &mask.flat(b));
        let zero = b.f32(0.0);
        let mut symbols: SmallVec<[Symbol; 8]> = (x.shared.iter())
            .chain(&y.shared)
            .chain(&mask.shared)
            .map(|&(symbol, _)| symbol)
            .collect();
        symbols.sort_unstable();
        symbols.dedup();
        let [mut shared_across, mut common] = [zero; 2];
        let coefficients: SmallVec<[[Value; 3]; 8]> = (symbols.iter())
            .map(|&symbol| {
                let [c, d, e] = [x, y, mask].map(|s| s.coefficient(symbol).unwrap_or(zero));
                let across = b.sub(d, c);
                let square = b.square(across);
                shared_across = b.add(shared_across, square);
                let product = b.mul(across, e);
                common = b.add(common, product);
                [c, across, e]
            })
            .collect();
        let shared_mask = mask.shared_variance(b);
        let second = self.mode == Mode::Quad;
        let of = SharedFunction {
            name: "mix",
            variant: u32::from(second),
            doc: "A mix of two signals by a third, without their shared symbols.",
        };
        let mut inputs = named(X, x);
        inputs.extend(named(Y, y));
        inputs.extend(named(M, mask));
        inputs.extend([
            ("shared_across", shared_across),
            ("shared_mask", shared_mask),
            ("common", common),
        ]);
        let [mean, gx, gy, hxx, hxy, hyy, private, remainder, across] =
            b.shared(of, &inputs, |b, v| mixed(b, v, second));
        let mut out = Signal {
            g: [gx, gy],
            h: [hxx, hxy, hyy],
            private,
            ..Signal::certain(b, mean)
        };
        for (&symbol, &[c, d, e]) in symbols.iter().zip(&coefficients) {
            let part = b.dot(&[d, e], &[mask.mean, across]);
            let coefficient = b.add(c, part);
            out.push_shared(symbol, coefficient);
        }
        if mask.range[0] >= 0.0 && mask.range[1] <= 1.0 {
            out.range = [x.range[0].min(y.range[0]), x.range[1].max(y.range[1])];
        }
        self.attach_fresh(&mut out, remainder);
        out
    }
}

/// The mix without what shared symbols give; the remainder is the variance of a fresh ε, the last
/// result is the mean of Y − X.
fn mixed(b: &mut Builder, inputs: &[Value], second: bool) -> [(&'static str, Value); 9] {
    let x = of_parts(b, &inputs[..PARTS]);
    let y = of_parts(b, &inputs[PARTS..2 * PARTS]);
    let (mask, shared) = inputs[2 * PARTS..].split_at(PARTS);
    let across = y.sub(b, &x);
    let mut operands: SmallVec<[Value; 24]> =
        named(X, &across).into_iter().map(|(_, v)| v).collect();
    operands.extend_from_slice(mask);
    operands.extend_from_slice(shared);
    let [mean, gx, gy, hxx, hxy, hyy, _, remainder] = multiplied(b, &operands, second);
    // Of X's private variance 1 − m passes, of Y's m, of the mask's the difference of the means.
    let one = b.f32(1.0);
    let rest = b.sub(one, mask[0]);
    let [rest, share, height] = [rest, mask[0], across.mean].map(|v| b.square(v));
    let private = b.dot(
        &[x.private, y.private, mask[PARTS - 1]],
        &[rest, share, height],
    );
    [
        ("mean", b.add(x.mean, mean.1)),
        ("gx", b.add(x.g[0], gx.1)),
        ("gy", b.add(x.g[1], gy.1)),
        ("hxx", b.add(x.h[0], hxx.1)),
        ("hxy", b.add(x.h[1], hxy.1)),
        ("hyy", b.add(x.h[2], hyy.1)),
        ("private", private),
        remainder,
        ("across", across.mean),
    ]
}

/// The product without what shared symbols give; the remainder is the variance of a fresh ε.
fn multiplied(b: &mut Builder, inputs: &[Value], second: bool) -> [(&'static str, Value); 8] {
    let (x, y) = (of_parts(b, &inputs[..PARTS]), of_parts(b, &inputs[PARTS..]));
    let [shared_x, shared_y, common] = inputs[2 * PARTS..] else {
        panic!("what symbols share")
    };
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

impl Signal {
    /// The bounds of the product with another signal.
    pub fn range_of_product(&self, other: &Self) -> [f32; 2] {
        let (x, y) = (self.range, other.range);
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
}
