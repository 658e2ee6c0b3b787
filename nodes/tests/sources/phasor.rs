//! Phasor noise against dense numerical truth, and its distribution.

use crate::truth::{axes, distance, errors, graph, has_moments, places, sample};
use mipless_codegen::Method;

fn noise(profile: &str) -> String {
    graph(
        "phasornoise2d",
        &format!(r#""amplitude":2,"profile":"{profile}","orientation":30"#),
    )
}

#[test]
fn phases_are_uniform() {
    let arcsine = |x: f64| 0.5 + x.clamp(-1.0, 1.0).asin() / std::f64::consts::PI;
    let uniform = |x: f64| (0.5 + 0.5 * x).clamp(0.0, 1.0);
    for (profile, variance) in [
        ("sine", 0.5),
        ("triangle", 1.0 / 3.0),
        ("sawtooth", 1.0 / 3.0),
    ] {
        let values = sample(&noise(profile), 4900, 17.0);
        has_moments(profile, &values, 0.0, variance);
        let found = if profile == "sine" {
            distance(&values, arcsine)
        } else {
            distance(&values, uniform)
        };
        // Kolmogorov's statistic exceeds 1.95/√n once in a thousand samples.
        assert!(found < 1.95 / 70.0, "{profile}: {found}");
    }
    let values = sample(&noise("square"), 4900, 17.0);
    has_moments("square", &values, 0.0, 1.0);
    assert!(values.iter().all(|x| x.abs() > 0.999_999), "two values");
}

#[test]
fn means_and_deviations_are_near() {
    // Errors of the mean, in standard deviations of the noise, and of the standard deviation.
    for (size, mean, deviation) in [
        (0.02, 0.08, 0.08),
        (0.05, 0.06, 0.09),
        (0.1, 0.11, 0.12),
        (0.2, 0.18, 0.09),
        (0.5, 0.09, 0.04),
    ] {
        for (profile, sd) in [
            ("sine", 0.707),
            ("triangle", 0.577),
            ("sawtooth", 0.577),
            ("square", 1.0),
        ] {
            let json = noise(profile);
            let axes = axes(size, 1.0, 0.0);
            let found = errors(&json, &places(40, 40.0), axes, 0.1, &[Method::Local])[0];
            assert!(found.mean < mean * sd, "{profile} at {size}: {found:?}");
            assert!(
                found.deviation < deviation,
                "{profile} at {size}: {found:?}"
            );
        }
    }
}
