//! The slopes of a height along the coordinates of a surface, which several nodes read.

use mipless_codegen::ir::{Sym2, Vec2, dot};
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower, Slopes, Widened};
use mipless_graph::{Behaviour, InputView, Node};

/// The standard deviation, in uv, of the footprint over which a point has a slope.
const RESOLUTION: f32 = 1e-5;

/// Slopes beyond this are those of jumps, and vertical.
const STEEPEST: f32 = 1e9;

/// ∂/∂u and ∂/∂v of an input, with (u, v) the node's texcoord; what the footprint removed of them are symbols that
/// both carry.
pub(super) fn gradient<'b>(lower: &mut Lower<'_, 'b>, node: &Node, port: &str) -> [Signal<'b>; 2] {
    let sources = (&node.input(port).source, &node.input("texcoord").source);
    let key = format!("gradient {sources:?}");
    let slopes = lower.jointly(&key, |lower| computed(lower, node, port).to_vec());
    slopes.try_into().expect("two slopes")
}

fn computed<'b>(lower: &mut Lower<'_, 'b>, node: &Node, port: &str) -> [Signal<'b>; 2] {
    let spreads = lower.mode().spreads();
    let over = lower.widened(lower.b().float(RESOLUTION * RESOLUTION));
    let height = lower.slopes(node, port, &over, spreads)[0];
    let texcoord = lower.slopes(node, "texcoord", &over, false);
    let frame = Frame::new([texcoord[0].mean, texcoord[1].mean]);
    let mut slopes = frame.0.map(|row| {
        let mean = row.dot(height.mean).clamp(-STEEPEST, STEEPEST);
        Signal::certain(mean)
    });
    if spreads {
        for (slope, row) in slopes.iter_mut().zip(frame.0) {
            slope.g = response(row, &height, &over);
            slope.share = Some(height.share);
        }
        let rest = frame.turned(height.rest);
        lower.algebra.attach_joint(&mut slopes, &*rest);
    }
    slopes
}

/// The response of a slope to the pixel's δ.
fn response<'b>(row: Vec2<'b>, height: &Slopes<'b>, over: &Widened<'b>) -> Vec2<'b> {
    let [left, right] = *(height.rows[0] * row[0] + height.rows[1] * row[1]);
    let [top, bottom] = over.ratio;
    Vec2([0, 1].map(|k| dot([left, right], [top[k], bottom[k]])))
        .map(|response| response.clamp(-STEEPEST, STEEPEST))
}

/// J⁻ᵀ by rows, for the Jacobian J of the texcoord; 0 where it does not change.
struct Frame<'b>([Vec2<'b>; 2]);

impl<'b> Frame<'b> {
    fn new([u, v]: [Vec2<'b>; 2]) -> Self {
        let area = u[0] * v[1] - v[0] * u[1];
        // Of less than a millionth of its sides' product nothing but rounding is left.
        let sides = u.norm2().sqrt() * v.norm2().sqrt();
        let whole = area.abs().gt(sides * 1e-6);
        let inverse = whole.select(1.0 / whole.select(area, 1.0), 0.0);
        Self([Vec2([v[1], -v[0]]) * inverse, Vec2([-u[1], u[0]]) * inverse])
    }

    /// The covariance of slopes by (u, v) of which that by the surface's own is known.
    fn turned(&self, covariance: Sym2<'b>) -> Sym2<'b> {
        let [u, v] = self.0;
        let of = |p: Vec2<'b>, q: Vec2<'b>| p.dot(covariance.times(q));
        Sym2([of(u, u), of(u, v), of(v, v)])
    }
}

/// The colour of a normal map whose normal leans by these tilts: ½ + ½ n/|n|, n = (x, y, 1).
pub(super) fn normals<'b>(lower: &mut Lower<'_, 'b>, tilts: &[Signal<'b>; 2]) -> Bundle<'b> {
    let ranges = [[0.0, 1.0], [0.0, 1.0], [0.5, 1.0]];
    lower.algebra.fine_cubature(tilts, &ranges, |tilt| {
        let [x, y] = [tilt[0], tilt[1]];
        let up = 0.5 / (x * x + y * y + 1.0).sqrt();
        [x * up, y * up, up].map(|side| side + 0.5).to_vec()
    })
}

/// The normal of length 1, in tangent space, of a surface with these slopes.
pub(super) fn upright<'b>(lower: &mut Lower<'_, 'b>, slopes: &[Signal<'b>; 2]) -> Bundle<'b> {
    let ranges = [[-1.0, 1.0], [-1.0, 1.0], [0.0, 1.0]];
    lower.algebra.fine_cubature(slopes, &ranges, |slope| {
        let [x, y] = [slope[0], slope[1]];
        let up = 1.0 / (x * x + y * y + 1.0).sqrt();
        vec![-x * up, -y * up, up]
    })
}

/// Normals that lean more are taken for such that do not.
const LEANING: f32 = 50.0;

/// The slopes that a normal in tangent space means, −n_xy/n_z.
pub(super) fn of_normal<'b>(lower: &mut Lower<'_, 'b>, normal: &[Signal<'b>]) -> [Signal<'b>; 2] {
    let ranges = [[-LEANING, LEANING]; 2];
    let slopes = lower.algebra.cubature(normal, &ranges, |n| {
        let up = n[2].max(1e-6);
        [n[0], n[1]]
            .map(|across| (-across / up).clamp(-LEANING, LEANING))
            .to_vec()
    });
    slopes.try_into().expect("two slopes")
}

/// The class of what reads the gradient of `in`.
pub(super) fn class(inputs: &dyn InputView) -> Behaviour {
    class_of(inputs, "in")
}

/// The class of what reads the gradient of an input.
pub(super) fn class_of(inputs: &dyn InputView, height: &'static str) -> Behaviour {
    for port in [height, "texcoord"] {
        if inputs.in_space(port) {
            return Behaviour::Refused {
                port,
                reason: "the derivative is by uv, of which a position in space is not known to be a function",
            };
        }
    }
    Behaviour::Function
}
