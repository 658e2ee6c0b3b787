//! A text with gaps where names go.

/// The text of a function, and what it takes for granted.
#[derive(Debug)]
pub(crate) struct Spelled {
    /// Texts, each before a gap but the last.
    pub(super) pieces: Vec<(String, Gap)>,
    /// The names of locals: none is one of the module's.
    pub(super) locals: Vec<String>,
    /// How many parts it has.
    pub(super) parts: usize,
}

/// What goes where a text has a gap.
#[derive(Clone, Copy, Debug)]
pub(super) enum Gap {
    /// Nothing: the end.
    End,
    /// The function's name: of itself, or of one of its callees from 1 on.
    Name(usize),
    /// The same as the name of a type.
    Type(usize),
}
