//! Random cells against dense numerical truth, and their distribution.

use crate::truth::{
    axes, distance, errors, evaluate, footprint, graph, has_moments, places, sample,
};
use mipless_codegen::Method;

/// The standard deviation of a number of [0, 1).
const SD: f64 = 0.288_675;

#[test]
fn cells_are_uniform_and_repeat() {
    let values = sample(&graph("cellnoise2d", ""), 4900, 3.0);
    has_moments("cellnoise2d", &values, 0.5, 1.0 / 12.0);
    let found = distance(&values, |x| x.clamp(0.0, 1.0));
    assert!(found < 1.95 / 70.0, "{found}");
    let json = graph("cellnoise2d", r#""period":5"#);
    let at = |offset: f64| {
        let points: Vec<_> = (places(40, 5.0).iter())
            .map(|p| footprint([p[0] + offset, p[1] - offset], axes(0.2, 1.0, 0.0)))
            .collect();
        evaluate(&json, Method::Local, &points)
    };
    for (a, b) in at(0.0).iter().zip(at(1_000_000.0)) {
        assert!(
            (a[0] - b[0]).abs() < 1e-4 && (a[1] - b[1]).abs() < 1e-4,
            "{a:?} {b:?}"
        );
    }
}

#[test]
fn cells_are_filtered_exactly_along_the_axes() {
    let json = graph("cellnoise2d", "");
    for (size, ratio, degrees, mean, deviation) in [
        (0.05, 1.0, 0.0, 0.015, 0.08),
        (0.3, 1.0, 0.0, 0.015, 0.02),
        (1.0, 1.0, 0.0, 0.015, 0.01),
        (0.2, 8.0, 0.0, 0.015, 0.01),
        (0.2, 8.0, 90.0, 0.015, 0.01),
        (0.2, 8.0, 20.0, 0.04, 0.03),
        (0.2, 8.0, 45.0, 0.04, 0.03),
        (0.2, 8.0, -70.0, 0.04, 0.03),
    ] {
        let axes = axes(size, ratio, degrees);
        let found = errors(
            &json,
            &places(12, 40.0),
            axes,
            (0.1 * size).max(0.02),
            &[Method::Local],
        )[0];
        println!(
            "{size}, {ratio}:1 at {degrees}: {:.4} SD, {:.4}",
            found.mean / SD,
            found.deviation
        );
        assert!(
            found.mean < mean * SD,
            "{size}, {ratio}:1 at {degrees}: {found:?}"
        );
        assert!(
            found.deviation < deviation,
            "{size}, {ratio}:1 at {degrees}: {found:?}"
        );
    }
}

#[test]
fn white_noise_is_all_remainder() {
    let json = graph("whitenoise2d", r#""frequency":4"#);
    let values = sample(&json, 4900, 1.0);
    has_moments("whitenoise2d", &values, 0.5, 1.0 / 12.0);
    for (size, ensemble) in [(0.0, 0.0), (1.0, 1.0 / 12.0), (30.0, 1.0 / 12.0)] {
        let points: Vec<_> = (places(60, 9.0).iter())
            .map(|&p| footprint(p, axes(size, 1.0, 0.0)))
            .collect();
        for (point, found) in (evaluate(&json, Method::Point, &points).iter()).zip(evaluate(
            &json,
            Method::Local,
            &points,
        )) {
            let mean = if size == 0.0 { point[0] } else { 0.5 };
            assert!((found[0] - mean).abs() < 0.02, "{size}: {found:?}");
            assert!((found[1] - ensemble).abs() < 2e-3, "{size}: {found:?}");
        }
    }
}
