//! The Gaussian measure of plane regions: polygons and discs.
//!
//! A polygon's measure is the sum over its edges of the triangles from the mean to the edge, in
//! coordinates where the covariance is the identity; such a triangle is two right ones, whose
//! measure is V(h, q) = ∫₀^h φ(x)(Φ(qx/h) − ½) dx (Nicholson 1943; Owen 1956). For q ≤ h,
//! V = (1/2π) ∫₀^{q/h} (1 − e^{−h²(1+x²)/2})/(1 + x²) dx, which four Gauss–Legendre nodes give
//! within 2e-6; else V(h, q) = (Φ(h) − ½)(Φ(q) − ½) − V(q, h). So any covariance is exact. A disc is
//! integrated along the minor axis of the footprint, chord by chord.

use super::measure::{Measure, NAMES};
use super::touch::Touch;
use crate::noise::field::Spread;
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use mipless_codegen::moments::Normal;

/// No footprint is narrower than this, in units of the position.
const NARROWEST: f32 = 1e-6;

/// The same for discs: chords are placed to 3e-8, which must be little against the footprint.
const NARROWEST_DISC: f32 = 1e-5;

/// Σ = LLᵀ.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Whitening {
    /// 1/L₁₁, L₂₁/L₁₁ and 1/L₂₂.
    inverse: [Value; 3],
}

impl Whitening {
    /// Of a covariance; Σ + 1e-12 I, so that nothing divides by 0.
    pub(crate) fn of(b: &mut Builder, [xx, xy, yy]: [Value; 3]) -> Self {
        let raised = b.offset(xx, NARROWEST * NARROWEST);
        let first = b.sqrt(raised);
        let one = b.f32(1.0);
        let inverse = b.div(one, first);
        let side = b.mul(xy, inverse);
        let square = b.square(side);
        let rest = b.sub(yy, square);
        let zero = b.f32(0.0);
        let rest = b.max(rest, zero);
        let rest = b.offset(rest, NARROWEST * NARROWEST);
        let second = b.sqrt(rest);
        let ratio = b.mul(side, inverse);
        Self {
            inverse: [inverse, ratio, b.div(one, second)],
        }
    }

    /// From parameters that [`Self::captures`] fills.
    pub(crate) fn declare(b: &mut Builder) -> Self {
        Self {
            inverse: ["inverse_x", "ratio", "inverse_y"].map(|name| b.param_f32(name)),
        }
    }

    /// The numbers that a function needs for [`Self::declare`].
    pub(crate) fn captures(&self) -> [Value; 3] {
        self.inverse
    }

    /// L⁻¹p.
    fn apply(&self, b: &mut Builder, [x, y]: [Value; 2]) -> [Value; 2] {
        let [first, ratio, second] = self.inverse;
        let side = b.mul(ratio, x);
        let rest = b.sub(y, side);
        [b.mul(x, first), b.mul(rest, second)]
    }

    /// Derivatives by the whitened mean as derivatives by the mean.
    pub(crate) fn back(&self, b: &mut Builder, m: Measure) -> Measure {
        let [first, ratio, second] = self.inverse;
        let [value, dx, dy, xx, xy, yy] = m;
        // L⁻¹ = [[p, 0], [−rs, s]] with p = 1/L₁₁, s = 1/L₂₂ and r = L₂₁/L₁₁.
        let (p, s) = (first, second);
        let q = b.mul(ratio, s);
        let q = b.neg(q);
        let gx = b.dot(&[p, q], &[dx, dy]);
        let gy = b.mul(s, dy);
        let (px, py) = (b.dot(&[xx, xy], &[p, q]), b.dot(&[xy, yy], &[p, q]));
        let hxx = b.dot(&[p, q], &[px, py]);
        let hxy = b.mul(s, py);
        let hyy = b.square(s);
        let hyy = b.mul(hyy, yy);
        [value, gx, gy, hxx, hxy, hyy]
    }
}

