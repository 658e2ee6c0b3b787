//! The two small pictures of every node's page: its example close up, and the same place from
//! sixteen times as far, where all that a pixel holds is filtered.

use crate::case::Case;
use mipless::{NodeDef, Options};
use mipless_runtime::cpu::Renderer;
use mipless_runtime::image::{Image, outputs};
use mipless_runtime::job::Job;
use mipless_runtime::view::{Flat, Size, View};

/// The side of a thumbnail, in pixels.
pub const SIDE: u32 = 64;

/// How much wider the far window is.
pub const FAR: f64 = 16.0;

/// How an example is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// The left and the upper edge of the near window, and its side, in units of texture space. The
    /// far window has the same centre.
    pub window: [f64; 3],
    /// The values that are shown as 0 and as 1 in every channel, near and far.
    pub ranges: [[f32; 2]; 2],
}

/// The unit square, in which examples have some six periods; values as they are.
const USUAL: Look = Look {
    window: [0.0, 0.0, 1.0],
    ranges: [[0.0, 1.0]; 2],
};

/// The usual window with other values.
const fn values(low: f32, high: f32) -> Look {
    Look {
        ranges: [[low, high]; 2],
        ..USUAL
    }
}

/// The usual window over values that grow with it, as a position does.
const fn growing(near: [f32; 2], far: [f32; 2]) -> Look {
    Look {
        ranges: [near, far],
        ..USUAL
    }
}

/// A position, whose values are those of the window.
const POSITION: Look = growing([0.0, 1.0], [-7.5, 8.5]);

/// A rotated position.
const ROTATED: Look = growing([-0.5, 1.4], [-11.0, 11.5]);

/// Six steps in a unit.
const STEPS: Look = growing([0.0, 7.0], [-47.0, 54.0]);

/// The usual values in a window of another size.
const fn window(side: f64) -> Look {
    Look {
        window: [0.0, 0.0, side],
        ..USUAL
    }
}

/// The examples that are looked at otherwise.
const OTHERS: &[(&str, Look)] = &[
    ("acos", values(0.0, 3.15)),
    ("add", values(0.0, 2.0)),
    ("asin", values(-1.2, 1.2)),
    ("atan", values(-0.8, 0.8)),
    ("atan2", values(-0.6, 0.6)),
    ("blackbody", values(0.0, 2.0)),
    ("blendnormal", values(-1.0, 1.0)),
    ("brick", window(0.5)),
    ("burn", values(-1.0, 1.0)),
    ("byexample", window(0.5)),
    ("ceil", STEPS),
    ("clamp", values(-0.4, 0.7)),
    ("contrast", values(-1.9, 1.3)),
    ("convert", POSITION),
    ("cos", values(-1.0, 1.0)),
    ("crossproduct", growing([0.0, 1.0], [0.0, 70.0])),
    ("curvature", values(-0.3, 0.3)),
    ("distance", growing([0.0, 0.8], [0.0, 11.0])),
    ("divide", values(0.0, 0.25)),
    ("dotproduct", growing([0.0, 1.7], [0.0, 120.0])),
    ("exp", values(0.0, 2.7)),
    ("extract", POSITION),
    ("floor", STEPS),
    ("image", window(0.5)),
    ("linearlight", values(-1.0, 1.8)),
    ("ln", values(-0.7, 1.0)),
    ("magnitude", growing([0.0, 1.4], [0.0, 12.0])),
    ("minus", values(-1.0, 1.0)),
    ("mirror", window(2.0)),
    ("modulo", values(0.0, 0.21)),
    ("normalize", values(-1.0, 1.0)),
    ("normalmap", values(-1.0, 1.0)),
    ("normaltoslope", values(-0.5, 0.5)),
    ("plus", values(0.0, 1.8)),
    ("position", POSITION),
    ("quantize", values(-1.0, 1.0)),
    ("randomcolor", window(0.5)),
    ("rgbtohsv", values(0.6, 1.0)),
    ("rotate2d", ROTATED),
    ("rotate3d", values(-0.6, 0.6)),
    ("round", STEPS),
    ("separate2", growing([0.0, 1.0], [-62.0, 70.0])),
    ("sign", values(-1.0, 1.0)),
    ("sin", values(-1.0, 1.0)),
    ("sqrt", values(0.0, 1.5)),
    ("subtract", values(-1.0, 1.0)),
    ("texcoord", POSITION),
    ("unpremult", values(-0.3, 1.4)),
    ("whitenoise2d", window(0.05)),
];

/// How the example of a node is looked at.
pub fn look(node: &str) -> Look {
    let other = OTHERS.iter().find(|(name, _)| *name == node);
    other.map_or(USUAL, |(_, look)| *look)
}

/// Near and far: the first output of a node's example, as a colour without its alpha, so that it
/// looks alike on any page, or as a number.
///
/// # Panics
/// If the example has mistakes.
pub fn render(def: &NodeDef) -> [Image; 2] {
    let look = look(def.spec.name);
    let case = Case::new(def.spec.name, def.spec.example);
    let program = case.texture.compile(&Options::default());
    let first = outputs(&program.interface).remove(0);
    let renderer = Renderer::<f32>::new(&program);
    let [x, y, side] = look.window;
    let far = 0.5 * (FAR - 1.0) * side;
    [(0.0, look.ranges[0]), (far, look.ranges[1])].map(|(margin, [low, high])| {
        let window = [x - margin, y - margin, x + side + margin, y + side + margin];
        let view = View::Flat(Flat { window });
        let size = Size::new(SIDE, SIDE);
        let all = renderer.render(&view, size, None, Job::default());
        let image = all.expect("nothing stops it").mean(&first);
        let shown = image.channels().len().min(3);
        let scale = |channel: &Vec<f32>| channel.iter().map(|x| (x - low) / (high - low)).collect();
        let channels = image.channels()[..shown].iter().map(scale).collect();
        Image::new(size, &image.names()[..shown], channels)
    })
}
