//! The field of a filtered source, and the signal that it is at a position with a spread.

use mipless_codegen::ir::{Builder, SharedFunction, Value};
use mipless_codegen::moments::{Mode, Signal};
use mipless_codegen::{Lower, PartNames};

/// The names of a position's parts as parameters of rules.
pub(crate) const X: PartNames = [
    "cell_x",
    "x",
    "x_gx",
    "x_gy",
    "x_hxx",
    "x_hxy",
    "x_hyy",
    "x_private",
];
/// The same of its second coordinate.
pub(crate) const Y: PartNames = [
    "cell_y",
    "y",
    "y_gx",
    "y_gy",
    "y_hxx",
    "y_hxy",
    "y_hyy",
    "y_private",
];

/// The covariance of a position within the footprint, in squared units of the position.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spread {
    /// Σ₁₁, Σ₁₂, Σ₂₂.
    pub(crate) covariance: [Value; 3],
    /// The eigenvalues of Σ, the larger first, at least 0.
    pub(crate) eigenvalues: [Value; 2],
}

/// Positions spread over more than this are spread over it: every noise is gone long before.
const WIDEST: f32 = 1.0e4;

impl Spread {
    /// Of a position (x, y); zero where signals carry none.
    pub(crate) fn of(b: &mut Builder, position: &[Signal]) -> Self {
        let [x, y] = position else {
            panic!("a position has two coordinates")
        };
        let of = |variant| SharedFunction {
            name: "spread",
            variant,
            doc: "The covariance of a position, limited, and its eigenvalues.",
        };
        let [xx, xy, yy, major, minor] = if x.shared.is_empty() && y.shared.is_empty() {
            let parts = |names: PartNames, signal: &Signal| {
                let ([gx, gy], [hxx, hxy, hyy]) = (signal.g, signal.h);
                let parts = [gx, gy, hxx, hxy, hyy, signal.private];
                [2, 3, 4, 5, 6, 7].map(|i| (names[i], parts[i - 2]))
            };
            let inputs = [parts(X, x), parts(Y, y)];
            b.shared(of(1), inputs.as_flattened(), |b, v| {
                let zero = b.f32(0.0);
                let [x, y] = [0, 6].map(|i| Signal {
                    g: [v[i], v[i + 1]],
                    h: [v[i + 2], v[i + 3], v[i + 4]],
                    private: v[i + 5],
                    ..Signal::certain(b, zero)
                });
                limited(b, &x, &y)
            })
        } else {
            let (vx, vy) = (x.variance(b), y.variance(b));
            let covariance = x.covariance(b, y).total;
            let inputs = [("xx", vx), ("xy", covariance), ("yy", vy)];
            b.shared(of(0), &inputs, |b, v| limits(b, [v[0], v[1], v[2]]))
        };
        Self {
            covariance: [xx, xy, yy],
            eigenvalues: [major, minor],
        }
    }
}

