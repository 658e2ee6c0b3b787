//! The Gaussian measure of polygons.
//!
//! A polygon's measure is the sum over its edges of the triangles from the mean to the edge, in
//! coordinates where the covariance is the identity; such a triangle is two right ones, whose
//! measure is V(h, q) = ∫₀^h φ(x)(Φ(qx/h) − ½) dx (Nicholson 1943; Owen 1956). For q ≤ h,
//! V = (1/2π) ∫₀^{q/h} (1 − e^{−h²(1+x²)/2})/(1 + x²) dx, which four Gauss–Legendre nodes give
//! within 2e-6; else V(h, q) = (Φ(h) − ½)(Φ(q) − ½) − V(q, h). So any covariance is exact.

use super::measure::{Measure, NAMES};
use super::touch::Touch;
use mipless_codegen::ir::{
    Bool, Builder, Float, FunctionRef, Module, Scalar, Scalars, Sym2, Uint, Vec2, dot,
};
use mipless_codegen::moments::Normal;

/// No footprint is narrower than this, in units of the position.
const NARROWEST: f32 = 1e-6;

/// Σ = LLᵀ.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Whitening<'b> {
    /// 1/L₁₁, L₂₁/L₁₁ and 1/L₂₂.
    inverse: [Float<'b>; 3],
}

impl<'b> Whitening<'b> {
    /// Of a covariance; Σ + 1e-12 I, so that nothing divides by 0.
    pub(crate) fn of(covariance: Sym2<'b>) -> Self {
        let [xx, xy, yy] = *covariance;
        let inverse = 1.0 / (xx + NARROWEST * NARROWEST).sqrt();
        let side = xy * inverse;
        let second = ((yy - side.square()).max(0.0) + NARROWEST * NARROWEST).sqrt();
        Self {
            inverse: [inverse, side * inverse, 1.0 / second],
        }
    }

    /// The parameters of a function that takes it over.
    pub(crate) fn declare(b: &'b Builder) -> Self {
        Self {
            inverse: b.float_params(["inverse_x", "ratio", "inverse_y"]),
        }
    }

    /// L⁻¹p.
    fn apply(&self, [x, y]: [Float<'b>; 2]) -> Vec2<'b> {
        let [first, ratio, second] = self.inverse;
        Vec2([x * first, (y - ratio * x) * second])
    }

    /// Derivatives by the whitened mean as derivatives by the mean.
    pub(crate) fn back(&self, m: Measure<'b>) -> Measure<'b> {
        let [first, ratio, second] = self.inverse;
        let [value, dx, dy, xx, xy, yy] = m;
        // L⁻¹ = [[p, 0], [−rs, s]] with p = 1/L₁₁, s = 1/L₂₂ and r = L₂₁/L₁₁.
        let (column, s) = (Vec2([first, -(ratio * second)]), second);
        let bent = Sym2([xx, xy, yy]).times(column);
        [
            value,
            column.dot(Vec2([dx, dy])),
            s * dy,
            column.dot(bent),
            s * bent[1],
            s.square() * yy,
        ]
    }
}

impl<'b> Scalars<'b> for Whitening<'b> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        self.inverse.each(visit);
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        Self {
            inverse: self.inverse.replaced(next),
        }
    }
}

/// V(h, q) with the signs of h and q.
fn triangle<'b>(h: Float<'b>, q: Float<'b>, [at_h, at_q]: [&Normal<'b>; 2]) -> Float<'b> {
    use std::f32::consts::TAU;
    let (p, r) = (h.abs(), q.abs());
    let more = p.max(r);
    let ratio = p.min(r) / more.max(1e-20);
    let square = more.min(12.0).square();
    // Gauss–Legendre on [0, 1].
    let nodes = [
        (0.069_431_844, 0.173_927_42),
        (0.330_009_48, 0.326_072_58),
        (0.669_990_52, 0.326_072_58),
        (0.930_568_16, 0.173_927_42),
    ];
    let terms = nodes.map(|(node, weight): (f32, f32)| {
        let raised = (ratio * node).square() + 1.0;
        let lost = (square * raised * -0.5).max(-80.0).exp();
        (1.0 - lost) / raised * (weight / TAU)
    });
    let near = h.builder().sum(terms) * ratio;
    let beyond_half = |n: &Normal<'b>| ((n.below - n.above) * 0.5).abs();
    let other = beyond_half(at_h) * beyond_half(at_q) - near;
    let value = r.le(p).select(near, other);
    let value = h.lt(0.0).select(-value, value);
    q.lt(0.0).select(-value, value)
}

