//! The shaded truth: many points of each pixel, each shaded as a facet.

use super::{Layout, Lit, Workbench, place_of, within};
use crate::image::Image;
use crate::job::{Cancelled, Job, Tally};
use crate::view::{Hit, Size};
use mipless_codegen::PixelFilter;
use mipless_codegen::cpu::{Evaluator, Footprint, Position, Scratch};
use mipless_codegen::ir::Program;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Pixels whose points are evaluated together.
const PIXELS: usize = 256;

/// Two pictures of the same, by different points.
#[derive(Clone, Debug)]
pub struct Halves(pub [Image; 2]);

impl Halves {
    /// The picture by all points.
    pub fn whole(&self) -> Image {
        let [first, second] = &self.0;
        let mut whole = first.clone();
        for (channel, other) in whole.channels_mut().iter_mut().zip(second.channels()) {
            for (x, y) in channel.iter_mut().zip(other) {
                *x = 0.5 * (*x + y);
            }
        }
        whole
    }
}

/// The `index`-th point of a pixel, in pixels from its centre: the R2 sequence (Roberts 2018) from a place
/// that a hash of the pixel gives, bent to the filter.
fn offset(filter: PixelFilter, pixel: usize, index: u32) -> [f64; 2] {
    let hash = |salt: u64| {
        let mut x = (pixel as u64 ^ salt).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (x >> 11) as f64 / (1_u64 << 53) as f64
    };
    let at = |salt, step: f64| (hash(salt) + step * f64::from(index + 1)).fract();
    let [x, y] = [
        at(0x51, 0.754_877_666_246_693),
        at(0xa7, 0.569_840_290_998_053),
    ];
    match filter {
        PixelFilter::Box => [x - 0.5, y - 0.5],
        PixelFilter::Gaussian(sd) => {
            let radius = f64::from(sd) * (-2.0 * (1.0 - x).ln()).sqrt();
            let (sin, cos) = (TAU * y).sin_cos();
            [radius * cos, radius * sin]
        }
    }
}

/// Light and area of the points of some pixels.
struct Sums {
    light: [Vec<f64>; 3],
    area: Vec<f64>,
}

impl Sums {
    fn color(&self, channel: usize) -> impl Iterator<Item = f32> + '_ {
        let all = self.light[channel].iter().zip(&self.area);
        all.map(|(light, area)| {
            if *area > 0.0 {
                (light / area) as f32
            } else {
                0.0
            }
        })
    }
}

impl Lit {
    /// The light that each pixel sends to the eye, as the mean of `samples` points of it, shaded one by one:
    /// of each facet by the area that it shows, over the area of all (what facets hide of each other is left
    /// out). `program` is the point function of the parts of a material.
    ///
    /// # Errors
    /// If the job is cancelled.
    pub fn truth(
        &self,
        (program, parameters): (&Program, &[f32]),
        size: Size,
        filter: PixelFilter,
        samples: u32,
        job: Job<'_>,
    ) -> Result<Halves, Cancelled> {
        let evaluator = Evaluator::<f32>::of_program(program);
        let layout = Layout::of(&program.interface);
        let tally = Tally::new(job, size);
        let starts: Vec<usize> = (0..size.pixels()).step_by(PIXELS).collect();
        let tiles: Vec<[Sums; 2]> = starts
            .into_par_iter()
            .map_init(
                || (Workbench::default(), Scratch::new(), Vec::new()),
                |(bench, scratch, outputs), start| {
                    tally.proceed()?;
                    let pixels = start..size.pixels().min(start + PIXELS);
                    let mut sums = [(), ()].map(|()| Sums {
                        light: [(), (), ()].map(|()| vec![0.0; pixels.len()]),
                        area: vec![0.0; pixels.len()],
                    });
                    for index in 0..samples {
                        let (lanes, hits) = self.points(size, filter, pixels.clone(), index);
                        let footprints: Vec<Footprint> = hits.iter().map(|hit| hit.1).collect();
                        let positions: Vec<Position> = hits.iter().map(|hit| hit.2).collect();
                        let hits: Vec<Hit> = hits.into_iter().map(|hit| hit.0).collect();
                        evaluator.evaluate_surface(
                            scratch,
                            &footprints,
                            &positions,
                            parameters,
                            outputs,
                        );
                        let fields = layout.fields(lanes.len(), |result| outputs[result].clone());
                        let colors = self.colors(bench, &fields, &hits);
                        let sums = &mut sums[index as usize % 2];
                        let slopes = place_of("slope_mean");
                        for (k, (&lane, hit)) in lanes.iter().zip(&hits).enumerate() {
                            let [x, y, z] = within(&hit.frame, hit.eye);
                            let [u, v] = [0, 1].map(|axis| f64::from(fields[slopes + axis][k]));
                            let area = ((z - x * u - y * v) / z.max(1e-9)).max(0.0);
                            sums.area[lane] += area;
                            for (sum, color) in sums.light.iter_mut().zip(&colors) {
                                sum[lane] += area * f64::from(color[k]);
                            }
                        }
                    }
                    tally.add(pixels.len());
                    Ok(sums)
                },
            )
            .collect::<Result<_, Cancelled>>()?;
        let half = |half: usize| {
            let channel = |c: usize| tiles.iter().flat_map(|sums| sums[half].color(c)).collect();
            Image::new(size, &["R", "G", "B"], [0, 1, 2].map(channel).to_vec())
        };
        Ok(Halves([half(0), half(1)]))
    }

    /// The points of this number of some pixels that meet the surface, with the pixels they are of.
    fn points(
        &self,
        size: Size,
        filter: PixelFilter,
        pixels: std::ops::Range<usize>,
        index: u32,
    ) -> (Vec<usize>, Vec<(Hit, Footprint, Position)>) {
        let mut lanes = Vec::with_capacity(pixels.len());
        let mut hits = Vec::with_capacity(pixels.len());
        for (lane, pixel) in pixels.enumerate() {
            let ([x, y], [dx, dy]) = (size.centre(pixel), offset(filter, pixel, index));
            let Some(hit) = self.view.hit(size, [x + dx, y + dy]) else {
                continue;
            };
            let at = |mut footprint: Footprint| {
                (footprint.du, footprint.dv) = ([0.0; 2], [0.0; 2]);
                footprint
            };
            if let (Some(footprint), Some(position)) = (hit.footprint(), hit.space()) {
                lanes.push(lane);
                hits.push((hit, at(footprint), position));
            }
        }
        (lanes, hits)
    }
}
