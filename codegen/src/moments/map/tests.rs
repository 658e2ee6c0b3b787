//! Maps against closed forms: a half plane and a product of waves under any covariance.

use super::{Domain, Grid, Map, SIDE};
use crate::cpu::{Evaluator, Input, Scratch};
use crate::ir::{Builder, Float, FunctionRef, Module, Sym2, Vec2};
use std::sync::{Arc, LazyLock};

/// A function of two numbers.
type Build = for<'b> fn([Float<'b>; 2]) -> Float<'b>;

/// A map of one component on [0, 1]² within [0, 1].
fn map(module: &mut Module, periodic: bool, build: Build) -> Map {
    let function = move |module: &mut Module| -> FunctionRef {
        let b = &Builder::new("of", "A test.");
        b.result("value", build(b.float_params(["x", "y"])));
        b.finish(module)
    };
    let domain = Domain {
        bounds: [[0.0, 1.0]; 2],
        periodic,
        detail: 1,
    };
    let grid: Grid = Arc::new(LazyLock::new(Box::new(move || {
        let mut module = Module::default();
        function(&mut module);
        let mut values = Vec::new();
        let mut all = Vec::new();
        for row in 0..SIDE {
            let [x, y] = domain.row(row);
            let inputs = [Input::Floats(&x), Input::Floats(&y)];
            Evaluator::<f64>::new(&module).evaluate(
                &mut Scratch::new(),
                &inputs,
                SIDE,
                &mut values,
            );
            all.extend(values[0].iter().map(|&v: &f64| v as f32));
        }
        vec![all]
    })));
    let of = function(module);
    let tables = super::tables(&grid, domain, 1);
    Map::new(module, "map", of, domain, vec![[0.0, 1.0]], tables)
}

/// A mean and a covariance (11, 12, 22).
type Place = ([f64; 2], [f64; 3]);

/// Mean, slopes and √distortion of the map at each place, in f32.
fn moments(periodic: bool, build: Build, places: &[Place]) -> Vec<[f64; 4]> {
    let mut module = Module::default();
    let map = map(&mut module, periodic, build);
    let b = &Builder::new("moments", "A test.");
    let mean = b.float_params(["x", "y"]);
    let covariance = b.float_params(["xx", "xy", "yy"]);
    let moments = map.moments(Vec2(mean), Sym2(covariance));
    let m = &moments[0];
    b.result("result_mean", m.mean);
    b.result("result_x", m.slopes[0]);
    b.result("result_y", m.slopes[1]);
    b.result("result_root", m.distortion.sqrt());
    b.finish(&mut module);
    let module = module.pruned();
    let column = |f: &dyn Fn(&Place) -> f64| -> Vec<f32> {
        places.iter().map(|place| f(place) as f32).collect()
    };
    let columns = [
        column(&|p| p.0[0]),
        column(&|p| p.0[1]),
        column(&|p| p.1[0]),
        column(&|p| p.1[1]),
        column(&|p| p.1[2]),
    ];
    let inputs: Vec<Input<'_>> = columns.iter().map(|c| Input::Floats(c)).collect();
    let mut outputs: Vec<Vec<f32>> = Vec::new();
    Evaluator::new(&module).evaluate(&mut Scratch::new(), &inputs, places.len(), &mut outputs);
    (0..places.len())
        .map(|i| std::array::from_fn(|k| f64::from(outputs[k][i])))
        .collect()
}

/// Means over the domain, deviations from `least` to `most`, any ratio up to 16 and any direction.
fn places(least: f64, most: f64) -> Vec<Place> {
    let steps = [
        0.754_877_666,
        0.569_840_291,
        0.430_159_709,
        0.671_043_607,
        0.850_650_808,
    ];
    (1..=800)
        .map(|i| {
            let [u, v, size, ratio, turn] = steps.map(|step| (f64::from(i) * step).fract());
            let major = least * (most / least).powf(size);
            let minor = major * 16f64.powf(-ratio);
            let (s, c) = (std::f64::consts::PI * turn).sin_cos();
            let (p, q) = (major * major, minor * minor);
            let covariance = [
                p * c * c + q * s * s,
                (p - q) * s * c,
                p * s * s + q * c * c,
            ];
            ([0.2 + 0.6 * u, 0.2 + 0.6 * v], covariance)
        })
        .collect()
}

/// The integral of the normal density up to z, by the trapezoidal rule from 0.
fn below(z: f64) -> f64 {
    let steps = 400;
    let h = z / f64::from(steps);
    let density = |x: f64| (-0.5 * x * x).exp() / (2.0 * std::f64::consts::PI).sqrt();
    let inner: f64 = (1..steps).map(|i| density(f64::from(i) * h)).sum();
    0.5 + h * (inner + 0.5 * (density(0.0) + density(z)))
}

/// The mean and the largest error of each moment, slopes and roots in units of the map.
fn errors(
    found: &[[f64; 4]],
    places: &[Place],
    exact: impl Fn(&Place) -> [f64; 4],
) -> [[f64; 2]; 4] {
    let mut out = [[0.0f64; 2]; 4];
    for (found, place) in found.iter().zip(places) {
        let exact = exact(place);
        let units = [1.0, place.1[0].sqrt(), place.1[2].sqrt(), 1.0];
        for k in 0..4 {
            let error = (found[k] - exact[k]).abs() * units[k];
            assert!(error.is_finite(), "moment {k} at {place:?}: {}", found[k]);
            out[k][0] += error / places.len() as f64;
            out[k][1] = out[k][1].max(error);
        }
    }
    out
}

