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

    /// The centre of the pixel at `index`, counted along the rows from the top left.
    pub(crate) fn centre(self, index: usize) -> [f64; 2] {
        let width = self.width as usize;
        [(index % width) as f64 + 0.5, (index / width) as f64 + 0.5]
    }
}
