//! Materials under a sun and a sky.
//!
//! What a program says of a material over each pixel becomes light by the functions of
//! [`mipless_codegen::shade`]; of points they are what a host does without a filter. The truth is the mean
//! of many points, each shaded by itself, by the area that its facet shows to the eye ([`Lit::truth`]).

mod sky;
mod truth;

use crate::image::{Image, outputs};
use crate::view::{Hit, Part, View};
use mipless_codegen::cpu::{Evaluator, Input, Scratch};
use mipless_codegen::ir::Interface;
pub use mipless_codegen::shade::Hiding;
use mipless_codegen::shade::{FIELDS, Lighting, absent};
use rayon::prelude::*;
use sky::Zonal;
use std::fmt;

pub use truth::Halves;

/// The names of the parts of a material that are asked of a program.
pub fn parts() -> Vec<&'static str> {
    FIELDS.iter().map(|(name, _)| *name).collect()
}

/// A sun.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Where it stands, in degrees counter-clockwise from the right; 90 is ahead.
    pub azimuth: f64,
    /// Its height above the ground, in degrees.
    pub elevation: f64,
}

impl Sun {
    /// Where it stands unless something else is said: ahead and to the left over a plane, so that what is
    /// wet glitters; over the left shoulder of who looks at a sphere.
    pub fn of(view: &View) -> Self {
        let (azimuth, elevation) = match view {
            View::Flat(_) => (135.0, 40.0),
            View::Plane(_) => (115.0, 28.0),
            View::Sphere(_) => (230.0, 40.0),
        };
        Self { azimuth, elevation }
    }
}

/// The light of the sun: the radiance of a white matt surface that faces it.
const SUN: [f64; 3] = [1.9, 1.7, 1.4];

/// Pixels that are lit at a time.
const TILE: usize = 1024;

/// A sun and a sky over a view, and what they need to light a material.
pub struct Lit {
    view: View,
    /// Towards the sun, in space.
    sun: [f64; 3],
    sky: [Zonal; 3],
    by_light: Evaluator<f32>,
    by_sky: Evaluator<f32>,
}

impl fmt::Debug for Lit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} lit from {:?}", self.view, self.sun)
    }
}

impl Lit {
    /// A view under a sun.
    pub fn new(view: &View, sun: Sun, hiding: Hiding) -> Self {
        Self {
            view: view.clone(),
            sun: view.towards(sun.azimuth, sun.elevation),
            sky: Zonal::clear(),
            by_light: Evaluator::new(&Lighting::Light.module(hiding)),
            by_sky: Evaluator::new(&Lighting::Sky.module(hiding)),
        }
    }

    /// The light that each pixel sends to the eye, linear `R,G,B`, without a background, of `all` results
    /// of a program whose outputs are parts of a material by their names. What is not among them is as of a
    /// surface that is smooth.
    pub fn light(&self, interface: &Interface, all: &Image) -> Image {
        self.light_part(interface, all, Part::all(all.size()))
    }

    /// The same of a part of a picture.
    pub fn light_part(&self, interface: &Interface, all: &Image, part: Part) -> Image {
        let size = part.size;
        let layout = Layout::of(interface);
        let tiles: Vec<[Vec<f32>; 3]> = (0..size.pixels().div_ceil(TILE))
            .into_par_iter()
            .map_init(Workbench::default, |bench, tile| {
                let pixels = tile * TILE..size.pixels().min((tile + 1) * TILE);
                let (mut lanes, mut hits) = (Vec::new(), Vec::new());
                for index in pixels.clone() {
                    let point = part.whole.centre(part.place(index));
                    let hit = self.view.hit(part.whole, point);
                    if let Some(hit) = hit.filter(|hit| hit.footprint().is_some()) {
                        lanes.push(index);
                        hits.push(hit);
                    }
                }
                let channel = |result: usize| {
                    let channel = &all.channels()[result];
                    lanes.iter().map(|&lane| channel[lane]).collect()
                };
                let fields = layout.fields(lanes.len(), channel);
                let colors = self.colors(bench, &fields, &hits);
                colors.map(|color| {
                    let mut tile = vec![0.0; pixels.len()];
                    for (&lane, x) in lanes.iter().zip(color) {
                        tile[lane - pixels.start] = x;
                    }
                    tile
                })
            })
            .collect();
        let channels = [0, 1, 2].map(|c| {
            tiles
                .iter()
                .flat_map(|tile| tile[c].iter().copied())
                .collect()
        });
        Image::new(size, &["R", "G", "B"], channels.to_vec())
    }

