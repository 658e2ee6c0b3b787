//! The pictures that a graph names: decoded by whoever owns the files, and carried with the graph.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::Diagnostic;

/// A decoded picture: rows from the top, the channels of a texel together.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    width: u32,
    height: u32,
    channels: u32,
    encoded: bool,
    numbers: Vec<f32>,
}

impl Picture {
    /// A picture of `channels` numbers a texel: grey, grey and alpha, red green blue, or red green
    /// blue and alpha. `encoded` says that its format holds sRGB numbers from 0 to 1 by convention
    /// (8 and 16 bits), not linear ones.
    ///
    /// # Panics
    /// If a side is 0, there are not 1 to 4 channels, the count of numbers is another, or one of
    /// them is not finite.
    pub fn new(
        (width, height): (u32, u32),
        channels: u32,
        encoded: bool,
        numbers: Vec<f32>,
    ) -> Self {
        let wanted = width as usize * height as usize * channels as usize;
        assert!(width > 0 && height > 0, "{width}×{height} texels");
        assert!((1..=4).contains(&channels), "{channels} channels");
        assert_eq!(numbers.len(), wanted, "numbers of a picture");
        assert!(numbers.iter().all(|x| x.is_finite()), "a finite picture");
        Self {
            width,
            height,
            channels,
            encoded,
            numbers,
        }
    }

    /// Texels in a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Numbers of a texel, 1 to 4; the second of two and the fourth of four are alpha.
    pub fn channels(&self) -> u32 {
        self.channels
    }

    /// Whether the colours are sRGB numbers by the convention of the format.
    pub fn encoded(&self) -> bool {
        self.encoded
    }

    /// All numbers, row by row from the top, texel by texel.
    pub fn numbers(&self) -> &[f32] {
        &self.numbers
    }
}

/// Pictures by the names that a graph gives them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Images(BTreeMap<String, Arc<Picture>>);

impl Images {
    /// Adds the picture that the graph calls `name`.
    pub fn insert(&mut self, name: impl Into<String>, picture: Arc<Picture>) {
        self.0.insert(name.into(), picture);
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// What the graph calls them.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }

    /// The picture that the graph calls `name`.
    pub fn get(&self, name: &str) -> Option<&Arc<Picture>> {
        self.0.get(name)
    }
}

/// A place of a document that names a file.
#[derive(Clone, Debug)]
pub struct FileReference {
    /// The name, as it is written there.
    pub name: String,
    /// The place, as a diagnostic without code and message.
    pub(crate) place: Diagnostic,
}

impl FileReference {
    pub(crate) fn new(name: String, place: Diagnostic) -> Self {
        Self { name, place }
    }

    /// An error at the place.
    pub fn error(&self, code: &'static str, message: impl Into<String>) -> Diagnostic {
        Diagnostic {
            code,
            message: message.into(),
            ..self.place.clone()
        }
    }

    /// A warning at the place.
    pub fn warning(&self, code: &'static str, message: impl Into<String>) -> Diagnostic {
        let warning = Diagnostic::warning(code, message);
        Diagnostic {
            severity: warning.severity,
            ..self.error(code, warning.message)
        }
    }
}
