//! Products of signals.

use crate::ir::{Float, SharedFunction, Sym2, Vec2};

use super::{
    Algebra, Mode, Signal,
    signal::{PARTS, UNBOUNDED, symbols_of},
};
use smallvec::SmallVec;

impl<'b> Algebra<'b> {
    /// `X · Y` (Isserlis): mean m_X m_Y + cov, coefficients m_Y·x + m_X·y, second order
    /// m_Y H_X + m_X H_Y + x yᵀ + y xᵀ; what is left of Var = … + var_X var_Y + cov² joins a fresh ε.
    /// Exact in mean, variance and covariance with Gaussians, for Gaussian operands.
    pub fn product(&mut self, x: &Signal<'b>, y: &Signal<'b>) -> Signal<'b> {
        // Where nothing spreads, a position is certain as well: it keeps its cell.
        let keeps = x.cell.is_some() && y.is_certain();
        if x.is_certain() && !keeps {
            return y * x.flat_mean();
        }
        if y.is_certain() {
            return x * y.flat_mean();
        }
        self.bent = true;
        let (x, y) = (&self.held(x), &self.held(y));
        let second = self.mode == Mode::Quad;
        let of = SharedFunction {
            name: "product",
            variant: u32::from(second),
            doc: "The product of two signals, without their shared symbols.",
        };
        let mut inputs = named(X, x);
        inputs.extend(named(Y, y));
        inputs.extend([
            ("x_shared", x.shared_variance()),
            ("y_shared", y.shared_variance()),
            ("common", x.shared_covariance(y)),
        ]);
        let [parts @ .., remainder] = self.b.shared(of, &inputs, |_, v| {
            let (x, y) = (of_parts(v), of_parts(&v[PARTS..]));
            let [shared_x, shared_y, common] = v[2 * PARTS..] else {
                panic!("what symbols share")
            };
            let (product, remainder) = multiplied(&x, &y, [shared_x, shared_y, common], second);
            results(&product, ("remainder", remainder))
        });
        let mut out = Signal::of_parts(parts);
        for symbol in symbols_of(&[x, y]) {
            let [c, d] = [x, y].map(|signal| signal.coefficient_or_zero(symbol));
            out.push_shared(symbol, c * y.mean + d * x.mean);
        }
        out.range = x.range_of_product(y);
        out.binary = product_binary(x, y);
        self.attach_fresh(&mut out, remainder);
        if let (true, Some(p), Some(q)) = (self.derives(), x.slopes(), y.slopes()) {
            out.slope = Some(self.bilinear(&[(y, &p), (x, &q)]));
        }
        out
    }

    /// The signal with its mean as one number; where its slopes are to meet it again, exposed.
    pub(super) fn held(&mut self, x: &Signal<'b>) -> Signal<'b> {
        if self.derives() && x.slope.is_some() {
            return self.expose(&x.flat());
        }
        x.flat()
    }

    /// `X + M (Y − X)`: the product rule for M (Y − X) with all that it shares with X, whose private
    /// variance passes with (1 − m)². Exact where the product is.
    pub fn mix(&mut self, x: &Signal<'b>, y: &Signal<'b>, mask: &Signal<'b>) -> Signal<'b> {
        if mask.is_certain() || !self.mode.spreads() {
            let by = mask.flat_mean();
            return match by.as_constant() {
                Some(0.0) => x.clone(),
                Some(1.0) => y.clone(),
                _ if !self.mode.spreads() => x + (y - x) * by,
                _ => x * (1.0 - by) + y * by,
            };
        }
        self.bent = true;
        let (x, y, mask) = (&self.held(x), &self.held(y), &self.held(mask));

        // Of each symbol: the coefficients of X, of Y − X and of M.
        let symbols = symbols_of(&[x, y, mask]);
        let coefficients: SmallVec<[[Float<'b>; 3]; 8]> = (symbols.iter())
            .map(|&symbol| {
                let [c, d, e] = [x, y, mask].map(|signal| signal.coefficient_or_zero(symbol));
                [c, d - c, e]
            })
            .collect();
        let squares = coefficients.iter().map(|[_, across, _]| across.square());
        let products = coefficients.iter().map(|&[_, across, e]| across * e);
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
            ("shared_across", self.b.sum(squares)),
            ("shared_mask", mask.shared_variance()),
            ("common", self.b.sum(products)),
        ]);
        let [parts @ .., remainder, across] = self.b.shared(of, &inputs, |_, v| {
            let [x, y, mask] = [0, 1, 2].map(|i| of_parts(&v[i * PARTS..]));
            let shared = [0, 1, 2].map(|i| v[3 * PARTS + i]);
            let (mixed, remainder, across) = mixed(&x, &y, &mask, shared, second);
            let [parts @ .., remainder] = results(&mixed, ("remainder", remainder));
            let [mean, gx, gy, hxx, hxy, hyy, private] = parts;
            let across = ("across", across);
            [mean, gx, gy, hxx, hxy, hyy, private, remainder, across]
        });
        let mut out = Signal::of_parts(parts);
        for (&symbol, &[c, d, e]) in symbols.iter().zip(&coefficients) {
            out.push_shared(symbol, c + (d * mask.mean + e * across));
        }
        if mask.range[0] >= 0.0 && mask.range[1] <= 1.0 {
            out.range = [x.range[0].min(y.range[0]), x.range[1].max(y.range[1])];
        }
        self.attach_fresh(&mut out, remainder);
        if let (true, Some(p), Some(q), Some(r)) =
            (self.derives(), x.slopes(), y.slopes(), mask.slopes())
        {
            let across = y - x;
            let difference = [0, 1].map(|i| &q[i] - &p[i]);
            let one = Signal::constant(self.b, 1.0);
            let terms = [(&one, &*p), (mask, &difference), (&across, &*r)];
            out.slope = Some(self.bilinear(&terms));
        }
        out
    }
}

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
type Inputs<'b> = SmallVec<[(&'static str, Float<'b>); 24]>;

fn named<'b>(names: [&'static str; PARTS], signal: &Signal<'b>) -> Inputs<'b> {
    names.into_iter().zip(signal.parts()).collect()
}