/// V(h, q) with the signs of h and q.
fn triangle(b: &mut Builder, h: Value, q: Value, [at_h, at_q]: [&Normal; 2]) -> Value {
    use std::f32::consts::TAU;
    let (zero, least) = (b.f32(0.0), b.f32(1e-20));
    let (p, r) = (b.abs(h), b.abs(q));
    let (more, less) = (b.max(p, r), b.min(p, r));
    let guarded = b.max(more, least);
    let ratio = b.div(less, guarded);
    let limit = b.f32(12.0);
    let short = b.min(more, limit);
    let square = b.square(short);
    let mut sum = zero;
    // Gauss–Legendre on [0, 1].
    for (node, weight) in [
        (0.069_431_844, 0.173_927_42),
        (0.330_009_48, 0.326_072_58),
        (0.669_990_52, 0.326_072_58),
        (0.930_568_16, 0.173_927_42),
    ] {
        let x = b.scale(ratio, node);
        let x2 = b.square(x);
        let raised = b.offset(x2, 1.0);
        let exponent = b.mul(square, raised);
        let exponent = b.scale(exponent, -0.5);
        let least = b.f32(-80.0);
        let exponent = b.max(exponent, least);
        let lost = b.exp(exponent);
        let one = b.f32(1.0);
        let kept = b.sub(one, lost);
        let part = b.div(kept, raised);
        let part = b.scale(part, weight / TAU);
        sum = b.add(sum, part);
    }
    let near = b.mul(sum, ratio);
    let signed = |b: &mut Builder, n: &Normal| {
        let half = b.sub(n.below, n.above);
        let half = b.scale(half, 0.5);
        b.abs(half)
    };
    let (left, right) = (signed(b, at_h), signed(b, at_q));
    let both = b.mul(left, right);
    let other = b.sub(both, near);
    let direct = b.le(r, p);
    let value = b.select(direct, near, other);
    let (h_down, q_down) = (b.lt(h, zero), b.lt(q, zero));
    let opposite = b.neg(value);
    let value = b.select(h_down, opposite, value);
    let opposite = b.neg(value);
    b.select(q_down, opposite, value)
}

/// The part of one edge, from whitened ends, seen from the mean at the origin; counter-clockwise
/// edges count positive. Derivatives are by the whitened mean.
fn edge(b: &mut Builder, [x1, y1]: [Value; 2], [x2, y2]: [Value; 2]) -> Measure {
    let (dx, dy) = (b.sub(x2, x1), b.sub(y2, y1));
    let square = b.dot(&[dx, dy], &[dx, dy]);
    let square = b.offset(square, 1e-30);
    let length = b.sqrt(square);
    let one = b.f32(1.0);
    let inverse = b.div(one, length);
    let (tx, ty) = (b.mul(dx, inverse), b.mul(dy, inverse));
    // The outward normal of a counter-clockwise polygon.
    let (nx, ny) = (ty, b.neg(tx));
    let h = b.dot(&[x1, y1], &[nx, ny]);
    let (t1, t2) = (b.dot(&[x1, y1], &[tx, ty]), b.dot(&[x2, y2], &[tx, ty]));
    let (at_h, at_1, at_2) = (Normal::of(b, h), Normal::of(b, t1), Normal::of(b, t2));
    let (first, second) = (
        triangle(b, h, t1, [&at_h, &at_1]),
        triangle(b, h, t2, [&at_h, &at_2]),
    );
    let value = b.sub(second, first);
    let span = b.sub(at_2.below, at_1.below);
    let ends = b.sub(at_2.density, at_1.density);
    let flow = b.mul(at_h.density, span);
    let flow = b.neg(flow);
    let (gx, gy) = (b.mul(nx, flow), b.mul(ny, flow));
    // −φ(h) n ⊗ (h ΔΦ n − Δφ t), made symmetric.
    let along = b.mul(at_h.z, flow);
    let across = b.mul(at_h.density, ends);
    let (xx, yy) = (b.mul(nx, nx), b.mul(ny, ny));
    let xy = b.mul(nx, ny);
    let (sxx, syy) = (b.mul(nx, tx), b.mul(ny, ty));
    let cross = b.dot(&[nx, ny], &[ty, tx]);
    let cross = b.scale(cross, 0.5);
    let mix = |b: &mut Builder, p: Value, q: Value| b.dot(&[along, across], &[p, q]);
    [
        value,
        gx,
        gy,
        mix(b, xx, sxx),
        mix(b, xy, cross),
        mix(b, yy, syy),
    ]
}

