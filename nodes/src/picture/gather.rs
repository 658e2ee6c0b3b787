//! The moments of a field over the parts of a footprint, and the signals that they make.

use super::footprint::{CAPTURES, Footprint, Part, Parts, part};
use super::pyramid::{pairs, triangle};
use super::read::{Pyramid, Tap};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Float, Scalar, Scalars, Type, Vec2};
use mipless_codegen::moments::{Mode, Signal};

/// A field that is made of a picture, at a place.
pub(crate) struct Reading<'a, 'b> {
    pyramid: &'a Pyramid,
    /// In pictures.
    position: &'a [Signal<'b>],
    /// `None` at a point.
    footprint: Option<Footprint<'b>>,
    /// What each part needs to know where it is.
    place: Vec<Scalar<'b>>,
}

impl<'a, 'b> Reading<'a, 'b> {
    pub(crate) fn new(
        lower: &Lower<'_, 'b>,
        pyramid: &'a Pyramid,
        position: &'a [Signal<'b>],
        parts: Parts,
        place: impl Scalars<'b>,
    ) -> Self {
        let texels = pyramid.texels();
        let of = || Footprint::of(position, texels, lower.filter(), parts);
        Self {
            pyramid,
            position,
            footprint: lower.mode().filters().then(of),
            place: place.scalars(),
        }
    }

    /// The standard deviation along the longer axis of the footprint, in texels; `None` at a point.
    pub(crate) fn longest(&self) -> Option<Float<'b>> {
        let [longer, _] = self.footprint?.covariance.eigenvalues();
        Some(longer.max(0.0).sqrt())
    }

    /// The channels of the field: `at` gives it for a part of the footprint by the part, what the
    /// part needs and the picture under it. The key names whatever `at` depends on.
    pub(crate) fn signals<F>(&self, lower: &mut Lower<'_, 'b>, key: &str, at: F) -> Vec<Signal<'b>>
    where
        F: for<'c> FnOnce(&Part<'c>, &[Scalar<'c>], &dyn Fn([Float<'c>; 2]) -> Tap<'c>) -> Tap<'c>,
    {
        let (b, mode, channels) = (lower.b(), lower.mode(), self.pyramid.layout.channels);
        let certain =
            |means: &[Float<'b>]| means.iter().map(|&mean| Signal::certain(mean)).collect();
        let Some(footprint) = &self.footprint else {
            let point = self.pyramid.point(lower);
            let zero = b.float(0.0);
            let whole = Part {
                offset: Vec2::splat(zero),
                weight: b.float(1.0),
                variance: zero,
            };
            let read = |place: [Float<'b>; 2]| Tap::of(&b.call(&point, place), channels);
            return certain(&at(&whole, &self.place, &read).mean);
        };
        let carries = matches!(mode, Mode::Local | Mode::Quad);
        let filtered = self.pyramid.filtered(lower, carries);
        let place = (footprint, &self.place[..]);
        let gathered = gather(lower, key, (channels, carries), place, |b, part, place| {
            at(part, place, &|[x, y]| {
                Tap::of(&b.call(&filtered, [x, y, part.variance]), channels)
            })
        });
        if carries {
            return self.carried(lower, footprint, &gathered);
        }
        let mut signals: Vec<Signal<'b>> = certain(&gathered.mean);
        if mode == Mode::Ensemble {
            let [xx, _, yy] = *footprint.covariance;
            let removed = self.pyramid.removed(lower, (xx + yy) * 0.5);
            lower.algebra.attach_joint(&mut signals, &removed);
        }
        signals
    }

    /// The signals: responses by the gradients, and what is left of the covariance as parts that the
    /// channels share.
    fn carried(
        &self,
        lower: &mut Lower<'_, 'b>,
        footprint: &Footprint<'b>,
        field: &Gathered<'b>,
    ) -> Vec<Signal<'b>> {
        let [x, y] = self.position else {
            panic!("a position has two coordinates")
        };
        let [x, y] = [x, y].map(|axis| Signal {
            cell: None,
            slope: None,
            ..axis.clone()
        });
        let [w, h] = self.pyramid.texels();
        let rest: Vec<Float<'b>> = (pairs(field.mean.len()).zip(&field.covariance))
            .map(|((i, k), &all)| {
                let response = footprint.covariance.times(field.gradient[k]);
                all - field.gradient[i].dot(response)
            })
            .collect();
        let mut signals: Vec<Signal<'b>> = (field.mean.iter().zip(&field.gradient))
            .map(|(&mean, &Vec2([dx, dy]))| Signal {
                mean,
                range: [f32::NEG_INFINITY, f32::INFINITY],
                ..&x * (dx * w) + &y * (dy * h)
            })
            .collect();
        lower.algebra.attach_joint(&mut signals, &rest);
        signals
    }
}