/// The signal of the parts that come first.
fn of_parts<'b>(values: &[Float<'b>]) -> Signal<'b> {
    Signal::of_parts(*values.first_chunk().expect("a signal's parts"))
}

/// The named results of a shared function: a signal's parts, and one more.
fn results<'b>(
    signal: &Signal<'b>,
    last: (&'static str, Float<'b>),
) -> [(&'static str, Float<'b>); PARTS + 1] {
    let [mean, gx, gy, hxx, hxy, hyy, private] = signal.parts();
    [
        ("mean", mean),
        ("gx", gx),
        ("gy", gy),
        ("hxx", hxx),
        ("hxy", hxy),
        ("hyy", hyy),
        ("private", private),
        last,
    ]
}

/// The mix without what shared symbols give; the variance of a fresh ε, and the mean of Y − X.
fn mixed<'b>(
    x: &Signal<'b>,
    y: &Signal<'b>,
    mask: &Signal<'b>,
    shared: [Float<'b>; 3],
    second: bool,
) -> (Signal<'b>, Float<'b>, Float<'b>) {
    let across = y - x;
    let (part, remainder) = multiplied(&across, mask, shared, second);
    // Of X's private variance 1 − m passes, of Y's m, of the mask's the difference of the means.
    let [rest, share, height] = [1.0 - mask.mean, mask.mean, across.mean].map(Float::square);
    let out = Signal {
        mean: x.mean + part.mean,
        g: x.g + part.g,
        h: x.h + part.h,
        private: x.private * rest + y.private * share + mask.private * height,
        ..x.clone()
    };
    (out, remainder, across.mean)
}

/// The product without what shared symbols give, and the variance of a fresh ε; `shared_x` and
/// `shared_y` are the variances of shared symbols, `common` their covariance.
fn multiplied<'b>(
    x: &Signal<'b>,
    y: &Signal<'b>,
    [shared_x, shared_y, common]: [Float<'b>; 3],
    second: bool,
) -> (Signal<'b>, Float<'b>) {
    let covariance = x.covariance(y);
    let linear = covariance.linear;
    let beyond = covariance.rest + common;
    let mut out = x * y.mean + y * x.mean;
    // Both products held the full mean: m_X m_Y twice.
    out.mean = x.mean * y.mean + (linear + beyond);

    // var_X var_Y + cov², less what the second order carries: |x|²|y|² + (x·y)².
    let (vx, vy) = (x.linear_variance(), y.linear_variance());
    let (rx, ry) = (x.other_variance() + shared_x, y.other_variance() + shared_y);
    let rest = (vx * ry + rx * vy + rx * ry) + beyond * (linear * 2.0 + beyond);
    let rest = rest.max(0.0);
    if second {
        let (Vec2([x1, x2]), Vec2([y1, y2])) = (x.g, y.g);
        let (p, q) = (x1 * y1, x2 * y2);
        out.h = out.h + Sym2([p + p, x1 * y2 + x2 * y1, q + q]);
        return (out, rest);
    }
    (out, rest + (vx * vy + linear.square()))
}

/// The two values of the product of two waves between −p and p, −q and q: ±pq.
fn product_binary<'b>(x: &Signal<'b>, y: &Signal<'b>) -> Option<[Float<'b>; 2]> {
    let amplitude = |signal: &Signal<'b>| {
        let [low, high] = signal.binary?.map(|v| v.as_constant());
        (low? == -high?).then_some(high?)
    };
    let product = amplitude(x)? * amplitude(y)?;
    Some([-product, product].map(|v| x.mean.literal(v)))
}

impl Signal<'_> {
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