/// The part of one edge, from whitened ends, seen from the mean at the origin; counter-clockwise
/// edges count positive. Derivatives are by the whitened mean.
fn edge<'b>(from: Vec2<'b>, to: Vec2<'b>) -> Measure<'b> {
    let across = to - from;
    let tangent = across * (1.0 / (across.norm2() + 1e-30).sqrt());
    let [tx, ty] = *tangent;
    // The outward normal of a counter-clockwise polygon.
    let (nx, ny) = (ty, -tx);
    let h = from.dot(Vec2([nx, ny]));
    let (t1, t2) = (from.dot(tangent), to.dot(tangent));
    let [at_h, at_1, at_2] = [h, t1, t2].map(Normal::of);
    let value = triangle(h, t2, [&at_h, &at_2]) - triangle(h, t1, [&at_h, &at_1]);
    let flow = -(at_h.density * (at_2.below - at_1.below));

    // −φ(h) n ⊗ (h ΔΦ n − Δφ t), made symmetric.
    let along = at_h.z * flow;
    let ends = at_h.density * (at_2.density - at_1.density);
    let mix = |p: Float<'b>, q: Float<'b>| along * p + ends * q;
    [
        value,
        nx * flow,
        ny * flow,
        mix(nx * nx, nx * tx),
        mix(nx * ny, (nx * ty + ny * tx) * 0.5),
        mix(ny * ny, ny * ty),
    ]
}

/// The most vertices that are chosen by comparisons.
const FEW: usize = 8;

/// A frame that an outline is drawn in: its origin o, seen from the mean, and the axes A, B and E.
pub(crate) type Axes<'b> = [[Float<'b>; 2]; 4];

/// The place of a vertex.
pub(crate) fn vertex<'b>(numbers: [Float<'b>; 3], [origin, a, b, e]: Axes<'b>) -> [Float<'b>; 2] {
    [0, 1].map(|k| origin[k] + dot(numbers, [a[k], b[k], e[k]]))
}

/// A closed polygon: vertices o + a A + b B + e E, counter-clockwise where A, B is.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Outline {
    /// (a, b, e) of each vertex.
    pub(crate) vertices: Vec<[f32; 3]>,
}

impl Outline {
    /// Corners at equal angles from the first axis; the radii take turns.
    pub(crate) fn around(corners: usize, radii: &[f64], first: f64) -> Self {
        let vertices = (0..corners)
            .map(|i| {
                let angle = first + std::f64::consts::TAU * i as f64 / corners as f64;
                let radius = radii[i % radii.len()];
                [
                    (radius * angle.cos()) as f32,
                    (radius * angle.sin()) as f32,
                    0.0,
                ]
            })
            .collect();
        Self { vertices }
    }