/// The most vertices that are chosen by comparisons.
const FEW: usize = 8;

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
    fn chosen(&self, b: &mut Builder, index: Value, after: usize) -> [Value; 3] {
        let count = self.vertices.len();
        let last = self.vertices[(count - 1 + after) % count];
        let mut chosen = last.map(|x| b.f32(x));
        for i in (0..count - 1).rev() {
            let number = b.u32(i as u32);
            let here = b.eq_u(index, number);
            let vertex = self.vertices[(i + after) % count];
            chosen = std::array::from_fn(|k| {
                let x = b.f32(vertex[k]);
                b.select(here, x, chosen[k])
            });
        }
        chosen
    }

    /// The numbers of a table: the first vertex comes again at the end.
    fn rows(&self) -> Vec<f32> {
        let again = self.vertices.first();
        (self.vertices.iter().chain(again))
            .flatten()
            .copied()
            .collect()
    }

    /// The body of a fold over the edges. Captures: the whitening, then o (from the mean), A, B, E.
    pub(crate) fn function(&self, module: &mut Module) -> FunctionRef {
        let few = self.vertices.len() <= FEW;
        let table = (!few).then(|| module.table("outline", self.rows()));
        let mut b = Builder::new("outline_edge", "One more edge of a polygon.");
        let index = b.param("index", Type::U32);
        let state = NAMES.map(|name| b.param_f32(name));
        let whitening = Whitening::declare(&mut b);
        let axes = ["o", "a", "b", "e"]
            .map(|name| [format!("{name}_x"), format!("{name}_y")].map(|name| b.param_f32(name)));
        let mut vertex = |after: usize| {
            let [p, q, r] = match table {
                None => self.chosen(&mut b, index, after),
                Some(table) => {
                    let three = b.u32(3);
                    let first = b.mul_u(index, three);
                    [0, 1, 2].map(|i| {
                        let shift = b.u32((3 * after + i) as u32);
                        let at = b.add_u(first, shift);
                        b.load(table, at)
                    })
                }
            };
            let place = [0, 1].map(|k| {
                let part = b.dot(&[p, q, r], &[axes[1][k], axes[2][k], axes[3][k]]);
                b.add(axes[0][k], part)
            });
            whitening.apply(&mut b, place)
        };
        let (start, end) = (vertex(0), vertex(1));
        let part = edge(&mut b, start, end);
        for ((name, sum), part) in NAMES.into_iter().zip(state).zip(part) {
            let sum = b.add(sum, part);
            b.result(name, sum);
        }
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

    /// The measure at a mean that is −o from the origin of the axes: o, A, B, E.
    pub(crate) fn measure(
        &self,
        b: &mut Builder,
        function: &FunctionRef,
        (whitening, touch): (&Whitening, Touch),
        axes: [[Value; 2]; 4],
    ) -> Measure {
        let zero = b.f32(0.0);
        let count = touch.turns(b, self.vertices.len() as u32);
        let mut captures = whitening.captures().to_vec();
        captures.extend(axes.iter().flatten());
        let sums = b.fold(function, count, &[zero; 6], &captures);
        let sums = std::array::from_fn(|i| sums[i]);
        let sums = whitening.back(b, sums);
        touch.measure(b, sums)
    }

    /// Whether the origin lies inside, for the same axes: the parity of the edges that a ray meets.
    pub(crate) fn holds(&self, b: &mut Builder, axes: [[Value; 2]; 4]) -> Value {
        let places: Vec<[Value; 2]> = (self.vertices.iter())
            .map(|row| {
                let row = row.map(|x| b.f32(x));
                [0, 1].map(|k| {
                    let part = b.dot(&row, &[axes[1][k], axes[2][k], axes[3][k]]);
                    b.add(axes[0][k], part)
                })
            })
            .collect();
        let zero = b.f32(0.0);
        let mut inside = b.bool(false);
        for (i, &[x1, y1]) in places.iter().enumerate() {
            let [x2, y2] = places[(i + 1) % places.len()];
            let (up, down) = (b.lt(zero, y1), b.lt(zero, y2));
            let meets = unlike(b, up, down);
            // x where the edge meets the axis is positive: (x1 y2 − x2 y1) has the sign of y2 − y1.
            let (p, q) = (b.mul(x1, y2), b.mul(x2, y1));
            let (cross, rise) = (b.sub(p, q), b.sub(y2, y1));
            let (left, falls) = (b.lt(cross, zero), b.lt(rise, zero));
            let other = unlike(b, left, falls);
            let right = b.not(other);
            let toggles = b.and(meets, right);
            inside = unlike(b, inside, toggles);
        }
        inside
    }
}

