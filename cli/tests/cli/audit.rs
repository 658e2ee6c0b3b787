//! What `check` measures: which closed forms are wrong, what is done instead, and how far that is off.

use crate::folder::Folder;

/// Stripes by the parity of a rounded coordinate, beside a noise.
const STRIPES: &str = r#"{
    "version": 1,
    "nodes": {
        "uv": { "type": "texcoord" },
        "x": { "type": "multiply", "inputs": { "in1": { "node": "uv" }, "in2": 8 } },
        "u": { "type": "extract", "inputs": { "in": { "node": "x" }, "index": 0 } },
        "column": { "type": "floor", "inputs": { "in": { "node": "u" } } },
        "stripe": { "type": "modulo", "inputs": { "in1": { "node": "column" }, "in2": 2 } },
        "noise": { "type": "noise2d" }
    },
    "outputs": { "mask": { "node": "stripe" }, "height": { "node": "noise" } }
}"#;

#[test]
fn check_says_what_is_done_instead_of_a_closed_form() {
    let folder = Folder::new();
    folder.write("stripes.json", STRIPES);
    let people = folder.run("check stripes.json").is(0).out;
    assert!(
        people.contains("stripe (modulo) repeats, and is read from a map of its period"),
        "{people}"
    );
    assert!(!people.contains("measured sRGB RMS"), "{people}");
    let measured = folder.run("check stripes.json --measure").is(0).out;
    assert!(measured.contains("mask: measured sRGB RMS"), "{measured}");

    let json = folder
        .run("check stripes.json --measure --json")
        .is(0)
        .json();
    let audit = &json["audits"][0];
    let replaced = &audit["replaced"][0];
    assert_eq!(replaced["node"], "stripe");
    assert_eq!(replaced["pointer"], "/nodes/stripe");
    assert_eq!(replaced["remedy"], "repeated");
    let bands = audit["outputs"][0]["measured"].as_array().expect("bands");
    assert_eq!(bands.len(), 7);
    let largest = |of: &str| {
        let errors = bands
            .iter()
            .map(|band| band[of].as_f64().expect("an error"));
        errors.fold(0.0, f64::max)
    };
    assert!(largest("closed") > 0.2 && largest("auto") < 0.04, "{audit}");
}

#[test]
fn check_finds_nothing_wrong_with_what_is_exact() {
    let folder = Folder::new();
    let noise = r#"{ "version": 1, "nodes": { "noise": { "type": "noise2d" } },
        "outputs": { "height": { "node": "noise" } } }"#;
    folder.write("noise.json", noise);
    let json = folder.run("check noise.json --json").is(0).json();
    let audit = &json["audits"][0];
    assert_eq!(audit["replaced"], serde_json::json!([]));
    assert_eq!(audit["outputs"], serde_json::json!([]));
    assert_eq!(audit["too_large"], false);
}
