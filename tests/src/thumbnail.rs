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
    /// The values that are shown as 0 and as 1 in each channel.
    pub range: [f32; 2],
    /// Whether the value at the far end of the range grows with the window, as a position does.
    pub grows: bool,
}

/// Four units of an example's usual six to eight periods are enough to see a pattern and leave
/// something of it from afar.
const USUAL: Look = Look {
    window: [0.0, 0.0, 1.0],
    range: [0.0, 1.0],
    grows: false,
};

/// The examples that are looked at otherwise.
const OTHERS: &[(&str, Look)] = &[];

/// How the example of a node is looked at.
pub fn look(node: &str) -> Look {
    let other = OTHERS.iter().find(|(name, _)| *name == node);
    other.map_or(USUAL, |(_, look)| *look)
}

/// Near and far: the first output of a node's example, a colour or numbers of 0 to 1.
///
/// # Panics
/// If the example has mistakes.
pub fn render(def: &NodeDef) -> [Image; 2] {
    let look = look(def.spec.name);
    let case = Case::new(def.spec.name, def.spec.example);
    let program = case.texture.compile(&Options::default());
    let first = outputs(&program.interface).remove(0);
    let renderer = Renderer::<f32>::new(&program);
    [1.0, FAR].map(|times| {
        let [x, y, side] = look.window;
        let margin = 0.5 * (times - 1.0) * side;
        let window = [x - margin, y - margin, x + side + margin, y + side + margin];
        let view = View::Flat(Flat { window });
        let all = renderer.render(&view, Size::new(SIDE, SIDE), None, Job::default());
        let mut image = all.expect("nothing stops it").mean(&first);
        let [low, mut high] = look.range;
        if look.grows {
            high = low + (high - low) * times as f32;
        }
        for channel in image.channels_mut() {
            for x in channel {
                *x = (*x - low) / (high - low);
            }
        }
        image
    })
}