/// The covariance of two signals, no larger than the widest, and its eigenvalues.
fn limited(b: &mut Builder, x: &Signal, y: &Signal) -> [(&'static str, Value); 5] {
    let (vx, vy) = (x.variance(b), y.variance(b));
    let covariance = x.covariance(b, y).total;
    limits(b, [vx, covariance, vy])
}

/// A covariance, no larger than the widest, and its eigenvalues.
fn limits(b: &mut Builder, covariance: [Value; 3]) -> [(&'static str, Value); 5] {
    let [vx, _, vy] = covariance;
    let limit = b.f32(WIDEST * WIDEST);
    // One factor for all three keeps the shape.
    let largest = b.max(vx, vy);
    let largest = b.max(largest, limit);
    let factor = b.div(limit, largest);
    let [xx, xy, yy] = covariance.map(|v| b.mul(v, factor));
    let (sum, difference) = (b.add(xx, yy), b.sub(xx, yy));
    let (half, tilt) = (b.scale(sum, 0.5), b.scale(difference, 0.5));
    let square = b.dot(&[tilt, xy], &[tilt, xy]);
    let root = b.sqrt(square);
    let zero = b.f32(0.0);
    let (more, less) = (b.add(half, root), b.sub(half, root));
    let minor = b.max(less, zero);
    [
        ("xx", xx),
        ("xy", xy),
        ("yy", yy),
        ("major", more),
        ("minor", minor),
    ]
}

/// A source filtered by the footprint, in units of its position; what is not carried is 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Field {
    /// M.
    pub(crate) mean: Value,
    /// ∇M.
    pub(crate) gradient: [Value; 2],
    /// Hess M: 11, 12, 22.
    pub(crate) hessian: [Value; 3],
    /// The variance that the filter removed beyond what the mode carries.
    pub(crate) rest: Value,
}

impl Field {
    /// The signal of the field at a position with coefficients: g = Jᵀ∇M, H = Jᵀ Hess(M) J +
    /// Σ ∂_i M H_i, the position's own symbols through ∇M, and the rest as a fresh ε.
    pub(crate) fn at(&self, lower: &mut Lower<'_>, position: &[Signal]) -> Signal {
        let [x, y] = position else {
            panic!("a position has two coordinates")
        };
        let mode = lower.mode();
        let b = lower.b();
        let mut signal = Signal::certain(b, self.mean);
        if matches!(mode, Mode::Local | Mode::Quad) {
            let [dx, dy] = self.gradient;
            let mut inputs = vec![("dx", dx), ("dy", dy)];
            for axis in [x, y] {
                inputs.extend([
                    ("gx", axis.g[0]),
                    ("gy", axis.g[1]),
                    ("private", axis.private),
                ]);
            }
            let second = mode == Mode::Quad;
            if second {
                inputs.extend(self.hessian.map(|h| ("bend", h)));
                for axis in [x, y] {
                    inputs.extend(axis.h.map(|h| ("h", h)));
                }
            }
            let of = SharedFunction {
                name: "response",
                variant: u32::from(second),
                doc: "The response of a field to its position.",
            };
            let [gx, gy, hxx, hxy, hyy, private] = b.shared(of, &inputs, response);
            signal.g = [gx, gy];
            signal.h = [hxx, hxy, hyy];
            signal.private = private;
            if !(x.shared.is_empty() && y.shared.is_empty()) {
                // The position's own symbols.
                let (of_x, of_y) = (x.scale(b, dx), y.scale(b, dy));
                signal.shared = of_x.add(b, &of_y).shared;
            }
        }
        lower.algebra.attach_fresh(&mut signal, self.rest);
        signal
    }
}

/// g, H and the private variance of a field by its derivatives and the coordinates'.
fn response(b: &mut Builder, v: &[Value]) -> [(&'static str, Value); 6] {
    let [dx, dy, xx, xy, x_private, yx, yy, y_private, second @ ..] = v else {
        panic!("derivatives and two coordinates")
    };
    let gradient = [*dx, *dy];
    let [gx, gy] = [[*xx, *yx], [*xy, *yy]].map(|column| b.dot(&gradient, &column));
    let squares = gradient.map(|d| b.square(d));
    let private = b.dot(&squares, &[*x_private, *y_private]);
    let mut h = [b.f32(0.0); 3];
    if let [h11, h12, h22, of_x @ .., _, _, _] = second {
        let of_y = &second[6..];
        // Columns of J: the response of (x, y) to δ₁ and to δ₂.
        let columns = [[*xx, *yx], [*xy, *yy]];
        for (k, (i, j)) in [(0, 0), (0, 1), (1, 1)].into_iter().enumerate() {
            let left = b.dot(&[*h11, *h12], &columns[j]);
            let right = b.dot(&[*h12, *h22], &columns[j]);
            let bent = b.dot(&columns[i], &[left, right]);
            let own = b.dot(&gradient, &[of_x[k], of_y[k]]);
            h[k] = b.add(own, bent);
        }
    }
    [
        ("gx", gx),
        ("gy", gy),
        ("hxx", h[0]),
        ("hxy", h[1]),
        ("hyy", h[2]),
        ("private", private),
    ]
}