/// 1 where 0.6 x + 0.8 y ≥ 0.7.
fn half_plane([x, y]: [Float<'_>; 2]) -> Float<'_> {
    (0.6 * x + 0.8 * y).ge(0.7).select(1.0, 0.0)
}

#[test]
fn a_half_plane_is_that_of_the_normal_distribution() {
    let exact = |&([x, y], [xx, xy, yy]): &Place| {
        let (p, q) = (0.6, 0.8);
        let sd = (p * p * xx + 2.0 * p * q * xy + q * q * yy).sqrt();
        let z = (p * x + q * y - 0.7) / sd;
        let density = (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt();
        let (above, under) = (below(z), below(-z));
        let root = (above * under - density * density).max(0.0).sqrt();
        [above, p * density / sd, q * density / sd, root]
    };
    let places = places(0.01, 0.06);
    let found = moments(false, half_plane, &places);
    let [mean, x, y, root] = errors(&found, &places, exact);
    // What the cap of the axes' ratio costs is in all of them: most where the edge lies along the
    // major axis.
    assert!(mean[0] < 0.003 && mean[1] < 0.2, "means: {mean:?}");
    assert!(x[0] < 0.02 && y[0] < 0.02, "slopes: {x:?} {y:?}");
    assert!(root[0] < 0.02, "√distortion: {root:?}");
}

/// ½ + ½ sin(2π·2x) cos(2π·y).
fn waves([x, y]: [Float<'_>; 2]) -> Float<'_> {
    let [x, y] = [x * (2.0 * std::f32::consts::TAU), y * std::f32::consts::TAU];
    0.5 * (x.sin() * y.cos()) + 0.5
}

/// sin(k·x)-shaped terms of a product of waves: its mean and slopes are exact sums of two sines.
fn filtered_waves(&([x, y], [xx, xy, yy]): &Place) -> [f64; 4] {
    let tau = std::f64::consts::TAU;
    let (a, b) = (2.0 * tau, tau);
    let [mut mean, mut dx, mut dy] = [0.5, 0.0, 0.0];
    for sign in [1.0, -1.0] {
        let damping = (-0.5 * (a * a * xx + 2.0 * sign * a * b * xy + b * b * yy)).exp();
        let angle = a * x + sign * b * y;
        mean += 0.25 * damping * angle.sin();
        dx += 0.25 * damping * a * angle.cos();
        dy += 0.25 * damping * sign * b * angle.cos();
    }
    // E[(½ sin cos)²] = 1/16 E[(1 − cos 2p)(1 + cos 2q)].
    let wave = |u: f64, v: f64| {
        let q = u * u * xx + 2.0 * u * v * xy + v * v * yy;
        (-0.5 * q).exp() * (u * x + v * y).cos()
    };
    let both = 0.5 * (wave(2.0 * a, 2.0 * b) + wave(2.0 * a, -2.0 * b));
    let square = (1.0 - wave(2.0 * a, 0.0) + wave(0.0, 2.0 * b) - both) / 16.0;
    let variance = square - (mean - 0.5).powi(2);
    let linear = dx * dx * xx + 2.0 * dx * dy * xy + dy * dy * yy;
    [mean, dx, dy, (variance - linear).max(0.0).sqrt()]
}

#[test]
fn a_product_of_waves_is_exact_but_for_the_table() {
    let places = places(0.002, 0.125);
    let found = moments(true, waves, &places);
    let [mean, x, y, root] = errors(&found, &places, filtered_waves);
    assert!(mean[0] < 0.001 && mean[1] < 0.02, "means: {mean:?}");
    assert!(x[0] < 0.004 && y[0] < 0.004, "slopes: {x:?} {y:?}");
    assert!(root[0] < 0.006, "√distortion: {root:?}");
}

#[test]
fn no_footprint_is_the_point_and_an_endless_one_the_mean() {
    let mut all = Vec::new();
    for i in 0..50 {
        let [x, y] = [0.754_877_666, 0.569_840_291].map(|step| (f64::from(i) * step).fract());
        all.push(([x, y], [0.0; 3]));
        all.push(([x, y], [1e18, 0.0, 1e18]));
        all.push(([x, y], [1e18, 1e18, 1e18]));
    }
    let found = moments(true, waves, &all);
    for (place, found) in all.iter().zip(&found) {
        if place.1[0] == 0.0 {
            let exact = filtered_waves(place)[0];
            assert!((found[0] - exact).abs() < 2e-6, "{place:?}: {found:?}");
            assert_eq!(found[3], 0.0, "{place:?}");
        } else if place.1[1] == 0.0 {
            assert!((found[0] - 0.5).abs() < 1e-4, "{place:?}: {found:?}");
            // The whole variance of the map, 1/16.
            assert!((found[3] - 0.25).abs() < 1e-3, "{place:?}: {found:?}");
        }
        assert!(found.iter().all(|v| v.is_finite()), "{place:?}: {found:?}");
    }
}

#[test]
fn tables_state_their_error_and_stay_small() {
    let mut module = Module::default();
    map(&mut module, true, waves);
    let bytes = |name: &str| {
        let table = module.tables.iter().find(|t| t.name == name);
        4 * table.expect("the map has the table").data.len()
    };
    assert!(bytes("map_mean") < 1_000_000, "{}", bytes("map_mean"));
    let table = module.tables.iter().find(|t| t.name == "map_mean");
    let error = table.and_then(|t| t.data.error()).expect("measured");
    // Two periods across: curvature over texels and between levels.
    assert!(error > 1e-6 && error < 0.02, "{error}");
    let levels = module.tables.iter().find(|t| t.name == "map_levels");
    assert_eq!(levels.and_then(|t| t.data.error()), None);
}
