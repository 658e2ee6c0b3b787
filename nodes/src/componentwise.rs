//! Nodes that treat each component alone, and the operations that several of them share.

use mipless_codegen::ir::{Builder, Value};
use mipless_codegen::moments::{Reciprocal, Signal, Transfer};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Default, Node, PortSpec, PortType, Range};

/// Two operands of any type.
pub(crate) const OPERANDS: &[PortSpec] = &[
    PortSpec::new(
        "in1",
        PortType::Any,
        Default::Float(0.0),
        "The first operand.",
    )
    .range(Range::soft(-1.0, 1.0)),
    PortSpec::new(
        "in2",
        PortType::Any,
        Default::Float(0.0),
        "The second operand.",
    )
    .range(Range::soft(-1.0, 1.0)),
];

/// `f` of each component of a port.
pub(crate) fn unary(
    lower: &mut Lower<'_>,
    node: &Node,
    port: &str,
    mut f: impl FnMut(&mut Lower<'_>, &Signal) -> Signal,
) -> Bundle {
    let bundle = lower.bundle(node, port);
    bundle.iter().map(|x| f(lower, x)).collect()
}

/// `f` of each pair of components of two ports of the same type.
pub(crate) fn binary(
    lower: &mut Lower<'_>,
    node: &Node,
    [first, second]: [&str; 2],
    mut f: impl FnMut(&mut Lower<'_>, &Signal, &Signal) -> Signal,
) -> Bundle {
    let (x, y) = (lower.bundle(node, first), lower.bundle(node, second));
    x.iter().zip(&y).map(|(x, y)| f(lower, x, y)).collect()
}

/// `f` of each triple of components of three ports of the same type.
pub(crate) fn ternary(
    lower: &mut Lower<'_>,
    node: &Node,
    [first, second, third]: [&str; 3],
    mut f: impl FnMut(&mut Lower<'_>, &Signal, &Signal, &Signal) -> Signal,
) -> Bundle {
    let (x, y) = (lower.bundle(node, first), lower.bundle(node, second));
    let z = lower.bundle(node, third);
    x.iter()
        .zip(&y)
        .zip(&z)
        .map(|((x, y), z)| f(lower, x, y, z))
        .collect()
}

/// The signals of an input, ready to be read more than once by the node (see
/// [`Algebra::expose`](mipless_codegen::moments::Algebra::expose)).
pub(crate) fn exposed(lower: &mut Lower<'_>, node: &Node, port: &str) -> Bundle {
    let bundle = lower.bundle(node, port);
    bundle.iter().map(|x| lower.algebra.expose(x)).collect()
}

/// `build` with every fresh ε a symbol, since intermediate results are read more than once; the
/// whole has no period unless the node says so.
pub(crate) fn composed<T>(lower: &mut Lower<'_>, build: impl FnOnce(&mut Lower<'_>) -> T) -> T {
    let shares = std::mem::replace(&mut lower.algebra.shares, true);
    let out = build(lower);
    lower.algebra.shares = shares;
    lower.algebra.repeats(None);
    out
}

/// T(X).
pub(crate) fn transfer(lower: &mut Lower<'_>, x: &Signal, t: &dyn Transfer) -> Signal {
    lower.algebra.transfer(x, t)
}

/// X · Y, which is linear where one of them is certain.
pub(crate) fn product(lower: &mut Lower<'_>, x: &Signal, y: &Signal) -> Signal {
    let b = lower.b();
    // A position keeps its integer cell where the other factor is the number.
    if y.cell.is_none() && y.is_certain(b) {
        return scaled(b, x, y);
    }
    if x.cell.is_none() && x.is_certain(b) {
        return scaled(b, y, x);
    }
    lower.algebra.product(x, y)
}

/// X times a number, which bounds it where both are bounded, an input of the graph too.
fn scaled(b: &mut Builder, x: &Signal, by: &Signal) -> Signal {
    let range = x.range_of_product(by);
    x.scale(b, by.mean).with_range(range)
}

/// X / Y: the product with the reciprocal, which is linear where Y is certain.
pub(crate) fn quotient(lower: &mut Lower<'_>, x: &Signal, y: &Signal) -> Signal {
    let b = lower.b();
    let constants = (b.as_constant(x.mean), b.as_constant(y.mean));
    if let (Some(numerator), Some(divisor)) = constants
        && x.is_certain(b)
        && y.is_certain(b)
        && divisor != 0.0
    {
        // A number over a number is rounded once.
        return Signal::constant(b, numerator / divisor);
    }
    let inverse = transfer(lower, y, &Reciprocal);
    product(lower, x, &inverse)
}

/// X − Y; a position keeps its bits where Y is 0.
pub(crate) fn difference(lower: &mut Lower<'_>, x: &Signal, y: &Signal) -> Signal {
    let b = lower.b();
    if y.cell.is_none() && b.is_zero(y.mean) && y.is_certain(b) {
        x.clone()
    } else {
        x.sub(b, y)
    }
}

/// X + Y; a position keeps its bits where Y is 0.
pub(crate) fn sum(lower: &mut Lower<'_>, x: &Signal, y: &Signal) -> Signal {
    let b = lower.b();
    if y.cell.is_none() && b.is_zero(y.mean) && y.is_certain(b) {
        x.clone()
    } else {
        x.add(b, y)
    }
}

/// X + M(Y − X): what X and Y share, and M with them, keeps its covariance.
pub(crate) fn mixed(lower: &mut Lower<'_>, bg: &Signal, fg: &Signal, mask: &Signal) -> Signal {
    lower.algebra.mix(bg, fg, mask)
}

/// The means of a port that is a number to the node, one a component; a spread is ignored.
pub(crate) fn numbers(lower: &mut Lower<'_>, node: &Node, port: &str) -> Vec<Value> {
    let bundle = lower.bundle(node, port);
    bundle
        .iter()
        .map(|signal| signal.flat_mean(lower.b()))
        .collect()
}

/// max(X, Y).
pub(crate) fn maximum(lower: &mut Lower<'_>, x: &Signal, y: &Signal) -> Signal {
    lower.algebra.maximum(x, y)
}

/// min(X, Y).
pub(crate) fn minimum(lower: &mut Lower<'_>, x: &Signal, y: &Signal) -> Signal {
    lower.algebra.minimum(x, y)
}
