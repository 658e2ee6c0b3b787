//! Which moments of a pattern are asked for.

/// Which moments are asked for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wanted {
    /// The mean and so many derivatives: 1, 3 or 6.
    pub(crate) orders: usize,
    /// Whether the mean of the square is.
    pub(crate) squared: bool,
}

/// Names of the moments.
pub(crate) fn names(of: Wanted) -> Vec<&'static str> {
    let all = ["mean", "dx", "dy", "dxx", "dxy", "dyy"];
    let mut names = all[..of.orders].to_vec();
    names.extend(of.squared.then_some("square"));
    names
}
