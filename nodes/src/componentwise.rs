//! Nodes that treat each component alone, and the operations that several of them share.

use crate::port::any;
use mipless_codegen::ir::{Builder, Float};
use mipless_codegen::moments::{Reciprocal, Signal, Transfer};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Node, PortSpec, Range};

/// Two operands of any type.
pub(crate) const OPERANDS: &[PortSpec] = &[
    any("in1", 0.0, "The first operand.").range(Range::soft(-1.0, 1.0)),
    any("in2", 0.0, "The second operand.").range(Range::soft(-1.0, 1.0)),
];

/// `f` of each component of a port.
pub(crate) fn unary<'b>(
    lower: &mut Lower<'_, 'b>,
    node: &Node,
    port: &str,
    mut f: impl FnMut(&mut Lower<'_, 'b>, &Signal<'b>) -> Signal<'b>,
) -> Bundle<'b> {
    let bundle = lower.bundle(node, port);
    bundle.iter().map(|x| f(lower, x)).collect()
}

/// `f` of each pair of components of two ports of the same type.
pub(crate) fn binary<'b>(
    lower: &mut Lower<'_, 'b>,
    node: &Node,
    ports: [&str; 2],
    mut f: impl FnMut(&mut Lower<'_, 'b>, &Signal<'b>, &Signal<'b>) -> Signal<'b>,
) -> Bundle<'b> {
    let [x, y] = ports.map(|port| lower.bundle(node, port));
    x.iter().zip(&y).map(|(x, y)| f(lower, x, y)).collect()
}

/// `f` of each triple of components of three ports of the same type.
pub(crate) fn ternary<'b>(
    lower: &mut Lower<'_, 'b>,
    node: &Node,
    ports: [&str; 3],
    mut f: impl FnMut(&mut Lower<'_, 'b>, &Signal<'b>, &Signal<'b>, &Signal<'b>) -> Signal<'b>,
) -> Bundle<'b> {
    let [x, y, z] = ports.map(|port| lower.bundle(node, port));
    let triples = x.iter().zip(&y).zip(&z);
    triples.map(|((x, y), z)| f(lower, x, y, z)).collect()
}

/// The signals of an input, ready to be read more than once by the node (see
/// [`Algebra::expose`](mipless_codegen::moments::Algebra::expose)).
pub(crate) fn exposed<'b>(lower: &mut Lower<'_, 'b>, node: &Node, port: &str) -> Bundle<'b> {
    let bundle = lower.bundle(node, port);
    bundle.iter().map(|x| lower.algebra.expose(x)).collect()
}

/// `build` with every fresh ε a symbol, since intermediate results are read more than once; the
/// whole has no period unless the node says so.
pub(crate) fn composed<'g, 'b, T>(
    lower: &mut Lower<'g, 'b>,
    build: impl FnOnce(&mut Lower<'g, 'b>) -> T,
) -> T {
    let shares = std::mem::replace(&mut lower.algebra.shares, true);
    let out = build(lower);
    lower.algebra.shares = shares;
    lower.algebra.repeats(None);
    out
}

/// T(X).
pub(crate) fn transfer<'b>(
    lower: &mut Lower<'_, 'b>,
    x: &Signal<'b>,
    t: &dyn Transfer<'b>,
) -> Signal<'b> {
    lower.algebra.transfer(x, t)
}

/// Whether a signal is a number: a position keeps its integer cell, it is none.
fn is_number(x: &Signal<'_>) -> bool {
    x.cell.is_none() && x.is_certain()
}

/// X · Y, which is linear where one of them is certain.
pub(crate) fn product<'b>(lower: &mut Lower<'_, 'b>, x: &Signal<'b>, y: &Signal<'b>) -> Signal<'b> {
    if is_number(y) {
        return scaled(x, y);
    }
    if is_number(x) {
        return scaled(y, x);
    }
    lower.algebra.product(x, y)
}

/// X times a number, which bounds it where both are bounded, an input of the graph too.
fn scaled<'b>(x: &Signal<'b>, by: &Signal<'b>) -> Signal<'b> {
    (x * by.mean).with_range(x.range_of_product(by))
}

/// X / Y: the product with the reciprocal, which is linear where Y is certain.
pub(crate) fn quotient<'b>(
    lower: &mut Lower<'_, 'b>,
    x: &Signal<'b>,
    y: &Signal<'b>,
) -> Signal<'b> {
    if let (Some(numerator), Some(divisor)) = (x.mean.as_constant(), y.mean.as_constant())
        && x.is_certain()
        && y.is_certain()
        && divisor != 0.0
    {
        // A number over a number is rounded once.
        return Signal::constant(lower.b(), numerator / divisor);
    }
    if let Some(divisor) = y.mean.as_constant().filter(|&y| y != 0.0)
        && x.cell.is_some()
        && is_number(y)
    {
        return x.over(divisor);
    }
    let inverse = transfer(lower, y, &Reciprocal);
    product(lower, x, &inverse)
}

/// X − Y; a position keeps its bits where Y is 0.
pub(crate) fn difference<'b>(x: &Signal<'b>, y: &Signal<'b>) -> Signal<'b> {
    if y.mean.is_zero() && is_number(y) {
        x.clone()
    } else {
        x - y
    }
}

/// X + Y; a position keeps its bits where Y is 0.
pub(crate) fn sum<'b>(x: &Signal<'b>, y: &Signal<'b>) -> Signal<'b> {
    if y.mean.is_zero() && is_number(y) {
        x.clone()
    } else {
        x + y
    }
}

/// The means of a port that is a number to the node, one a component; a spread is ignored.
pub(crate) fn numbers<'b>(lower: &Lower<'_, 'b>, node: &Node, port: &str) -> Vec<Float<'b>> {
    lower
        .bundle(node, port)
        .iter()
        .map(Signal::flat_mean)
        .collect()
}

/// The sum; 0 of nothing.
pub(crate) fn total<'b>(b: &'b Builder, terms: impl IntoIterator<Item = Signal<'b>>) -> Signal<'b> {
    let zero = Signal::constant(b, 0.0);
    terms.into_iter().fold(zero, |sum, term| sum + term)
}