    /// The light of surfaces at these hits.
    fn colors(&self, bench: &mut Workbench, fields: &[Vec<f32>], hits: &[Hit]) -> [Vec<f32>; 3] {
        let in_frame = |of: &dyn Fn(&Hit) -> [f64; 3]| -> [Vec<f32>; 3] {
            let all: Vec<[f64; 3]> = hits.iter().map(|hit| within(&hit.frame, of(hit))).collect();
            [0, 1, 2].map(|axis| all.iter().map(|d| d[axis] as f32).collect())
        };
        let up = match self.view {
            View::Flat(_) => [0.0, 0.0, 1.0],
            View::Plane(_) | View::Sphere(_) => [0.0, 1.0, 0.0],
        };
        let eye = in_frame(&|hit| hit.eye);
        let sun = in_frame(&|_| self.sun);
        let terms: Vec<[[f32; 3]; 9]> = (hits.iter())
            .map(|hit| sky::terms(&self.sky, within(&hit.frame, up)))
            .collect();
        let sky: Vec<Vec<f32>> = (0..27)
            .map(|k| terms.iter().map(|terms| terms[k / 3][k % 3]).collect())
            .collect();
        let mut inputs: Vec<Input<'_>> = fields.iter().map(|field| Input::Floats(field)).collect();
        inputs.extend(eye.iter().map(|axis| Input::Floats(axis)));
        let shared = inputs.len();
        inputs.extend(sun.iter().map(|axis| Input::Floats(axis)));
        inputs.extend(SUN.map(|x| Input::Float(x as f32)));
        let Workbench { scratch, outputs } = bench;
        self.by_light
            .evaluate(scratch, &inputs, hits.len(), outputs);
        let light = std::mem::take(outputs);
        inputs.truncate(shared);
        inputs.extend(sky.iter().map(|term| Input::Floats(term)));
        self.by_sky.evaluate(scratch, &inputs, hits.len(), outputs);
        [0, 1, 2].map(|c| {
            light[c]
                .iter()
                .zip(&outputs[c])
                .map(|(l, s)| l + s)
                .collect()
        })
    }
}

/// What one thread holds.
#[derive(Debug, Default)]
struct Workbench {
    scratch: Scratch<f32>,
    outputs: Vec<Vec<f32>>,
}

/// A direction of space in a frame.
fn within(frame: &[[f64; 3]; 3], d: [f64; 3]) -> [f64; 3] {
    frame.map(|axis| axis[0] * d[0] + axis[1] * d[1] + axis[2] * d[2])
}

/// Where the numbers of a surface lie among the results of a program: the result, or what stands for it.
struct Layout(Vec<Result<usize, f32>>);

impl Layout {
    fn of(interface: &Interface) -> Self {
        let all = outputs(interface);
        let component = |name: &str, i: usize| {
            let output = all.iter().find(|output| output.name == name);
            output
                .map(|output| output.mean.start + i)
                .ok_or_else(|| absent(name))
        };
        let field = |&(name, components): &(&'static str, usize)| {
            (0..components)
                .map(move |i| component(name, i))
                .collect::<Vec<_>>()
        };
        Self(FIELDS.iter().flat_map(field).collect())
    }

    /// The numbers for so many lanes, from results.
    fn fields(&self, lanes: usize, result: impl Fn(usize) -> Vec<f32>) -> Vec<Vec<f32>> {
        let field = |place: &Result<usize, f32>| match place {
            Ok(index) => result(*index),
            Err(constant) => vec![*constant; lanes],
        };
        self.0.iter().map(field).collect()
    }
}

/// Where a field begins among the numbers of a surface.
fn place_of(name: &str) -> usize {
    let before = FIELDS.iter().take_while(|field| field.0 != name);
    before.map(|field| field.1).sum()
}
