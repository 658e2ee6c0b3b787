//! Worley noise against dense numerical truth, and its moments.

use crate::truth::{
    axes, distance, errors, evaluate, footprint, graph, has_moments, normal, places, sample,
};
use mipless_codegen::Method;

/// Inputs, mean, standard deviation, max |CDF − Φ|.
const NOISES: [(&str, f64, f64, f64); 5] = [
    (r#""output":"F1""#, 0.4293, 0.1898, 0.04),
    (r#""output":"F2""#, 0.6994, 0.1766, 0.04),
    (r#""output":"F2-F1""#, 0.2701, 0.2019, 0.1),
    (r#""style":"solid""#, 0.5, 0.288_675, 0.058),
    (r#""style":"solid","output":"F2-F1""#, 0.0, 0.408_248, 0.06),
];

#[test]
fn moments_over_the_plane_are_those_of_the_page() {
    for (inputs, mean, sd, deviation) in NOISES {
        let values = sample(&graph("worleynoise2d", inputs), 6400, 5.0);
        has_moments(inputs, &values, mean, sd * sd);
        let scores: Vec<f64> = values.iter().map(|x| (x - mean) / sd).collect();
        let found = distance(&scores, normal);
        assert!(found < deviation + 1.95 / 80.0, "{inputs}: {found}");
    }
    for (jitter, mean, sd) in [(0.3, 0.387, 0.1480), (0.6, 0.4015, 0.1635)] {
        let json = graph("worleynoise2d", &format!(r#""jitter":{jitter}"#));
        let far = [footprint([0.3, 0.4], axes(5.0, 1.0, 0.0))];
        let far = evaluate(&json, Method::Local, &far)[0];
        let values = sample(&json, 6400, 5.0);
        has_moments("by jitter", &values, far[0], far[1]);
        assert!(
            (far[0] - mean).abs() < 5e-3 && (far[1].sqrt() - sd).abs() < 5e-3,
            "{far:?}"
        );
    }
}

#[test]
fn means_and_deviations_are_near() {
    // At 0.1 and 0.4 cells, and at 8:1 with a minor axis of 0.05 cells.
    for (inputs, sd, deviations) in [
        (NOISES[0].0, NOISES[0].2, [0.08, 0.15, 0.2]),
        (NOISES[1].0, NOISES[1].2, [0.12, 0.16, 0.2]),
        (NOISES[2].0, NOISES[2].2, [0.14, 0.2, 0.26]),
        (NOISES[3].0, NOISES[3].2, [0.3, 0.16, 0.22]),
    ] {
        let json = graph("worleynoise2d", inputs);
        let cases = [(0.1, 1.0, 0.13), (0.4, 1.0, 0.28), (0.05, 8.0, 0.3)];
        for ((size, ratio, mean), deviation) in cases.into_iter().zip(deviations) {
            let axes = axes(size, ratio, 20.0);
            let found = errors(&json, &places(20, 40.0), axes, 0.06, &[Method::Local])[0];
            assert!(
                found.mean < mean * sd,
                "{inputs} at {size}, {ratio}:1: {found:?}"
            );
            assert!(
                found.deviation < deviation,
                "{inputs} at {size}, {ratio}:1: {found:?}"
            );
            assert!(
                found.bias.abs() < 0.3,
                "{inputs} at {size}, {ratio}:1: {found:?}"
            );
        }
    }
}

#[test]
fn points_repeat_and_far_coordinates_keep_their_detail() {
    let json = graph("worleynoise2d", r#""period":5"#);
    let at = |offset: f64| {
        let points: Vec<_> = (places(40, 5.0).iter())
            .map(|p| footprint([p[0] + offset, p[1] - offset], axes(0.1, 1.0, 0.0)))
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
