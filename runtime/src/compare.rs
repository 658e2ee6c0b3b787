//! Pictures side by side, with a caption under each.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

use crate::image::Image;
use crate::srgb::linear_from_srgb;
use crate::view::Size;

/// One picture and its caption.
#[derive(Clone, Debug)]
pub struct Panel<'a> {
    /// The picture: `R,G,B[,A]`, or `Y` for grey. Vectors show as colours.
    pub image: &'a Image,
    /// The first line, in bold: a name.
    pub title: &'a str,
    /// The second line: for instance an error. Text that is too long for the panel is cut.
    pub detail: &'a str,
}

const GAP: usize = 8;
const TEXT: RasterHeight = RasterHeight::Size16;
const LINE: usize = 20;

/// How heavy letters are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ink {
    /// Text.
    Regular,
    /// Names.
    Bold,
}

/// sRGB grey levels of the paper and of the ink.
const PAPER: f32 = 0.96;
const INK: f32 = 0.12;

/// The panels from left to right on light paper, as one linear `R,G,B` image.
///
/// # Panics
/// If there is no panel.
pub fn compose(panels: &[Panel<'_>]) -> Image {
    assert!(!panels.is_empty(), "a comparison of nothing");
    let widths = panels.iter().map(|panel| panel.image.width() as usize);
    let width = widths.sum::<usize>() + GAP * (panels.len() + 1);
    let tallest = panels
        .iter()
        .map(|panel| panel.image.height() as usize)
        .max()
        .unwrap_or(0);
    let height = tallest + 3 * GAP + 2 * LINE;
    let size = Size::new(width as u32, height as u32);
    let paper = vec![vec![linear_from_srgb(PAPER); size.pixels()]; 3];
    let mut sheet = Image::new(size, &["R", "G", "B"], paper);
    let mut left = GAP;
    for panel in panels {
        place(&mut sheet, panel.image, left, GAP);
        let room = panel.image.width() as usize;
        let top = tallest + 2 * GAP;
        caption(&mut sheet, panel.title, Ink::Bold, [left, top], room);
        caption(
            &mut sheet,
            panel.detail,
            Ink::Regular,
            [left, top + LINE],
            room,
        );
        left += room + GAP;
    }
    sheet
}

fn place(sheet: &mut Image, image: &Image, left: usize, top: usize) {
    let (width, stride) = (image.width() as usize, sheet.width() as usize);
    let alpha = image.channel("A");
    for (c, target) in sheet.channels_mut().iter_mut().enumerate() {
        let source = match image.channels() {
            [grey] => Some(grey),
            channels => channels.get(c),
        };
        for row in 0..image.height() as usize {
            for column in 0..width {
                let from = row * width + column;
                let to = (top + row) * stride + left + column;
                let value = source.map_or(0.0, |channel| channel[from]);
                let share = alpha.map_or(1.0, |alpha| alpha[from].clamp(0.0, 1.0));
                target[to] = share * value + (1.0 - share) * target[to];
            }
        }
    }
}

/// Writes one line, cut to `room` pixels. Characters that the font does not have become `?`.
pub(crate) fn caption(
    sheet: &mut Image,
    text: &str,
    weight: Ink,
    [left, top]: [usize; 2],
    room: usize,
) {
    let weight = match weight {
        Ink::Regular => FontWeight::Regular,
        Ink::Bold => FontWeight::Bold,
    };
    let advance = get_raster_width(weight, TEXT);
    let stride = sheet.width() as usize;
    for (place, character) in text.chars().take(room / advance).enumerate() {
        let raster = get_raster(character, weight, TEXT).or_else(|| get_raster('?', weight, TEXT));
        let Some(raster) = raster else { continue };
        for (row, line) in raster.rows().enumerate() {
            for (column, &ink) in line.iter().enumerate() {
                let share = f32::from(ink) / 255.0;
                let grey = linear_from_srgb(PAPER + share * (INK - PAPER));
                let at = (top + row) * stride + left + place * advance + column;
                sheet
                    .channels_mut()
                    .iter_mut()
                    .for_each(|channel| channel[at] = grey);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_stand_side_by_side_over_their_captions() {
        let size = Size::new(60, 30);
        let red = Image::new(
            size,
            &["R", "G", "B"],
            vec![vec![1.0; 1800], vec![0.0; 1800], vec![0.0; 1800]],
        );
        let grey = Image::new(Size::new(40, 20), &["Y"], vec![vec![0.25; 800]]);
        let sheet = compose(&[
            Panel {
                image: &red,
                title: "point",
                detail: "RMS 0.0123 and too much more",
            },
            Panel {
                image: &grey,
                title: "",
                detail: "",
            },
        ]);
        assert_eq!(sheet.size(), Size::new(60 + 40 + 3 * 8, 30 + 3 * 8 + 40));
        let at = |c: usize, x: usize, y: usize| sheet.channels()[c][y * 124 + x];
        let paper = linear_from_srgb(PAPER);
        assert_eq!([at(0, 8, 8), at(1, 67, 37)], [1.0, 0.0]);
        assert_eq!([at(0, 76, 8), at(2, 115, 27)], [0.25, 0.25]);
        assert_eq!([at(0, 0, 0), at(1, 70, 20), at(1, 76, 28)], [paper; 3]);
        let dark = |xs: std::ops::Range<usize>, ys: std::ops::Range<usize>| {
            ys.flat_map(|y| xs.clone().map(move |x| (x, y)))
                .filter(|&(x, y)| at(0, x, y) < 0.2)
                .count()
        };
        assert!(dark(8..68, 46..66) > 30, "the title is there");
        assert!(dark(8..68, 66..86) > 30, "the detail is there");
        assert_eq!(
            dark(68..124, 46..94),
            0,
            "the long caption does not reach its neighbour"
        );
    }
}
