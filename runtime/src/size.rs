//! How large a picture is, and where its pixels are.

/// The width and the height of a picture, in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
}

impl Size {
    /// A size.
    ///
    /// # Panics
    /// If a side is 0.
    pub fn new(width: u32, height: u32) -> Self {
        assert!(
            width > 0 && height > 0,
            "a picture of {width}x{height} pixels"
        );
        Self { width, height }
    }

    /// The number of pixels.
    pub fn pixels(self) -> usize {
        self.width as usize * self.height as usize
    }

    /// The sizes of a mip chain: this one, and half of the one before, rounded down, to a single pixel.
    pub fn levels(self) -> Vec<Self> {
        let half = |size: &Self| {
            let is_last = size.width == 1 && size.height == 1;
            let [width, height] = [size.width, size.height].map(|side| (side / 2).max(1));
            (!is_last).then(|| Self::new(width, height))
        };
        std::iter::successors(Some(self), half).collect()
    }

    /// The centre of the pixel at `index`, counted along the rows from the top left.
    pub(crate) fn centre(self, index: usize) -> [f64; 2] {
        let width = self.width as usize;
        [(index % width) as f64 + 0.5, (index / width) as f64 + 0.5]
    }
}

/// A rectangle of the pixels of a picture. What a pixel shows depends on its place in the whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// The size of the whole picture.
    pub whole: Size,
    /// The first column.
    pub left: u32,
    /// The first row.
    pub top: u32,
    /// How many columns and rows there are.
    pub size: Size,
}

impl Part {
    /// All of a picture.
    pub fn all(whole: Size) -> Self {
        Self {
            whole,
            left: 0,
            top: 0,
            size: whole,
        }
    }

    /// Of so many columns and rows of tiles, as nearly alike as whole pixels can be, the one in this
    /// column and row, counted from 0. `None` where there is no such tile, or it has no pixel.
    pub fn tile(whole: Size, [column, row]: [u32; 2], [columns, rows]: [u32; 2]) -> Option<Self> {
        let cut = |length: u32, place: u32, count: u32| {
            let at = |place: u32| (u64::from(length) * u64::from(place) / u64::from(count)) as u32;
            (place < count).then(|| (at(place), at(place + 1) - at(place)))
        };
        let (left, width) = cut(whole.width, column, columns)?;
        let (top, height) = cut(whole.height, row, rows)?;
        (width > 0 && height > 0).then(|| Self {
            whole,
            left,
            top,
            size: Size::new(width, height),
        })
    }

    /// Some of the part's rows.
    ///
    /// # Panics
    /// If it has not so many.
    pub fn rows(self, first: u32, count: u32) -> Self {
        assert!(
            u64::from(first) + u64::from(count) <= u64::from(self.size.height),
            "rows of {self:?}"
        );
        Self {
            top: self.top + first,
            size: Size::new(self.size.width, count),
            ..self
        }
    }

    /// Where in the whole the pixel at `index` of the part is, both counted along the rows.
    pub(crate) fn place(self, index: usize) -> usize {
        let width = self.size.width as usize;
        let (column, row) = (index % width, index / width);
        (self.top as usize + row) * self.whole.width as usize + self.left as usize + column
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_end_at_a_pixel() {
        let sizes = Size::new(10, 3).levels();
        let sides: Vec<[u32; 2]> = sizes.iter().map(|size| [size.width, size.height]).collect();
        assert_eq!(sides, [[10, 3], [5, 1], [2, 1], [1, 1]]);
    }

    #[test]
    fn tiles_cover_every_pixel_once() {
        let whole = Size::new(17, 11);
        let mut seen = vec![0; whole.pixels()];
        for (column, row) in (0..4).flat_map(|column| (0..3).map(move |row| (column, row))) {
            let part = Part::tile(whole, [column, row], [4, 3]).expect("it has pixels");
            for index in 0..part.size.pixels() {
                seen[part.place(index)] += 1;
            }
        }
        assert!(seen.iter().all(|&times| times == 1), "{seen:?}");
        assert_eq!(Part::tile(whole, [4, 0], [4, 3]), None);
        assert_eq!(
            Part::tile(whole, [0, 0], [18, 1]),
            None,
            "no column of pixels"
        );
    }
}
