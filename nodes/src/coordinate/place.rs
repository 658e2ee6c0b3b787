//! Where coordinates are, and what is measured from a centre.

use crate::componentwise::difference;
use crate::port;
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Node, PortSpec};

/// The coordinates that a node changes.
pub(crate) const TEXCOORD: PortSpec = port::surface("The coordinates.");

/// Where they are measured from.
pub(crate) const CENTER: PortSpec = port::pair("center", [0.5, 0.5], "The centre.").unit("uv");

/// The centre, and the coordinates from there.
pub(crate) fn centred<'b>(lower: &Lower<'_, 'b>, node: &Node) -> (Bundle<'b>, [Signal<'b>; 2]) {
    let (texcoord, centre) = (lower.bundle(node, "texcoord"), lower.bundle(node, "center"));
    let from = [0, 1].map(|i| difference(&texcoord[i], &centre[i]));
    (centre, from)
}
