//! Spectral noise: its distribution, its spectra, and the class of every source.

use crate::truth::{
    axes, distance, errors, evaluate, footprint, graph, has_moments, normal, places, sample,
};
use mipless_codegen::Method;
use mipless_graph::{CheckOptions, Class, check, load};

const BAND: &str = r#""amplitude":4"#;
const POWER: &str = r#""amplitude":4,"spectrum":"power","bandwidth":3,"falloff":0.5"#;
const LIST: &str = r#""amplitude":4,"spectrum":"list","waves":48,"lines":[{"at":0.5,"value":1},{"at":1,"value":0.7},{"at":2,"value":0.5}]"#;

fn class(json: &str) -> Result<Class, Vec<String>> {
    let specs: Vec<_> = mipless_nodes::catalogue().iter().map(|d| d.spec).collect();
    let loaded = load(json, &specs);
    let Some(graph) = loaded.graph else {
        return Err(loaded.diagnostics.iter().map(|d| d.to_string()).collect());
    };
    let checked = check(graph, &CheckOptions::default()).expect("checks");
    Ok(checked.signals()[0].class)
}

#[test]
fn values_are_nearly_gaussian_of_the_stated_moments() {
    for inputs in [BAND, POWER, LIST] {
        let json = graph("spectralnoise2d", inputs);
        let Ok(Class::Gaussian { deviation }) = class(&json) else {
            panic!("{inputs} is Gaussian")
        };
        let values = sample(&json, 6400, 7.3);
        has_moments(inputs, &values, 0.0, 1.0);
        let found = distance(&values, normal);
        let limit = f64::from(deviation) + 1.95 / 80.0;
        assert!(found < limit, "{inputs}: {found}, limit {limit}");
    }
}

#[test]
fn every_spectrum_is_filtered_exactly() {
    for inputs in [POWER, LIST] {
        let json = graph("spectralnoise2d", inputs);
        for (size, ratio) in [(0.1, 1.0), (0.05, 8.0)] {
            let axes = axes(size, ratio, 20.0);
            let found = errors(&json, &places(12, 40.0), axes, 0.3, &[Method::Quad])[0];
            assert!(
                found.mean < 1e-3,
                "{inputs} at {size}, {ratio}:1: {found:?}"
            );
        }
    }
}

#[test]
fn far_coordinates_keep_their_detail() {
    // Wave vectors are multiples of 1/1024: so far the waves are where they were.
    let json = graph("spectralnoise2d", BAND);
    let at = |offset: f64| {
        let points: Vec<_> = (places(40, 5.0).iter())
            .map(|p| footprint([p[0] + offset, p[1] - offset], axes(0.1, 1.0, 0.0)))
            .collect();
        evaluate(&json, Method::Local, &points)
    };
    for (a, b) in at(0.0).iter().zip(at(1_024_000.0)) {
        assert!(
            (a[0] - b[0]).abs() < 1e-4 && (a[1] - b[1]).abs() < 1e-4,
            "{a:?} {b:?}"
        );
    }
}

#[test]
fn the_check_reports_the_class_of_every_source() {
    let deviation = |node: &str, inputs: &str| match class(&graph(node, inputs)) {
        Ok(Class::Gaussian { deviation }) => ("gaussian", deviation),
        Ok(Class::Moments { deviation }) => ("moments", deviation),
        other => panic!("{node}: {other:?}"),
    };
    assert_eq!(deviation("cellnoise2d", ""), ("moments", 0.058));
    assert_eq!(deviation("whitenoise2d", ""), ("moments", 0.058));
    assert_eq!(
        deviation("worleynoise2d", r#""output":"F2-F1""#),
        ("moments", 0.1)
    );
    assert_eq!(
        deviation("phasornoise2d", r#""profile":"square""#),
        ("moments", 0.342)
    );
    let (kind, few) = deviation("gabornoise2d", r#""impulses":8"#);
    let (_, many) = deviation("gabornoise2d", r#""impulses":32"#);
    assert!(kind == "gaussian" && few > 3.0 * many, "{few} {many}");
    let (kind, few) = deviation("spectralnoise2d", r#""waves":8"#);
    let (_, many) = deviation("spectralnoise2d", r#""waves":64"#);
    assert!(kind == "gaussian" && few > 7.0 * many, "{few} {many}");
}

#[test]
fn a_line_without_a_frequency_is_a_mistake() {
    let lines = r#""spectrum":"list","lines":[{"at":0,"value":1},{"at":1,"value":1}]"#;
    let mistakes = class(&graph("spectralnoise2d", lines)).expect_err("0 is no frequency");
    assert!(
        mistakes
            .iter()
            .any(|m| m.contains("a stop of `lines` is at 0")),
        "{mistakes:?}"
    );
}
