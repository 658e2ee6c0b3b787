//! Rays over a height field.

use super::{Direction, Field};
use rayon::prelude::*;

/// How far a ray moves at a time, in texels.
const STEP: f64 = 0.75;

/// For every `stride`-th texel of every `stride`-th row 1 where a ray towards `w` clears the field, which is
/// linear between texels, else 0.
pub fn visible(field: &Field, [x, y, z]: Direction, stride: usize) -> Vec<f64> {
    let n = field.torus.texels;
    let side = n / stride;
    let across = x.hypot(y);
    if across < 1e-3 {
        return vec![1.0; side * side];
    }
    let step = field.torus.step();
    let heights: Vec<f32> = field.height.iter().map(|&h| h as f32).collect();
    let highest = heights.iter().copied().fold(f32::MIN, f32::max);
    let toward = [(STEP * x / across) as f32, (STEP * y / across) as f32];
    let rise = (STEP * step * z / across) as f32;
    let start = 1e-4 * step as f32;
    let at = |i: i32, j: i32| {
        let (i, j) = (i.rem_euclid(n as i32), j.rem_euclid(n as i32));
        heights[j as usize * n + i as usize]
    };
    let clears = |index: usize| {
        let (column, row) = (index % side * stride, index / side * stride);
        let (i, j) = (column as f32, row as f32);
        let from = heights[row * n + column] + start;
        for turn in 1.. {
            let t = turn as f32;
            let height = from + t * rise;
            if height > highest {
                break;
            }
            let (px, py) = (i + t * toward[0], j + t * toward[1]);
            let (cx, cy) = (px.floor(), py.floor());
            let (a, b) = (px - cx, py - cy);
            let (cx, cy) = (cx as i32, cy as i32);
            let near = at(cx, cy) * (1.0 - a) + at(cx + 1, cy) * a;
            let far = at(cx, cy + 1) * (1.0 - a) + at(cx + 1, cy + 1) * a;
            if near * (1.0 - b) + far * b > height {
                return 0.0;
            }
        }
        1.0
    };
    (0..side * side).into_par_iter().map(clears).collect()
}
