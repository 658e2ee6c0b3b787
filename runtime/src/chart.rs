//! A chart of error against cost, both on logarithmic scales.

use crate::compare::{Ink, caption};
use crate::image::Image;
use crate::srgb::linear_from_srgb;
use crate::view::Size;

/// A point of the chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// What is written beside it.
    pub label: String,
    /// Where, from left to right; above 0.
    pub x: f64,
    /// Where, from the bottom up; 0 and less stand on the lower edge.
    pub y: f64,
    /// Whether it is on the line of the best ones.
    pub best: bool,
}

/// A chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart<'a> {
    /// The first line.
    pub title: &'a str,
    /// The unit of x.
    pub x: &'a str,
    /// The unit of y, written above the axis.
    pub y: &'a str,
    /// What is below this cannot be told from 0; a line, if it is above 0.
    pub floor: f64,
    /// The points.
    pub marks: &'a [Mark],
}

const SIZE: [usize; 2] = [960, 600];
/// Left, top, right and bottom edge of the plot, in pixels.
const PLOT: [usize; 4] = [80, 64, 930, 540];
const RED: [f32; 3] = [0.75, 0.22, 0.17];
const BLUE: [f32; 3] = [0.16, 0.42, 0.70];
const GREY: [f32; 3] = [0.85, 0.85, 0.85];
const DARK: [f32; 3] = [0.45, 0.45, 0.45];

/// A logarithmic scale over whole decades.
struct Scale {
    low: i32,
    high: i32,
}

impl Scale {
    /// The decades that hold all numbers above 0.
    fn of(numbers: impl Iterator<Item = f64> + Clone) -> Self {
        let logs = numbers
            .filter(|x| *x > 0.0 && x.is_finite())
            .map(f64::log10);
        let low = logs.clone().fold(f64::INFINITY, f64::min);
        let high = logs.fold(f64::NEG_INFINITY, f64::max);
        if low > high {
            return Self { low: -1, high: 1 };
        }
        let low = low.floor() as i32;
        let high = (high.ceil() as i32).max(low + 1);
        Self { low, high }
    }

    /// The share of the way from the low to the high end.
    fn share(&self, x: f64) -> f64 {
        let log = x.max(f64::MIN_POSITIVE).log10() - f64::from(self.low);
        (log / f64::from(self.high - self.low)).clamp(0.0, 1.0)
    }
}

/// Draws a chart, as a linear `R,G,B` image.
pub fn draw(chart: &Chart<'_>) -> Image {
    let [width, height] = SIZE;
    let size = Size::new(width as u32, height as u32);
    let paper = linear_from_srgb(0.98);
    let mut sheet = Image::new(size, &["R", "G", "B"], vec![vec![paper; width * height]; 3]);
    let floor = (chart.floor > 0.0).then_some(chart.floor);
    let x = Scale::of(chart.marks.iter().map(|mark| mark.x));
    let y = Scale::of(chart.marks.iter().map(|mark| mark.y).chain(floor));
    let [left, top, right, bottom] = PLOT;
    let column = |number: f64| left as f64 + x.share(number) * (right - left) as f64;
    let row = |number: f64| bottom as f64 - y.share(number) * (bottom - top) as f64;

    caption(&mut sheet, chart.title, Ink::Bold, [left, 12], right - left);
    caption(&mut sheet, chart.y, Ink::Regular, [left, 36], right - left);
    let below = [
        right.saturating_sub(8 * chart.x.chars().count()),
        bottom + 32,
    ];
    caption(&mut sheet, chart.x, Ink::Regular, below, width - below[0]);
    for decade in x.low..=x.high {
        let at = column(10f64.powi(decade));
        line(&mut sheet, [at, top as f64], [at, bottom as f64], GREY);
        let text = decimal(decade);
        let start = (at as usize).saturating_sub(4 * text.len());
        caption(&mut sheet, &text, Ink::Regular, [start, bottom + 8], 80);
    }
    for decade in y.low..=y.high {
        let at = row(10f64.powi(decade));
        line(&mut sheet, [left as f64, at], [right as f64, at], GREY);
        let text = decimal(decade);
        let start = (left - 8).saturating_sub(8 * text.len());
        caption(
            &mut sheet,
            &text,
            Ink::Regular,
            [start, at as usize - 8],
            80,
        );
    }
    if let Some(floor) = floor {
        let at = row(floor);
        line(&mut sheet, [left as f64, at], [right as f64, at], DARK);
        let place = [left + 8, (at as usize).saturating_sub(18)];
        caption(&mut sheet, "noise of the truth", Ink::Regular, place, 200);
    }

    let mut best: Vec<&Mark> = chart.marks.iter().filter(|mark| mark.best).collect();
    best.sort_by(|a, b| a.x.total_cmp(&b.x));
    for pair in best.windows(2) {
        let [a, b] = [pair[0], pair[1]].map(|mark| [column(mark.x), row(mark.y)]);
        line(&mut sheet, a, b, RED);
    }
    // Labels avoid each other: the later one moves down, or to the left of its mark at the edge.
    let mut taken: Vec<[usize; 3]> = Vec::new();
    for mark in chart.marks {
        let (at_x, at_y) = (column(mark.x), row(mark.y));
        disc(&mut sheet, [at_x, at_y], if mark.best { RED } else { BLUE });
        let length = 8 * mark.label.chars().count();
        let mut start = at_x as usize + 8;
        if start + length > width {
            start = (at_x as usize).saturating_sub(length + 8);
        }
        let mut row = (at_y as usize).saturating_sub(18);
        let meets = |row: usize, other: &[usize; 3]| {
            start < other[1] && other[0] < start + length && row.abs_diff(other[2]) < 15
        };
        while row + 40 < height && taken.iter().any(|other| meets(row, other)) {
            row += 5;
        }
        taken.push([start, start + length, row]);
        let ink = if mark.best { Ink::Bold } else { Ink::Regular };
        caption(&mut sheet, &mark.label, ink, [start, row], width - start);
    }
    sheet
}

