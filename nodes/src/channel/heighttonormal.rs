//! A normal from a height.

use crate::port;
use crate::port::number;
use mipless_codegen::ir::{Float, Sym2, Vec2, dot};
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower, Over, Widened};
use mipless_graph::{
    Behaviour, Category, Doc, InputView, Node, NodeSpec, OutputType, Range, Reach, Type,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "heighttonormal",
    aliases: &["normal_map", "bump", "height_to_normal", "normal"],
    category: Category::Channel,
    summary: "The normal of a height, as a colour of a normal map.",
    doc: Doc {
        computes: "out = ½ + ½ n/|n| with n = (−k ∂in/∂u, −k ∂in/∂v, 1), k = scale/16 and (u, v) the \
            texcoord, all in [0, 1]; (½, ½, 1) where the texcoord does not change. At a point the \
            derivatives are those of the height under a round Gaussian with a standard deviation of \
            1e-5 uv, which a smooth height does not tell from its own. What the height depends on is \
            evaluated once more for it.",
        statistics: "The mean slope under the footprint is the gradient of the filtered height, which is \
            exact wherever the filtered height is. Its response to the place in the footprint is the \
            filtered height's Hessian. Of the slopes that the filter removed, the \
            variance is taken for isotropic and for R(2π/λ)²/2 in each direction: R is the height's \
            variance beyond its Hessian, 2π/λ the root mean square wavenumber of the coarsest noise, wave \
            or wall of bevelled bricks upstream (other patterns name none, and lose none). \
            The normal is then a cubature of 18 nodes over the two slopes, as a Gaussian.",
        accuracy: "Exact for a plane, and in its mean slope for every height that is filtered exactly. \
            Largest error of a component over footprints from 0.01 to 5 wavelengths, round and 8:1 (root \
            mean square): 0.033 (0.006) for a noise whose slopes have a standard deviation of 0.6, 0.035 \
            (0.009) for one of three octaves, 0.008 (0.002) for a sine wave of slopes up to 0.5, 0.09 \
            (0.018) for bricks with bevels of 51 degrees, whose slopes are no Gaussian. The standard deviation is within 0.11, for such bricks within 0.19. Where \
            several sources shape the height, the coarsest alone is asked; footprints beyond 64 uv are \
            taken for such. A height with jumps \
            has no slope there: its edges should be ramps. Held by `nodes/src/pattern/tests/upstream.rs` \
            against dense sums.",
        references: "Olano & Baker 2010, *LEAN Mapping* (slopes have means and variances, normals do \
            not). Mikkelsen 2010, *Bump Mapping Unparametrized Surfaces on the GPU*. MaterialX 1.39 \
            specification, node `heighttonormal`; its factor 1/16 is that of its implementation.",
    },
    inputs: &[
        number("in", 0.0, "The height."),
        number(
            "scale",
            1.0,
            "How much the height tilts the normal: 16 for a height in units of the texcoord.",
        )
        .range(Range::soft(0.0, 16.0)),
        port::surface("The coordinates that the normal's axes follow."),
    ],
    output: OutputType::Exactly(Type::Vector3),
    reach: |_| Reach::of(-1.0, 1.0),
    class,
    example: example! { "heighttonormal", r#"
    "hills": { "type": "fractal2d", "inputs": { "frequency": 5 } },
    "heighttonormal": { "type": "heighttonormal", "inputs": { "in": { "node": "hills" }, "scale": 2 } }
"# },
};

fn class(inputs: &dyn InputView) -> Behaviour {
    for port in ["in", "texcoord"] {
        if inputs.in_space(port) {
            return Behaviour::Refused {
                port,
                reason: "the derivative is by uv, of which a position in space is not known to be a function",
            };
        }
    }
    Behaviour::Function
}

/// The standard deviation, in uv, of the footprint over which a point has a slope.
const RESOLUTION: f32 = 1e-5;

/// Slopes beyond this are those of jumps, and vertical.
const STEEPEST: f32 = 1e9;

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let spreads = lower.mode().spreads();
    let scale = lower.number(node, "scale");
    let over = lower.widened(lower.b().float(RESOLUTION * RESOLUTION));
    let height = lower.upstream(node, "in", &over, spreads);
    let place = lower.upstream(node, "texcoord", &over, false);
    let frame = Frame::new(&place.components, scale);
    let of = height.components[0];
    let mut tilts = frame.tilts(&of);
    if spreads {
        let removed = removed(&over, of.rest, height.wavelengths);
        for (i, tilt) in tilts.iter_mut().enumerate() {
            tilt.g = frame.responses(i, &of, &over);
            lower
                .algebra
                .attach_fresh(tilt, frame.share(i, &over) * removed);
        }
    }
    let ranges = [[0.0, 1.0], [0.0, 1.0], [0.5, 1.0]];
    lower.algebra.fine_cubature(&tilts, &ranges, |tilt| {
        let [x, y] = [tilt[0], tilt[1]];
        let up = 0.5 / (x * x + y * y + 1.0).sqrt();
        [x * up, y * up, up].map(|side| side + 0.5).to_vec()
    })
}

