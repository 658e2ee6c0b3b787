//! Random numbers and colours of a number that varies against dense numerical truth.

use crate::truth::{axes, distance, errors, evaluate, footprint, has_moments, normal, places};
use mipless_codegen::Method;

/// The standard deviation of a number of [0, 1).
const SD: f64 = 0.288_675;

/// A node of u/4096, whose cells are columns of width 1; the luminance of its output is `light`.
fn columns(node: &str, inputs: &str, out: &str) -> String {
    format!(
        r#"{{"version":1,"name":"columns","nodes":{{
            "uv":{{"type":"texcoord"}},
            "u":{{"type":"extract","inputs":{{"in":{{"node":"uv"}}}}}},
            "step":{{"type":"divide","inputs":{{"in1":{{"node":"u"}},"in2":4096}}}},
            "n":{{"type":"{node}","inputs":{{"in":{{"node":"step"}}{inputs}}}}},
            "grey":{{"type":"luminance","inputs":{{"in":{{"node":"n"}},"lumacoeffs":[0.2126,0.7152,0.0722]}}}},
            "light":{{"type":"extract","inputs":{{"in":{{"node":"grey"}}}}}}}},
            "outputs":{{"out":{{"node":"{out}"}}}}}}"#
    )
}

/// The point values of 5000 columns.
fn values(json: &str) -> Vec<f64> {
    let points: Vec<_> = (0..5000)
        .map(|i| footprint([f64::from(i) + 0.37, 0.5], [[0.0; 2]; 2]))
        .collect();
    let values = evaluate(json, Method::Point, &points);
    values.into_iter().map(|v| v[0]).collect()
}

#[test]
fn numbers_are_uniform_between_their_bounds() {
    let values = values(&columns("randomfloat", r#","min":-1,"max":3"#, "n"));
    has_moments("randomfloat", &values, 1.0, 16.0 / 12.0);
    let found = distance(&values, |x| ((x + 1.0) / 4.0).clamp(0.0, 1.0));
    assert!(found < 1.95 / 5000f64.sqrt(), "{found}");
}

/// Footprints in cells: the size across, how much longer, and the angle. Across the columns alone,
/// since what is along them does not matter, but for the last.
const FOOTPRINTS: [(f64, f64, f64); 5] = [
    (1e-3, 50.0, 0.0),
    (1e-3, 300.0, 0.0),
    (1e-3, 1000.0, 0.0),
    (1e-3, 2500.0, 0.0),
    (0.2, 8.0, 50.0),
];

/// Holds the errors of the mean, in standard deviations of the number, and of the local deviation.
fn held(json: &str, sd: f64, [mean, deviation]: [f64; 2]) {
    for (size, ratio, degrees) in FOOTPRINTS {
        // Edges beyond the window matter most where hardly any is within it.
        let deviation = if size * ratio < 0.1 { 0.04 } else { deviation };
        let axes = axes(size, ratio, degrees);
        let finest = if size < 0.1 {
            5e-3 * (size * ratio).min(2.0)
        } else {
            0.06
        };
        for (method, found) in [Method::Local, Method::Quad].into_iter().zip(errors(
            json,
            &places(20, 40.0),
            axes,
            finest,
            &[Method::Local, Method::Quad],
        )) {
            println!("{size}, {ratio}:1 at {degrees}, {method}: {found:?}");
            assert!(
                found.mean < mean * sd && found.deviation < deviation,
                "{size}, {ratio}:1 at {degrees} by {method}: {found:?}"
            );
        }
    }
}

#[test]
fn numbers_are_filtered_as_cells_of_a_line() {
    held(&columns("randomfloat", "", "n"), SD, [0.005, 0.005]);
    // What has faded is off by what the mean of a footprint differs from that of all numbers,
    // 1/√(2σ√π) = 0.26 standard deviations.
    let json = columns("randomfloat", "", "n");
    let found = errors(
        &json,
        &places(30, 400.0),
        axes(4.2, 1.0, 0.0),
        0.5,
        &[Method::Local],
    );
    println!("{found:?}");
    assert!(
        found[0].mean < 0.27 * SD && found[0].deviation < 0.085,
        "{found:?}"
    );
}

/// Bounds within which all three numbers matter.
const BOUNDS: &str = r#","huelow":0.9,"huehigh":1.4,"saturationlow":0.3,"brightnesslow":0.2"#;

#[test]
fn colors_are_no_gaussians() {
    let values = values(&columns("randomcolor", "", "n"));
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n;
    let found = distance(&values, |x| normal((x - mean) / variance.sqrt()));
    assert!((found - 0.22).abs() < 0.02, "{found}");
}

#[test]
fn colors_are_filtered_with_their_covariance() {
    for out in ["n", "light"] {
        let json = columns("randomcolor", BOUNDS, out);
        let values = values(&json);
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let square = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
        let variance = square / values.len() as f64;
        held(&json, variance.sqrt(), [0.005, 0.005]);
        // All colours.
        let far = [footprint([0.3, 0.4], axes(40.0, 1.0, 0.0))];
        for method in [Method::Ensemble, Method::Local, Method::Quad] {
            let [found] = evaluate(&json, method, &far)[..] else {
                panic!("one footprint")
            };
            has_moments(out, &values, found[0], found[1]);
        }
    }
}

#[test]
fn a_mask_gives_what_is_between_two_numbers() {
    let json = r#"{"version":1,"name":"mask","nodes":{
        "board":{"type":"checkerboard"},
        "red":{"type":"extract","inputs":{"in":{"node":"board"}}},
        "n":{"type":"randomfloat","inputs":{"in":{"node":"red"}}}},
        "outputs":{"out":{"node":"n"}}}"#;
    let places: Vec<_> = (places(20, 5.0).iter())
        .map(|&p| footprint(p, axes(0.05, 1.0, 0.0)))
        .collect();
    let at = |red: u8| {
        let json = format!(
            r#"{{"version":1,"name":"n","nodes":{{"n":{{"type":"randomfloat","inputs":{{"in":{red}}}}}}},"outputs":{{"out":{{"node":"n"}}}}}}"#
        );
        evaluate(&json, Method::Point, &places[..1])[0][0]
    };
    let (low, high) = (at(0), at(1));
    assert!((low - high).abs() > 0.05, "{low} and {high} differ");
    let board = json.replace(r#""out":{"node":"n"}"#, r#""out":{"node":"red"}"#);
    let reds = evaluate(&board, Method::Local, &places);
    for (found, red) in evaluate(json, Method::Local, &places).iter().zip(reds) {
        let mean = low + (high - low) * red[0];
        let variance = (high - low).powi(2) * red[1];
        assert!(
            (found[0] - mean).abs() < 1e-6 && (found[1] - variance).abs() < 1e-6,
            "{found:?}, not {mean} and {variance}"
        );
    }
}
