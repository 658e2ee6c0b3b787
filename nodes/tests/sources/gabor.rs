//! Gabor noise against dense numerical truth, and its distribution.

use crate::truth::{
    axes, distance, errors, evaluate, footprint, graph, has_moments, normal, places, sample,
};
use mipless_codegen::Method;

const ROUND: &str = r#""amplitude":4"#;
const BRUSHED: &str = r#""amplitude":4,"anisotropy":0.7,"orientation":20"#;
const LINES: &str =
    r#""amplitude":4,"anisotropy":1,"orientation":70,"bandwidth":0.5,"impulses":24"#;

#[test]
fn filtered_means_are_exact_but_for_the_windows() {
    for inputs in [ROUND, BRUSHED, LINES] {
        let json = graph("gabornoise2d", inputs);
        for (size, ratio, degrees) in [(0.1, 1.0, 0.0), (0.4, 1.0, 0.0), (0.05, 8.0, 20.0)] {
            let axes = axes(size, ratio, degrees);
            let found = errors(&json, &places(12, 40.0), axes, 0.5, &[Method::Local])[0];
            assert!(
                found.mean < 0.02,
                "{inputs} at {size}, {ratio}:1: {found:?}"
            );
        }
    }
}

#[test]
fn local_deviations_are_near() {
    let json = graph("gabornoise2d", ROUND);
    for (size, local, quad) in [(0.05, 0.03, 0.004), (0.1, 0.085, 0.02)] {
        let methods = [Method::Ensemble, Method::Local, Method::Quad];
        let found = errors(
            &json,
            &places(40, 40.0),
            axes(size, 1.0, 0.0),
            0.5,
            &methods,
        );
        assert!(found[0].deviation > 0.2, "{size}: ensemble {:?}", found[0]);
        assert!(found[1].deviation < local, "{size}: local {:?}", found[1]);
        assert!(found[1].bias.abs() < 0.15, "{size}: local {:?}", found[1]);
        assert!(found[2].deviation < quad, "{size}: quad {:?}", found[2]);
    }
}

#[test]
fn values_are_nearly_gaussian_of_the_stated_moments() {
    for (inputs, impulses) in [(ROUND, 16.0), (BRUSHED, 16.0), (LINES, 24.0)] {
        let values = sample(&graph("gabornoise2d", inputs), 6400, 17.0);
        has_moments(inputs, &values, 0.0, 1.0);
        // 1.95/√n is exceeded once in a thousand samples of a Gaussian.
        let limit = 0.155 / impulses + 1.95 / (values.len() as f64).sqrt();
        let found = distance(&values, normal);
        assert!(found < limit, "{inputs}: {found}, limit {limit}");
    }
}

#[test]
fn a_period_repeats_and_far_coordinates_keep_their_detail() {
    let json = graph("gabornoise2d", r#""amplitude":4,"period":8"#);
    let at = |offset: f64| {
        let points: Vec<_> = (places(30, 8.0).iter())
            .map(|p| footprint([p[0] + offset, p[1] - offset], axes(0.05, 1.0, 0.0)))
            .collect();
        evaluate(&json, Method::Local, &points)
    };
    let here = at(0.0);
    for offset in [8.0, -64.0, 1_000_000.0] {
        for (a, b) in here.iter().zip(at(offset)) {
            assert!((a[0] - b[0]).abs() < 2e-4, "{offset}: {a:?} {b:?}");
            assert!((a[1] - b[1]).abs() < 2e-4, "{offset}: {a:?} {b:?}");
        }
    }
    let elsewhere = at(3.0);
    assert!(
        here.iter()
            .zip(&elsewhere)
            .any(|(a, b)| (a[0] - b[0]).abs() > 0.5)
    );
}