/// The variance of the slopes that a footprint removed, in each direction: R(2π/λ)²/2, times
/// q²/(q² + ¼), q = (2πs/λ)². For small q R is of the third order and next to nothing, unless a
/// pattern estimates it by a share of its ramps: what is left of it then is of the first order, and no
/// detail.
fn removed<'b>(over: &Widened<'b>, rest: Float<'b>, wavelengths: Float<'b>) -> Float<'b> {
    let [first, side, second] = over.root;
    let covariance = Sym2([
        first.square(),
        first * side,
        dot([side, second], [side, second]),
    ]);
    let [major, _] = covariance.eigenvalues();
    let turns = wavelengths.square() * std::f32::consts::TAU.powi(2);
    let square = turns.min(1e9).square();
    rest * (turns / major * (square / (square + 0.25)) * 0.5)
}

/// −k (JL)⁻ᵀ: what responses to δ′ are as tilts of the normal, for the Jacobian J of the texcoord.
struct Frame<'b> {
    rows: [Vec2<'b>; 2],
}

impl<'b> Frame<'b> {
    fn new(texcoord: &[Over<'b>], scale: Float<'b>) -> Self {
        let (u, v) = (texcoord[0].g, texcoord[1].g);
        let area = u[0] * v[1] - v[0] * u[1];
        // Of less than a millionth of its sides' product nothing but rounding is left.
        let sides = u.norm2().sqrt() * v.norm2().sqrt();
        let whole = area.abs().gt(sides * 1e-6);
        let inverse = scale * (-1.0 / 16.0) / whole.select(area, 1.0);
        let inverse = whole.select(inverse, 0.0);
        Self {
            rows: [Vec2([v[1], -v[0]]) * inverse, Vec2([-u[1], u[0]]) * inverse],
        }
    }

    /// The mean tilts.
    fn tilts(&self, height: &Over<'b>) -> [Signal<'b>; 2] {
        self.rows
            .map(|row| Signal::certain(row.dot(height.g).clamp(-STEEPEST, STEEPEST)))
    }

    /// The response of a tilt to the pixel's δ.
    fn responses(&self, i: usize, height: &Over<'b>, over: &Widened<'b>) -> Vec2<'b> {
        let [left, right] = *height.h.times(self.rows[i]);
        let [top, bottom] = over.ratio;
        Vec2([0, 1].map(|k| dot([left, right], [top[k], bottom[k]])))
            .map(|response| response.clamp(-STEEPEST, STEEPEST))
    }

    /// The variance of a tilt where the slopes by u and by v of the surface have variance 1 each.
    fn share(&self, i: usize, over: &Widened<'b>) -> Float<'b> {
        let [first, side, second] = over.root;
        let [p, q] = *self.rows[i];
        Vec2([p * first, p * side + q * second]).norm2()
    }
}
