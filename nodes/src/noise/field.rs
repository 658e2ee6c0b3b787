//! The field of a filtered source, and the signal that it is at a position with a spread.

use mipless_codegen::ir::{Float, SharedFunction, Sym2, Vec2};
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
pub(crate) struct Spread<'b> {
    /// Σ.
    pub(crate) covariance: Sym2<'b>,
    /// The eigenvalues of Σ, the larger first, at least 0.
    pub(crate) eigenvalues: [Float<'b>; 2],
}

/// Positions spread over more than this are spread over it: every noise is gone long before.
const WIDEST: f32 = 1.0e4;

impl<'b> Spread<'b> {
    /// Of a position (x, y); zero where signals carry none.
    pub(crate) fn of(position: &[Signal<'b>]) -> Self {
        let [x, y] = position else {
            panic!("a position has two coordinates")
        };
        let b = x.mean.builder();
        let of = |variant| SharedFunction {
            name: "spread",
            variant,
            doc: "The covariance of a position, limited, and its eigenvalues.",
        };
        let [xx, xy, yy, major, minor] = if x.shared.is_empty() && y.shared.is_empty() {
            let parts = |[_, _, names @ ..]: PartNames, signal: &Signal<'b>| {
                let ([gx, gy], [hxx, hxy, hyy]) = (signal.g.0, signal.h.0);
                let parts = [gx, gy, hxx, hxy, hyy, signal.private];
                std::array::from_fn::<_, 6, _>(|i| (names[i], parts[i]))
            };
            let inputs = [parts(X, x), parts(Y, y)];
            b.shared(of(1), inputs.as_flattened(), |b, v| {
                let [x, y] = [0, 6].map(|i| Signal {
                    g: Vec2([v[i], v[i + 1]]),
                    h: Sym2([v[i + 2], v[i + 3], v[i + 4]]),
                    private: v[i + 5],
                    ..Signal::constant(b, 0.0)
                });
                limited(covariance(&x, &y))
            })
        } else {
            let Sym2([xx, xy, yy]) = covariance(x, y);
            let inputs = [("xx", xx), ("xy", xy), ("yy", yy)];
            b.shared(of(0), &inputs, |_, v| limited(Sym2([v[0], v[1], v[2]])))
        };
        Self {
            covariance: Sym2([xx, xy, yy]),
            eigenvalues: [major, minor],
        }
    }
}

/// The covariance matrix of two signals.
fn covariance<'b>(x: &Signal<'b>, y: &Signal<'b>) -> Sym2<'b> {
    Sym2([x.variance(), x.covariance(y).total, y.variance()])
}

/// A covariance, no larger than the widest, and its eigenvalues.
fn limited(covariance: Sym2<'_>) -> [(&'static str, Float<'_>); 5] {
    const MOST: f32 = WIDEST * WIDEST;
    let [vx, _, vy] = covariance.0;
    // One factor for all three keeps the shape.
    let kept = covariance * (MOST / vx.max(vy).max(MOST));
    let [major, minor] = kept.eigenvalues();
    let [xx, xy, yy] = kept.0;
    [
        ("xx", xx),
        ("xy", xy),
        ("yy", yy),
        ("major", major),
        ("minor", minor.max(0.0)),
    ]
}

/// A source filtered by the footprint, in units of its position; what is not carried is 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Field<'b> {
    /// M.
    pub(crate) mean: Float<'b>,
    /// ∇M.
    pub(crate) gradient: Vec2<'b>,
    /// Hess M.
    pub(crate) hessian: Sym2<'b>,
    /// The variance that the filter removed beyond what the mode carries.
    pub(crate) rest: Float<'b>,
}

impl<'b> Field<'b> {
    /// The signal of the field at a position with coefficients: g = Jᵀ∇M, H = Jᵀ Hess(M) J +
    /// Σ ∂_i M H_i, the position's own symbols through ∇M, and the rest as a fresh ε.
    pub(crate) fn at(&self, lower: &mut Lower<'_, 'b>, position: &[Signal<'b>]) -> Signal<'b> {
        let [x, y] = position else {
            panic!("a position has two coordinates")
        };
        let mode = lower.mode();
        let mut signal = Signal::certain(self.mean);
        if matches!(mode, Mode::Local | Mode::Quad) {
            let [dx, dy] = self.gradient.0;
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
                inputs.extend(self.hessian.into_iter().map(|h| ("bend", h)));
                for axis in [x, y] {
                    inputs.extend(axis.h.into_iter().map(|h| ("h", h)));
                }
            }
            let of = SharedFunction {
                name: "response",
                variant: u32::from(second),
                doc: "The response of a field to its position.",
            };
            let [gx, gy, hxx, hxy, hyy, private] =
                lower.b().shared(of, &inputs, |_, v| response(v));
            signal.g = Vec2([gx, gy]);
            signal.h = Sym2([hxx, hxy, hyy]);
            signal.private = private;
            if !(x.shared.is_empty() && y.shared.is_empty()) {
                // The position's own symbols.
                signal.shared = (x * dx + y * dy).shared;
            }
        }
        lower.algebra.attach_fresh(&mut signal, self.rest);
        signal
    }
}

/// g, H and the private variance of a field by its derivatives and the coordinates'.
fn response<'b>(v: &[Float<'b>]) -> [(&'static str, Float<'b>); 6] {
    let [
        dx,
        dy,
        xx,
        xy,
        x_private,
        yx,
        yy,
        y_private,
        ref second @ ..,
    ] = *v
    else {
        panic!("derivatives and two coordinates")
    };
    let gradient = Vec2([dx, dy]);
    // Columns of J: the response of (x, y) to δ₁ and to δ₂.
    let columns = [Vec2([xx, yx]), Vec2([xy, yy])];
    let mut h = [dx.literal(0.0); 3];
    if let [h11, h12, h22, of_x @ .., _, _, _] = second {
        let of_y = &second[6..];
        let hessian = Sym2([*h11, *h12, *h22]);
        for (k, (i, j)) in [(0, 0), (0, 1), (1, 1)].into_iter().enumerate() {
            let bent = columns[i].dot(hessian.times(columns[j]));
            h[k] = gradient.dot(Vec2([of_x[k], of_y[k]])) + bent;
        }
    }
    [
        ("gx", gradient.dot(columns[0])),
        ("gy", gradient.dot(columns[1])),
        ("hxx", h[0]),
        ("hxy", h[1]),
        ("hyy", h[2]),
        ("private", dx.square() * x_private + dy.square() * y_private),
    ]
}