fn unlike(b: &mut Builder, p: Value, q: Value) -> Value {
    let (either, both) = (b.or(p, q), b.and(p, q));
    let not = b.not(both);
    b.and(either, not)
}

/// How many chords a disc is integrated over.
const CHORDS: u32 = 28;

/// The measure of a disc of a radius, whose centre is at an offset from the mean, and its
/// derivatives.
///
/// Along the minor axis of the footprint, over the part of the disc within ±4.8 σ₂, by 28
/// Gauss–Legendre nodes in a variable that is flat at both ends, where chords end like a root.
pub(crate) fn disc_function(module: &mut Module) -> FunctionRef {
    let table = module.table("chords", legendre(CHORDS as usize));
    let chord = {
        let mut b = Builder::new("disc_chord", "One more chord of a disc.");
        let index = b.param("index", Type::U32);
        let state = NAMES.map(|name| b.param_f32(name));
        let [middle, half, radius, x, y, inverse_x, inverse_y] = [
            "middle",
            "half",
            "radius",
            "x",
            "y",
            "inverse_x",
            "inverse_y",
        ]
        .map(|name| b.param_f32(name));
        let two = b.u32(2);
        let first = b.mul_u(index, two);
        let one = b.u32(1);
        let second = b.add_u(first, one);
        let (node, weight) = (b.load(table, first), b.load(table, second));
        // u = (15t − 10t³ + 3t⁵)/8, du = 15/8 (1 − t²)² dt.
        let t2 = b.square(node);
        let inner = b.scale(t2, 3.0 / 8.0);
        let inner = b.offset(inner, -10.0 / 8.0);
        let inner = b.mul(inner, t2);
        let inner = b.offset(inner, 15.0 / 8.0);
        let u = b.mul(inner, node);
        let one = b.f32(1.0);
        let fall = b.sub(one, t2);
        let fall = b.square(fall);
        let fall = b.scale(fall, 15.0 / 8.0);
        // Along the minor axis, from the disc's centre.
        let shift = b.mul(half, u);
        let place = b.add(middle, shift);
        let (squared, own) = (b.square(radius), b.square(place));
        let reach = b.sub(squared, own);
        let zero = b.f32(0.0);
        let reach = b.max(reach, zero);
        let reach = b.sqrt(reach);
        let from = b.add(place, y);
        let at = Normal::at(&mut b, from, inverse_y);
        let (high, low) = (b.add(x, reach), b.sub(x, reach));
        let (high, low) = (
            Normal::at(&mut b, high, inverse_x),
            Normal::at(&mut b, low, inverse_x),
        );
        let w = b.mul(weight, fall);
        let w = b.mul(w, half);
        let w = b.mul(w, inverse_y);
        let w = b.mul(w, at.density);
        let span = b.sub(high.below, low.below);
        // Of two upper tails the difference is taken there.
        let other = b.sub(low.above, high.above);
        let far = b.lt(zero, low.z);
        let span = b.select(far, other, span);
        let flow = b.sub(low.density, high.density);
        let (hz, lz) = (b.mul(high.z, high.density), b.mul(low.z, low.density));
        let bend = b.sub(lz, hz);
        let z2 = b.square(at.z);
        let z2 = b.offset(z2, -1.0);
        let parts = [
            span,
            flow,
            b.mul(at.z, span),
            bend,
            b.mul(at.z, flow),
            b.mul(z2, span),
        ];
        for ((name, sum), part) in NAMES.into_iter().zip(state).zip(parts) {
            let part = b.mul(w, part);
            let sum = b.add(sum, part);
            b.result(name, sum);
        }
        b.finish(module)
    };
    let mut b = Builder::new("disc", "The measure of a disc.");
    let (x, y) = (b.param_f32("x"), b.param_f32("y"));
    let radius = b.param_f32("radius");
    let covariance = ["xx", "xy", "yy"].map(|name| b.param_f32(name));
    let [xx, xy, yy] = covariance;
    // The axes of the footprint: the longer of two equal candidates for its direction.
    let (sum, difference) = (b.add(xx, yy), b.sub(xx, yy));
    let (mid, tilt) = (b.scale(sum, 0.5), b.scale(difference, 0.5));
    let square = b.dot(&[tilt, xy], &[tilt, xy]);
    let root = b.sqrt(square);
    let zero = b.f32(0.0);
    let (more, less) = (b.add(mid, root), b.sub(mid, root));
    let less = b.max(less, zero);
    let wide = b.le(zero, tilt);
    let size = b.abs(tilt);
    let long = b.add(root, size);
    let (cx, cy) = (b.select(wide, long, xy), b.select(wide, xy, long));
    let length = b.dot(&[cx, cy], &[cx, cy]);
    let round = b.le(length, zero);
    let one = b.f32(1.0);
    let length = b.select(round, one, length);
    let length = b.sqrt(length);
    let (c, s) = (b.div(cx, length), b.div(cy, length));
    let c = b.select(round, one, c);
    let minus = b.neg(s);
    let (u, v) = (b.dot(&[c, s], &[x, y]), b.dot(&[minus, c], &[x, y]));
    let [major, minor] = [more, less].map(|v| {
        let v = b.offset(v, NARROWEST_DISC * NARROWEST_DISC);
        b.sqrt(v)
    });
    let [inverse_x, inverse_y] = [major, minor].map(|sd| b.div(one, sd));
    // The chords within ±4.8 σ of the mean, which is at −v from the centre.
    let reach = b.scale(minor, 4.8);
    let mean = b.neg(v);
    let (low, high) = (b.sub(mean, reach), b.add(mean, reach));
    let back = b.neg(radius);
    let (low, high) = (b.max(low, back), b.min(high, radius));
    let span = b.sub(high, low);
    let span = b.max(span, zero);
    let half = b.scale(span, 0.5);
    let middle = b.add(low, half);
    let square = b.dot(&[x, y], &[x, y]);
    let touch = Touch::between(&mut b, square, [radius; 2], covariance);
    let count = touch.turns(&mut b, CHORDS);
    let captures = [middle, half, radius, u, v, inverse_x, inverse_y];
    let sums = b.fold(&chord, count, &[zero; 6], &captures);
    // Turned back; σ is still in the derivatives.
    let (gu, gv) = (b.mul(sums[1], inverse_x), b.mul(sums[2], inverse_y));
    let (ix2, iy2, ixy) = (
        b.square(inverse_x),
        b.square(inverse_y),
        b.mul(inverse_x, inverse_y),
    );
    let (huu, huv, hvv) = (
        b.mul(sums[3], ix2),
        b.mul(sums[4], ixy),
        b.mul(sums[5], iy2),
    );
    let (gx, gy) = (b.dot(&[c, minus], &[gu, gv]), b.dot(&[s, c], &[gu, gv]));
    let (c2, s2, cs) = (b.square(c), b.square(s), b.mul(c, s));
    let twice = b.add(cs, cs);
    let back = b.neg(twice);
    let hxx = b.dot(&[c2, back, s2], &[huu, huv, hvv]);
    let hyy = b.dot(&[s2, twice, c2], &[huu, huv, hvv]);
    let (difference, turn) = (b.sub(huu, hvv), b.sub(c2, s2));
    let hxy = b.dot(&[cs, turn], &[difference, huv]);
    let measure = touch.measure(&mut b, [sums[0], gx, gy, hxx, hxy, hyy]);
    for (name, value) in NAMES.into_iter().zip(measure) {
        b.result(name, value);
    }
    b.finish(module)
}

/// Nodes and weights of Gauss–Legendre on [−1, 1], in pairs, by Newton's method.
fn legendre(n: usize) -> Vec<f32> {
    let mut out = Vec::with_capacity(2 * n);
    for i in 0..n {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        let mut slope = 0.0;
        for _ in 0..50 {
            let (mut before, mut here) = (1.0, x);
            for k in 2..=n {
                let k = k as f64;
                (before, here) = (here, ((2.0 * k - 1.0) * x * here - (k - 1.0) * before) / k);
            }
            slope = n as f64 * (x * here - before) / (x * x - 1.0);
            x -= here / slope;
        }
        out.extend([x as f32, (2.0 / ((1.0 - x * x) * slope * slope)) as f32]);
    }
    out
}

/// The measure of a disc; `centre` from the mean.
pub(crate) fn disc(
    lower: &mut Lower<'_>,
    centre: [Value; 2],
    radius: Value,
    spread: &Spread,
) -> Measure {
    let function = lower.function("disc", disc_function);
    let b = lower.b();
    let mut arguments = centre.to_vec();
    arguments.push(radius);
    arguments.extend(spread.covariance);
    let results = b.call(&function, &arguments);
    std::array::from_fn(|i| results[i])
}
