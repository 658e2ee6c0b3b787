//! One figure around a centre: 1 inside, 0 outside.

use super::measure::Measure;
use super::region::{Outline, Whitening, disc};
use super::separable::{finished_signal, rest_of_two};
use super::soft::{self, Edge};
use super::touch::Touch;
use crate::componentwise::difference;
use crate::noise::field::{Field, Spread};
use mipless_codegen::ir::{Builder, Value};
use mipless_codegen::moments::{Mode, Signal};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::Node;

/// What is drawn.
pub(crate) enum Figure {
    /// A disc of a radius.
    Disc {
        /// The radius.
        radius: Value,
    },
    /// A polygon: A, B and E of its outline.
    Polygon {
        /// The outline.
        outline: Outline,
        /// A, B, E.
        axes: [[Value; 2]; 3],
    },
    /// A polygon with another origin; a point belongs to it by its distance from the segment E.
    Line {
        /// The outline.
        outline: Outline,
        /// A, B, E.
        axes: [[Value; 2]; 3],
        /// The origin, from the centre.
        from: [Value; 2],
    },
}

/// The figure at `texcoord` around `center`.
pub(crate) fn drawn(
    lower: &mut Lower<'_>,
    node: &Node,
    figure: impl FnOnce(&mut Lower<'_>) -> Figure,
) -> Bundle {
    drawn_softly(lower, node, None, figure)
}

/// The same with an edge that is a ramp of this width.
pub(crate) fn drawn_softly(
    lower: &mut Lower<'_>,
    node: &Node,
    ramp: Option<Value>,
    figure: impl FnOnce(&mut Lower<'_>) -> Figure,
) -> Bundle {
    let (texcoord, centre) = (lower.bundle(node, "texcoord"), lower.bundle(node, "center"));
    let position = [0, 1].map(|i| {
        let from = difference(lower, &texcoord[i], &centre[i]);
        from.flat(lower.b())
    });
    let figure = figure(lower);
    let b = lower.b();
    let ramp = ramp.filter(|&width| !b.is_zero(width));
    let ramp = ramp.map(|width| soft::width(b, width));
    let certain = position.iter().all(|axis| axis.is_certain(b));
    let back = [b.neg(position[0].mean), b.neg(position[1].mean)];
    let soft = ramp.map(|width| (edge(lower, &figure, back), width));
    if lower.mode() == Mode::Point || certain {
        let value = match &soft {
            Some((edge, width)) => soft::value(lower.b(), edge, *width),
            None => point(lower, &figure, back),
        };
        let signal = Signal::certain(lower.b(), value);
        return vec![finished_signal(lower, signal, soft.is_none())];
    }
    let spread = Spread::of(lower.b(), &position);
    let measure = match &figure {
        Figure::Disc { radius } => disc(lower, back, *radius, &spread),
        Figure::Polygon { outline, axes } => {
            let b = lower.b();
            // The axes are of one length, and orthogonal.
            let size = b.dot(&axes[0], &axes[0]);
            let size = b.sqrt(size);
            let edges = outline.distances().map(|distance| b.scale(size, distance));
            let square = b.dot(&back, &back);
            let touch = Touch::between(b, square, edges, spread.covariance);
            polygon(lower, outline, (back, touch), axes, &spread)
        }
        Figure::Line {
            outline,
            axes,
            from,
        } => {
            let b = lower.b();
            let back = [b.add(back[0], from[0]), b.add(back[1], from[1])];
            let square = aside(b, back, axes[2]);
            // The arcs are polygons, of whose corners some lie a little outside.
            let [x, y, _] = outline.vertices[0];
            let outer = x.hypot(y);
            let size = b.dot(&axes[0], &axes[0]);
            let size = b.sqrt(size);
            let edges = [2.0 - outer, outer].map(|distance| b.scale(size, distance));
            let touch = Touch::between(b, square, edges, spread.covariance);
            polygon(lower, outline, (back, touch), axes, &spread)
        }
    };
    let field = match &soft {
        Some((edge, width)) => soft::field(lower, measure, edge, *width, &spread),
        None => sharp(lower, measure, &spread),
    };
    let signal = field.at(lower, &position);
    vec![finished_signal(lower, signal, soft.is_none())]
}

/// Where the edge is, from the mean.
fn edge(lower: &mut Lower<'_>, figure: &Figure, back: [Value; 2]) -> Edge {
    match figure {
        Figure::Disc { radius } => Edge::of_disc(lower.b(), back, *radius),
        Figure::Polygon {
            outline,
            axes: [a, c, e],
        } => Edge::of_polygon(lower, outline, [back, *a, *c, *e]),
        Figure::Line {
            outline,
            axes: [a, c, e],
            from,
        } => {
            let b = lower.b();
            let start = [b.add(back[0], from[0]), b.add(back[1], from[1])];
            Edge::of_polygon(lower, outline, [start, *a, *c, *e])
        }
    }
}

/// A measure as the field of a figure that is 0 or 1.
pub(crate) fn sharp(lower: &mut Lower<'_>, measure: Measure, spread: &Spread) -> Field {
    let mode = lower.mode();
    let b = lower.b();
    let zero = b.f32(0.0);
    let [value, dx, dy, xx, xy, yy] = measure;
    let slopes = matches!(mode, Mode::Local | Mode::Quad);
    let bends = mode == Mode::Quad;
    let mut field = Field {
        mean: b.clamp(value, 0.0, 1.0),
        gradient: [dx, dy].map(|v| if slopes { v } else { zero }),
        hessian: [xx, xy, yy].map(|v| if bends { v } else { zero }),
        rest: zero,
    };
    if mode.spreads() {
        field.rest = rest_of_two(b, &mut field, spread);
    }
    field
}

fn polygon(
    lower: &mut Lower<'_>,
    outline: &Outline,
    (back, touch): ([Value; 2], Touch),
    [a, c, e]: &[[Value; 2]; 3],
    spread: &Spread,
) -> Measure {
    let key = format!("outline {outline:?}");
    let function = lower.function(&key, |module| outline.function(module));
    let b = lower.b();
    let whitening = Whitening::of(b, spread.covariance);
    outline.measure(b, &function, (&whitening, touch), [back, *a, *c, *e])
}

/// The squared distance of the mean from a segment; its start is at an offset from the mean.
fn aside(b: &mut Builder, start: [Value; 2], along: [Value; 2]) -> Value {
    let place = start.map(|x| b.neg(x));
    let square = b.dot(&along, &along);
    let least = b.f32(1e-30);
    let square = b.max(square, least);
    let share = b.dot(&place, &along);
    let share = b.div(share, square);
    let share = b.clamp(share, 0.0, 1.0);
    let across = [0, 1].map(|k| {
        let along = b.mul(share, along[k]);
        b.sub(place[k], along)
    });
    b.dot(&across, &across)
}

/// 1 inside, 0 outside.
fn point(lower: &mut Lower<'_>, figure: &Figure, back: [Value; 2]) -> Value {
    let b = lower.b();
    let (zero, one) = (b.f32(0.0), b.f32(1.0));
    let inside = match figure {
        Figure::Disc { radius } => {
            let (distance, reach) = (b.dot(&back, &back), b.square(*radius));
            b.lt(distance, reach)
        }
        Figure::Polygon {
            outline,
            axes: [a, c, e],
        } => outline.holds(b, [back, *a, *c, *e]),
        Figure::Line {
            axes: [a, _, e],
            from,
            ..
        } => {
            let start = [b.add(back[0], from[0]), b.add(back[1], from[1])];
            let (distance, reach) = (aside(b, start, *e), b.dot(a, a));
            b.lt(distance, reach)
        }
    };
    b.select(inside, one, zero)
}