/// A field over a footprint: mean and gradient (a texel) by channel, and the lower triangle of the
/// covariance; without moments, the means alone.
#[derive(Clone, Debug)]
struct Gathered<'b> {
    mean: Vec<Float<'b>>,
    gradient: Vec<Vec2<'b>>,
    covariance: Vec<Float<'b>>,
}

/// Gathers the field that `at` gives for a part, over all parts: means and covariances by West's
/// recurrence (1979), so that no second moment appears and covariances are positive semi-definite.
///
/// The covariance of a part is that of its gradient and what is beyond it; between the parts it is
/// that of their means (Grenier et al. 2022, eq. 14, 15, 18 and 19).
fn gather<'b>(
    lower: &mut Lower<'_, 'b>,
    key: &str,
    (channels, carries): (usize, bool),
    (footprint, place): (&Footprint<'b>, &[Scalar<'b>]),
    at: impl for<'c> FnOnce(&'c Builder, &Part<'c>, &[Scalar<'c>]) -> Tap<'c>,
) -> Gathered<'b> {
    let numbers = if carries {
        3 * channels + triangle(channels)
    } else {
        channels
    };
    let types: Vec<Type> = place.iter().map(|v| v.ty()).collect();
    let has_nodes = footprint.pixel.is_some();
    let body = lower.function(&format!("{key} gather {carries}"), |module| {
        let b = &Builder::new("part_of_footprint", "One more part of the footprint.");
        let index = b.uint_param("index");
        let before = b.float_param("weight_so_far");
        let state: Vec<Float<'_>> = (0..numbers)
            .map(|i| b.float_param(format!("state_{i}")))
            .collect();
        let captures = b.float_params(CAPTURES);
        let pixel = has_nodes.then(|| {
            ["a", "b"].map(|side| {
                Vec2(["x", "y"].map(|axis| b.float_param(format!("pixel_{side}{axis}"))))
            })
        });
        let place: Vec<Scalar<'_>> = (types.iter().enumerate())
            .map(|(i, &ty)| b.scalar_param(format!("place_{i}"), ty))
            .collect();
        let part = part(index, captures, pixel);
        let Tap {
            mean,
            gradient,
            rest,
        } = at(b, &part, &place);

        let weight = part.weight;
        let after = before + weight;
        let share = weight / after.max(1e-30);
        let deviation: Vec<Float<'_>> = (mean.iter().zip(&state))
            .map(|(&mean, &so_far)| mean - so_far)
            .collect();
        let mut steps: Vec<Float<'_>> = deviation.iter().map(|&x| share * x).collect();
        steps.extend(gradient.iter().copied().flatten().map(|x| weight * x));
        for ((i, k), rest) in pairs(gradient.len()).zip(rest) {
            let inside = gradient[i].dot(gradient[k]) * part.variance + rest;
            let between = deviation[i] * deviation[k] * (1.0 - share);
            steps.push(weight * (inside + between));
        }
        b.result("weight_so_far", after);
        for (i, (so_far, step)) in state.into_iter().zip(steps).enumerate() {
            b.result(format!("state_{i}"), so_far + step);
        }
        b.finish(module)
    });
    let b = lower.b();
    let start = vec![b.float(0.0); 1 + numbers];
    let captures = (footprint.captures, footprint.pixel, place);
    let state = b.fold(&body, footprint.count, start, captures);
    let tap = Tap::of(&state[1..], channels);
    Gathered {
        mean: tap.mean,
        gradient: tap.gradient,
        covariance: tap.rest,
    }
}