fn decimal(decade: i32) -> String {
    if decade >= 0 {
        format!("{}", 10f64.powi(decade))
    } else {
        format!("{:.*}", decade.unsigned_abs() as usize, 10f64.powi(decade))
    }
}

fn dot(sheet: &mut Image, x: usize, y: usize, colour: [f32; 3]) {
    let (width, height) = (sheet.width() as usize, sheet.height() as usize);
    if x < width && y < height {
        for (channel, colour) in sheet.channels_mut().iter_mut().zip(colour) {
            channel[y * width + x] = linear_from_srgb(colour);
        }
    }
}

fn line(sheet: &mut Image, from: [f64; 2], to: [f64; 2], colour: [f32; 3]) {
    let steps = (to[0] - from[0])
        .abs()
        .max((to[1] - from[1]).abs())
        .ceil()
        .max(1.0);
    for step in 0..=steps as usize {
        let share = step as f64 / steps;
        let at = [0, 1].map(|i| (from[i] + share * (to[i] - from[i])).round() as usize);
        dot(sheet, at[0], at[1], colour);
    }
}

fn disc(sheet: &mut Image, [x, y]: [f64; 2], colour: [f32; 3]) {
    for dy in -4i32..=4 {
        for dx in -4i32..=4 {
            if dx * dx + dy * dy <= 18 {
                let at = [x + f64::from(dx), y + f64::from(dy)].map(|at| at.round() as usize);
                dot(sheet, at[0], at[1], colour);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_stand_where_their_logarithms_are() {
        let mark = |label: &str, x, y, best| Mark {
            label: label.to_owned(),
            x,
            y,
            best,
        };
        let marks = [
            mark("a", 1.0, 0.1, true),
            mark("b", 100.0, 0.001, true),
            mark("c", 10.0, 0.1, false),
        ];
        let chart = Chart {
            title: "t",
            x: "cost",
            y: "error",
            floor: 0.0,
            marks: &marks,
        };
        let sheet = draw(&chart);
        let at = |x: usize, y: usize| [0, 1, 2].map(|c| sheet.channels()[c][y * SIZE[0] + x]);
        let [left, top, right, bottom] = PLOT;
        assert_eq!(at(left, top), RED.map(linear_from_srgb), "the cheap one");
        assert_eq!(at(right, bottom), RED.map(linear_from_srgb), "the good one");
        let middle = (left + right) / 2;
        assert_eq!(
            at(middle, top),
            BLUE.map(linear_from_srgb),
            "the beaten one"
        );
        assert_eq!(
            at(middle, (top + bottom) / 2),
            RED.map(linear_from_srgb),
            "the line"
        );
        // Nothing measured is no reason to fail.
        draw(&Chart {
            marks: &[],
            ..chart
        });
    }
}