    /// The numbers of the vertex after so many, by the index of an edge: of a few by comparisons, which
    /// cost less than three loads.
    fn chosen<'b>(&self, index: Uint<'b>, after: usize) -> [Float<'b>; 3] {
        let count = self.vertices.len();
        let b = index.builder();
        let last = self.vertices[(count - 1 + after) % count].map(|x| b.float(x));
        (0..count - 1).rev().fold(last, |chosen, i| {
            let here = index.equals(i as u32);
            let vertex = self.vertices[(i + after) % count];
            std::array::from_fn(|k| here.select(vertex[k], chosen[k]))
        })
    }

    /// The numbers of a table: the first vertex comes again at the end.
    pub(crate) fn rows(&self) -> Vec<f32> {
        let again = self.vertices.first();
        (self.vertices.iter().chain(again))
            .flatten()
            .copied()
            .collect()
    }

    /// The parameters of a function that takes a frame.
    pub(crate) fn declare_axes(b: &Builder) -> Axes<'_> {
        ["o", "a", "b", "e"].map(|name| b.float_params([format!("{name}_x"), format!("{name}_y")]))
    }

    /// The body of a fold over the edges. Captures: the whitening, then o (from the mean), A, B, E.
    pub(crate) fn function(&self, module: &mut Module) -> FunctionRef {
        let few = self.vertices.len() <= FEW;
        let table = (!few).then(|| module.table("outline", self.rows()));
        let b = &Builder::new("outline_edge", "One more edge of a polygon.");
        let index = b.uint_param("index");
        let state = b.float_params(NAMES);
        let whitening = Whitening::declare(b);
        let axes = Self::declare_axes(b);
        let [start, end] = [0, 1].map(|after| {
            let numbers = match table {
                None => self.chosen(index, after),
                Some(table) => [0, 1, 2].map(|i| b.load(table, index * 3 + (3 * after + i) as u32)),
            };
            whitening.apply(vertex(numbers, axes))
        });
        b.sums(NAMES, state, edge(start, end));
        b.finish(module)
    }

    /// The distances from the origin of the axes, which lies inside, between which all edges lie: for
    /// orthogonal axes A and B of length 1 and no E.
    pub(crate) fn distances(&self) -> [f32; 2] {
        let corners: Vec<[f32; 2]> = self.vertices.iter().map(|&[x, y, _]| [x, y]).collect();
        let nearest = corners.iter().enumerate().map(|(i, &[x1, y1])| {
            let [x2, y2] = corners[(i + 1) % corners.len()];
            let (dx, dy) = (x2 - x1, y2 - y1);
            let share = -(x1 * dx + y1 * dy) / (dx * dx + dy * dy);
            let share = share.clamp(0.0, 1.0);
            (x1 + share * dx).hypot(y1 + share * dy)
        });
        let farthest = corners.iter().map(|[x, y]| x.hypot(*y));
        [
            nearest.fold(f32::INFINITY, f32::min),
            farthest.fold(0.0, f32::max),
        ]
    }

    /// The measure at a mean that is −o from the origin of the axes.
    pub(crate) fn measure<'b>(
        &self,
        function: &FunctionRef,
        (whitening, touch): (&Whitening<'b>, Touch<'b>),
        axes: Axes<'b>,
    ) -> Measure<'b> {
        let b = axes[0][0].builder();
        let count = touch.turns(self.vertices.len() as u32);
        let sums = b.fold(function, count, [b.float(0.0); 6], (whitening, axes));
        touch.measure(whitening.back(sums))
    }

    /// Whether the origin lies inside, for the same axes: the parity of the edges that a ray meets.
    pub(crate) fn holds<'b>(&self, axes: Axes<'b>) -> Bool<'b> {
        let b = axes[0][0].builder();
        let place = |row: &[f32; 3]| vertex(row.map(|x| b.float(x)), axes);
        let places: Vec<[Float<'b>; 2]> = self.vertices.iter().map(place).collect();
        let mut inside = b.literal(false);
        for (i, &[x1, y1]) in places.iter().enumerate() {
            let [x2, y2] = places[(i + 1) % places.len()];
            let meets = unlike(y1.gt(0.0), y2.gt(0.0));
            // x where the edge meets the axis is positive: (x1 y2 − x2 y1) has the sign of y2 − y1.
            let (cross, rise) = (x1 * y2 - x2 * y1, y2 - y1);
            let right = !unlike(cross.lt(0.0), rise.lt(0.0));
            inside = unlike(inside, meets & right);
        }
        inside
    }
}

fn unlike<'b>(p: Bool<'b>, q: Bool<'b>) -> Bool<'b> {
    (p | q) & !(p & q)
}
