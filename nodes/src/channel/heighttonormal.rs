//! A normal from a height.

use mipless_codegen::ir::{Builder, Value};
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower, NodeDef, Over, Widened};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Range, Type,
};

static SPEC: NodeSpec = NodeSpec {
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
        PortSpec::new(
            "in",
            PortType::Exactly(Type::Float),
            Default::Float(0.0),
            "The height.",
        ),
        PortSpec::new(
            "scale",
            PortType::Exactly(Type::Float),
            Default::Float(1.0),
            "How much the height tilts the normal: 16 for a height in units of the texcoord.",
        )
        .range(Range::soft(0.0, 16.0)),
        PortSpec::new(
            "texcoord",
            PortType::Exactly(Type::Vector2),
            Default::Surface,
            "The coordinates that the normal's axes follow.",
        )
        .unit("uv"),
    ],
    output: OutputType::Exactly(Type::Vector3),
    class,
    example: r#"{
  "version": 1,
  "name": "heighttonormal_example",
  "nodes": {
    "hills": { "type": "fractal2d", "inputs": { "frequency": 5 } },
    "heighttonormal": { "type": "heighttonormal", "inputs": { "in": { "node": "hills" }, "scale": 2 } }
  },
  "outputs": { "out": { "node": "heighttonormal" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

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

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let spreads = lower.mode().spreads();
    let scale = lower.number(node, "scale");
    let variance = lower.b().f32(RESOLUTION * RESOLUTION);
    let over = lower.widened(variance);
    let height = lower.upstream(node, "in", &over, spreads);
    let place = lower.upstream(node, "texcoord", &over, false);
    let frame = Frame::new(lower.b(), &place.components, scale);
    let of = height.components[0];
    let mut tilts = frame.tilts(lower.b(), &of);
    if spreads {
        let removed = removed(lower.b(), &over, of.rest, height.wavelengths);
        for (i, tilt) in tilts.iter_mut().enumerate() {
            let b = lower.b();
            tilt.g = frame.responses(b, i, &of, &over);
            let unit = frame.share(b, i, &over);
            let variance = b.mul(unit, removed);
            lower.algebra.attach_fresh(tilt, variance);
        }
    }
    let ranges = [[0.0, 1.0], [0.0, 1.0], [0.5, 1.0]];
    lower.algebra.fine_cubature(&tilts, &ranges, |b, tilt| {
        let square = b.dot(tilt, tilt);
        let square = b.offset(square, 1.0);
        let length = b.sqrt(square);
        let half = b.f32(0.5);
        let inverse = b.div(half, length);
        let sides = [tilt[0], tilt[1]].map(|t| {
            let side = b.mul(t, inverse);
            b.offset(side, 0.5)
        });
        vec![sides[0], sides[1], b.offset(inverse, 0.5)]
    })
}

/// The variance of the slopes that a footprint removed, in each direction: R(2π/λ)²/2, times
/// q²/(q² + ¼), q = (2πs/λ)². For small q R is of the third order and next to nothing, unless a
/// pattern estimates it by a share of its ramps: what is left of it then is of the first order, and no
/// detail.
fn removed(b: &mut Builder, over: &Widened, rest: Value, wavelengths: Value) -> Value {
    let [first, side, second] = over.root;
    let (xx, yy) = (b.square(first), b.dot(&[side, second], &[side, second]));
    let xy = b.mul(first, side);
    let (sum, difference) = (b.add(xx, yy), b.sub(xx, yy));
    let (half, tilt) = (b.scale(sum, 0.5), b.scale(difference, 0.5));
    let square = b.dot(&[tilt, xy], &[tilt, xy]);
    let root = b.sqrt(square);
    let major = b.add(half, root);
    let turns = b.square(wavelengths);
    let turns = b.scale(turns, std::f32::consts::TAU.powi(2));
    let most = b.f32(1e9);
    let bounded = b.min(turns, most);
    let square = b.square(bounded);
    let more = b.offset(square, 0.25);
    let share = b.div(square, more);
    let detail = b.div(turns, major);
    let detail = b.mul(detail, share);
    let detail = b.scale(detail, 0.5);
    b.mul(rest, detail)
}

/// −k (JL)⁻ᵀ: what responses to δ′ are as tilts of the normal, for the Jacobian J of the texcoord.
struct Frame {
    rows: [[Value; 2]; 2],
}

impl Frame {
    fn new(b: &mut Builder, texcoord: &[Over], scale: Value) -> Self {
        let [[ux, uy], [vx, vy]] = [texcoord[0].g, texcoord[1].g];
        let (p, q) = (b.mul(ux, vy), b.mul(vx, uy));
        let area = b.sub(p, q);
        // Of less than a millionth of its sides' product nothing but rounding is left.
        let (of_u, of_v) = (b.dot(&[ux, uy], &[ux, uy]), b.dot(&[vx, vy], &[vx, vy]));
        let (of_u, of_v) = (b.sqrt(of_u), b.sqrt(of_v));
        let sides = b.mul(of_u, of_v);
        let least = b.scale(sides, 1e-6);
        let magnitude = b.abs(area);
        let whole = b.lt(least, magnitude);
        let (zero, one) = (b.f32(0.0), b.f32(1.0));
        let guarded = b.select(whole, area, one);
        let factor = b.scale(scale, -1.0 / 16.0);
        let inverse = b.div(factor, guarded);
        let inverse = b.select(whole, inverse, zero);
        let (minus_vx, minus_uy) = (b.neg(vx), b.neg(uy));
        let rows = [[vy, minus_vx], [minus_uy, ux]].map(|row| row.map(|v| b.mul(v, inverse)));
        Self { rows }
    }

    /// The mean tilts.
    fn tilts(&self, b: &mut Builder, height: &Over) -> [Signal; 2] {
        self.rows.map(|row| {
            let tilt = b.dot(&row, &height.g);
            let tilt = b.clamp(tilt, -STEEPEST, STEEPEST);
            Signal::certain(b, tilt)
        })
    }

    /// The response of a tilt to the pixel's δ.
    fn responses(&self, b: &mut Builder, i: usize, height: &Over, over: &Widened) -> [Value; 2] {
        let [xx, xy, yy] = height.h;
        let row = self.rows[i];
        let (left, right) = (b.dot(&row, &[xx, xy]), b.dot(&row, &[xy, yy]));
        let [top, bottom] = over.ratio;
        [0, 1].map(|k| {
            let response = b.dot(&[left, right], &[top[k], bottom[k]]);
            b.clamp(response, -STEEPEST, STEEPEST)
        })
    }

    /// The variance of a tilt where the slopes by u and by v of the surface have variance 1 each.
    fn share(&self, b: &mut Builder, i: usize, over: &Widened) -> Value {
        let [first, side, second] = over.root;
        let [p, q] = self.rows[i];
        let x = b.mul(p, first);
        let y = b.dot(&[p, q], &[side, second]);
        b.dot(&[x, y], &[x, y])
    }
}
