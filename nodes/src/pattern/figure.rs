//! One figure around a centre: 1 inside, 0 outside.

use super::disc::disc;
use super::measure::Measure;
use super::region::{Axes, Outline, Whitening};
use super::separable::{finished_signal, rest_of_two};
use super::soft::{self, Edge};
use super::touch::Touch;
use crate::componentwise::difference;
use crate::noise::field::{Field, Spread};
use mipless_codegen::ir::{Float, Sym2, Vec2};
use mipless_codegen::moments::{Mode, Signal};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::Node;

/// What is drawn.
pub(crate) enum Figure<'b> {
    /// A disc of a radius.
    Disc {
        /// The radius.
        radius: Float<'b>,
    },
    /// A polygon: A, B and E of its outline.
    Polygon {
        /// The outline.
        outline: Outline,
        /// A, B, E.
        axes: [[Float<'b>; 2]; 3],
    },
    /// A polygon with another origin; a point belongs to it by its distance from the segment E.
    Line {
        /// The outline.
        outline: Outline,
        /// A, B, E.
        axes: [[Float<'b>; 2]; 3],
        /// The origin, from the centre.
        from: [Float<'b>; 2],
    },
}

/// The figure at `texcoord` around `center`.
pub(crate) fn drawn<'b>(
    lower: &mut Lower<'_, 'b>,
    node: &Node,
    figure: impl FnOnce(&mut Lower<'_, 'b>) -> Figure<'b>,
) -> Bundle<'b> {
    drawn_softly(lower, node, None, figure)
}

/// The same with an edge that is a ramp of this width.
pub(crate) fn drawn_softly<'b>(
    lower: &mut Lower<'_, 'b>,
    node: &Node,
    ramp: Option<Float<'b>>,
    figure: impl FnOnce(&mut Lower<'_, 'b>) -> Figure<'b>,
) -> Bundle<'b> {
    let (texcoord, centre) = (lower.bundle(node, "texcoord"), lower.bundle(node, "center"));
    let position = [0, 1].map(|i| difference(&texcoord[i], &centre[i]).flat());
    let figure = figure(lower);
    let ramp = ramp.filter(|width| !width.is_zero()).map(soft::width);
    let back = [-position[0].mean, -position[1].mean];
    let soft = ramp.map(|width| (edge(lower, &figure, back), width));
    if lower.mode() == Mode::Point || position.iter().all(Signal::is_certain) {
        let value = match &soft {
            Some((edge, width)) => soft::value(edge, *width),
            None => point(&figure, back),
        };
        return vec![finished_signal(
            lower,
            Signal::certain(value),
            soft.is_none(),
        )];
    }
    let spread = Spread::of(&position);
    let measure = measure(lower, &figure, back, &spread);
    let field = match &soft {
        Some((edge, width)) => soft::field(lower.mode(), measure, edge, *width, &spread),
        None => sharp(lower.mode(), measure, &spread),
    };
    let signal = field.at(lower, &position);
    vec![finished_signal(lower, signal, soft.is_none())]
}

/// The measure of a figure whose centre is at an offset from the mean.
fn measure<'b>(
    lower: &mut Lower<'_, 'b>,
    figure: &Figure<'b>,
    back: [Float<'b>; 2],
    spread: &Spread<'b>,
) -> Measure<'b> {
    match figure {
        Figure::Disc { radius } => disc(lower, back, *radius, spread),
        Figure::Polygon { outline, axes } => {
            // The axes are of one length, and orthogonal.
            let size = Vec2(axes[0]).norm2().sqrt();
            let edges = outline.distances().map(|distance| size * distance);
            let touch = Touch::between(Vec2(back).norm2(), edges, spread.covariance);
            polygon(lower, outline, touch, framed(back, axes), spread)
        }
        Figure::Line {
            outline,
            axes,
            from,
        } => {
            let start = moved(back, *from);
            // The arcs are polygons, of whose corners some lie a little outside.
            let [x, y, _] = outline.vertices[0];
            let outer = x.hypot(y);
            let size = Vec2(axes[0]).norm2().sqrt();
            let edges = [2.0 - outer, outer].map(|distance| size * distance);
            let touch = Touch::between(aside(start, axes[2]), edges, spread.covariance);
            polygon(lower, outline, touch, framed(start, axes), spread)
        }
    }
}

/// The sum of two offsets.
fn moved<'b>(back: [Float<'b>; 2], from: [Float<'b>; 2]) -> [Float<'b>; 2] {
    [back[0] + from[0], back[1] + from[1]]
}

/// The frame of an outline with its origin at an offset from the mean.
fn framed<'b>(origin: [Float<'b>; 2], [a, c, e]: &[[Float<'b>; 2]; 3]) -> Axes<'b> {
    [origin, *a, *c, *e]
}

/// Where the edge is, from the mean.
fn edge<'b>(lower: &mut Lower<'_, 'b>, figure: &Figure<'b>, back: [Float<'b>; 2]) -> Edge<'b> {
    match figure {
        Figure::Disc { radius } => Edge::of_disc(back, *radius),
        Figure::Polygon { outline, axes } => {
            let centre = Vec2(back).norm2().sqrt();
            Edge::of_polygon(lower, outline, framed(back, axes), centre)
        }
        Figure::Line {
            outline,
            axes,
            from,
        } => {
            let start = moved(back, *from);
            let centre = aside(start, axes[2]).sqrt();
            Edge::of_polygon(lower, outline, framed(start, axes), centre)
        }
    }
}

/// A measure as the field of a figure that is 0 or 1.
pub(crate) fn sharp<'b>(mode: Mode, measure: Measure<'b>, spread: &Spread<'b>) -> Field<'b> {
    let [value, dx, dy, xx, xy, yy] = measure;
    let zero = value.literal(0.0);
    let slopes = matches!(mode, Mode::Local | Mode::Quad);
    let bends = mode == Mode::Quad;
    let mut field = Field {
        mean: value.clamp(0.0, 1.0),
        gradient: Vec2([dx, dy]).map(|v| if slopes { v } else { zero }),
        hessian: Sym2([xx, xy, yy]).map(|v| if bends { v } else { zero }),
        rest: zero,
    };
    if mode.spreads() {
        field.rest = rest_of_two(&mut field, spread);
    }
    field
}

fn polygon<'b>(
    lower: &mut Lower<'_, 'b>,
    outline: &Outline,
    touch: Touch<'b>,
    axes: Axes<'b>,
    spread: &Spread<'b>,
) -> Measure<'b> {
    let key = format!("outline {outline:?}");
    let function = lower.function(&key, |module| outline.function(module));
    let whitening = Whitening::of(spread.covariance);
    outline.measure(&function, (&whitening, touch), axes)
}

/// The squared distance of the mean from a segment; its start is at an offset from the mean.
fn aside<'b>(start: [Float<'b>; 2], along: [Float<'b>; 2]) -> Float<'b> {
    let (place, along) = (-Vec2(start), Vec2(along));
    let share = (place.dot(along) / along.norm2().max(1e-30)).clamp(0.0, 1.0);
    (place - along * share).norm2()
}

/// 1 inside, 0 outside.
fn point<'b>(figure: &Figure<'b>, back: [Float<'b>; 2]) -> Float<'b> {
    let inside = match figure {
        Figure::Disc { radius } => Vec2(back).norm2().lt(radius.square()),
        Figure::Polygon { outline, axes } => outline.holds(framed(back, axes)),
        Figure::Line { axes, from, .. } => {
            aside(moved(back, *from), axes[2]).lt(Vec2(axes[0]).norm2())
        }
    };
    inside.select(1.0, 0.0)
}
