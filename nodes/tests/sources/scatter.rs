//! Scattered figures, tiles, woven threads and rays against dense numerical truth.

use crate::truth::{axes, errors, evaluate, footprint, graph, has_moments, places, sample};
use mipless_codegen::Method;

#[test]
fn figures_cover_what_they_are_said_to_and_repeat() {
    // E[(1 − t/2)²] of a uniform t is 7/12.
    let covered = 0.75 * std::f64::consts::PI * 0.16 * 7.0 / 12.0;
    let inputs = r#""density":0.75,"output":"mask""#;
    let values = sample(&graph("scatter", inputs), 10_000, 3.0);
    has_moments("scatter", &values, covered, covered * (1.0 - covered));
    let far = evaluate(
        &graph("scatter", inputs),
        Method::Local,
        &[footprint([0.3, 0.4], axes(50.0, 1.0, 0.0))],
    )[0];
    assert!((far[0] - covered).abs() < 1e-4, "{far:?}");
    assert!((far[1] - covered * (1.0 - covered)).abs() < 1e-4, "{far:?}");
    // The number of a figure is ½ in the mean, and that of the ground 0.
    let random = r#""density":0.75,"output":"random""#;
    let values = sample(&graph("scatter", random), 10_000, 3.0);
    let variance = covered / 3.0 - (0.5 * covered).powi(2);
    has_moments("random scatter", &values, 0.5 * covered, variance);
    let json = graph("scatter", r#""period":5,"shape":"polygon""#);
    let at = |offset: f64| {
        let points: Vec<_> = (places(40, 5.0).iter())
            .map(|p| footprint([p[0] + offset, p[1] - offset], axes(0.2, 1.0, 0.0)))
            .collect();
        evaluate(&json, Method::Local, &points)
    };
    for (a, b) in at(0.0).iter().zip(at(1_000_000.0)) {
        let off = (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
        assert!(off < 1e-4, "{a:?} {b:?}");
    }
}

#[test]
fn figures_are_filtered_one_by_one() {
    for inputs in [
        r#""output":"mask""#,
        r#""density":0.6,"output":"random""#,
        r#""shape":"polygon","sides":4,"size":1,"output":"random""#,
    ] {
        let json = graph("scatter", inputs);
        for (size, ratio, degrees) in [
            (0.04, 1.0, 0.0),
            (0.2, 1.0, 0.0),
            (0.5, 1.0, 0.0),
            (1.2, 1.0, 0.0),
            (0.12, 8.0, 0.0),
            (0.12, 8.0, 90.0),
            (0.12, 8.0, 35.0),
        ] {
            let found = errors(
                &json,
                &places(12, 40.0),
                axes(size, ratio, degrees),
                (0.1 * size).max(0.02),
                &[Method::Local],
            )[0];
            println!("{inputs} {size}, {ratio}:1 at {degrees}: {found:?}");
            assert!(
                found.mean < 0.005 && found.deviation < 0.08,
                "{inputs} {size}, {ratio}:1 at {degrees}: {found:?}"
            );
        }
    }
}

/// Holds the errors of the mean under footprints of 8:1 and round ones, in cells.
fn held(json: &str, sizes: &[f64], most: f64) {
    for &size in sizes {
        // Off the axes, where sums over a grid are good at edges along them.
        for (minor, ratio, degrees) in [
            (size, 1.0, 20.0),
            (0.35 * size, 8.0, 8.0),
            (0.35 * size, 8.0, 35.0),
        ] {
            let found = errors(
                json,
                &places(12, 40.0),
                axes(minor, ratio, degrees),
                (0.2 * minor).clamp(0.02, 0.05),
                &[Method::Local],
            )[0];
            println!("{json} {minor}, {ratio}:1 at {degrees}: {found:?}");
            assert!(
                found.mean < most,
                "{json} {minor}, {ratio}:1 at {degrees}: {found:?}"
            );
        }
    }
}

#[test]
fn tiles_are_filtered_one_by_one_and_fade_to_their_share() {
    let arcs = graph("truchet", "");
    let values = sample(&arcs, 10_000, 3.0);
    let covered = 0.1 * std::f64::consts::PI;
    has_moments("truchet", &values, covered, covered * (1.0 - covered));
    held(&arcs, &[0.1, 0.6], 0.005);
    let halves = graph("truchet", r#""tile":"triangles""#);
    has_moments("triangles", &sample(&halves, 10_000, 3.0), 0.5, 0.25);
    held(&halves, &[0.1], 0.005);
}

#[test]
fn threads_are_filtered_whichever_is_on_top() {
    for weave in ["plain", "twill", "satin"] {
        for output in ["threads", "weft", "warp"] {
            let inputs = format!(r#""uvtiling":[1,1],"weave":"{weave}","output":"{output}""#);
            held(&graph("weave", &inputs), &[0.3], 1e-3);
        }
    }
    // At the first crossing the weft is on top, and between two threads nothing is.
    let at = |output: &str, place: [f64; 2]| {
        let inputs = format!(r#""uvtiling":[1,1],"width":0.5,"output":"{output}""#);
        let points = [footprint(place, [[0.0; 2]; 2])];
        evaluate(&graph("weave", &inputs), Method::Point, &points)[0][0]
    };
    let places = [[0.5, 0.5], [1.5, 0.5], [1.0, 0.5], [1.0, 1.0]];
    let seen = ["threads", "weft", "warp"].map(|output| places.map(|place| at(output, place)));
    assert_eq!(
        seen,
        [
            [1.0, 1.0, 1.0, 0.0],
            [1.0, 0.0, 1.0, 0.0],
            [0.0, 1.0, 0.0, 0.0]
        ]
    );
}

#[test]
fn rays_are_filtered_away_from_their_centre_and_meet_in_their_share() {
    let json = graph("rays", r#""center":[0,0],"count":9,"width":0.3"#);
    held(&json, &[0.05, 0.2], 0.02);
    held(&json, &[1.0], 0.12);
    let centre = [footprint([0.0, 0.0], axes(0.3, 1.0, 0.0))];
    let found = evaluate(&json, Method::Local, &centre)[0];
    assert!((found[0] - 0.3).abs() < 0.02, "{found:?}");
    let along = |degrees: f64| {
        let (sine, cosine) = f64::to_radians(degrees).sin_cos();
        let points = [footprint([2.0 * cosine, 2.0 * sine], [[0.0; 2]; 2])];
        evaluate(&json, Method::Point, &points)[0][0]
    };
    assert_eq!(
        [0.0, 5.0, 7.0, 20.0, 40.0].map(along),
        [1.0, 1.0, 0.0, 0.0, 1.0]
    );
}

/// Where the sums over things fade to what is to be expected of any.
#[test]
fn wide_and_thin_footprints_lose_little() {
    for (json, most) in [
        (graph("truchet", ""), 0.006),
        (graph("truchet", r#""tile":"triangles""#), 0.04),
        (graph("scatter", r#""output":"mask""#), 0.03),
        (graph("scatter", r#""density":0.6,"output":"random""#), 0.03),
    ] {
        for (minor, ratio, degrees) in [
            (0.4, 8.0, 0.0),
            (0.4, 8.0, 90.0),
            (0.6, 8.0, 20.0),
            (2.0, 1.0, 0.0),
        ] {
            let found = errors(
                &json,
                &places(10, 40.0),
                axes(minor, ratio, degrees),
                0.06,
                &[Method::Local],
            )[0];
            println!("{minor}, {ratio}:1 at {degrees}: {found:?}");
            assert!(found.mean < most, "{minor}, {ratio}:1: {found:?}");
        }
    }
}
