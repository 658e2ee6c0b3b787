//! The manifest binds every target: what it says is in the texts, and has the form that its schema says.

use mipless::artifact::{Artifact, Recipe};
use mipless::manifest::{Manifest, sha256};
use mipless::target::Target;
use mipless::wgsl::Entry;
use mipless::{Method, Options, Texture};
use mipless_tests::case::graphs;
use rayon::prelude::*;

fn artifact(texture: &Texture, method: Method, entry: Entry) -> Artifact {
    // GLSL ES 3.00 has no compute shaders.
    let has_compute = |target: &Target| entry != Entry::Compute || *target != Target::GlslEs;
    let targets = Target::ALL.into_iter().filter(has_compute);
    let recipe = Recipe {
        options: Options {
            method,
            ..Options::default()
        },
        emission: entry.into(),
        targets: targets.collect(),
        forms: Vec::new(),
        is_shaded: false,
        source: None,
    };
    Artifact::new(texture, &recipe).expect("every target takes the shader")
}

/// What of the manifest is not in the texts.
fn missing(artifact: &Artifact) -> Vec<String> {
    let manifest = &artifact.manifest;
    let mut missing = Vec::new();
    for file in &artifact.files {
        let Some(target) = manifest.targets.get(&file.key) else {
            assert_eq!(file.key, "tables");
            let data = manifest.tables_data.as_ref().expect("there are tables");
            assert_eq!(data.sha256, sha256(&file.bytes));
            assert_eq!(data.length as usize * 4, file.bytes.len());
            continue;
        };
        assert_eq!(
            (&target.file, &target.sha256),
            (&file.name, &sha256(&file.bytes))
        );
        let Ok(text) = std::str::from_utf8(&file.bytes) else {
            assert_eq!(file.key, "spirv");
            continue;
        };
        let mut wanted: Vec<String> = target.function.iter().map(|f| format!("{f}(")).collect();
        wanted.extend(
            target
                .entry_point
                .iter()
                .map(|entry| format!("{}(", entry.name)),
        );
        wanted.extend(target.varyings.iter().map(|at| at.name.clone()));
        // A semantic of its own is written without its number where there is one output.
        wanted.extend(target.colors.iter().map(|at| at.name.clone()));
        for binding in &target.bindings {
            wanted.extend(binding.name.clone());
            wanted.extend(binding.block.clone());
            // GLSL ES finds textures by their names alone.
            wanted.extend((file.key != "glsl-es").then(|| binding.place.clone()));
            assert!(file.key != "glsl" || binding.block.is_some(), "{binding:?}");
        }
        if let Some(sizes) = &target.buffer_sizes {
            wanted.push(format!("[[buffer({})]]", sizes.buffer));
            assert_eq!(text.matches("uint size").count(), sizes.of.len());
        }
        let is_missing = |word: &&String| !text.contains(word.as_str());
        let words = wanted.iter().filter(is_missing);
        missing.extend(words.map(|word| format!("{}: {word}", file.name)));
    }
    missing
}

fn invalid(manifest: &Manifest) -> Vec<String> {
    let schema = mipless::manifest::manifest_schema();
    let validator = jsonschema::validator_for(schema.as_value()).expect("the schema is one");
    let value: serde_json::Value = serde_json::from_str(&manifest.to_json()).expect("JSON");
    let errors = validator.iter_errors(&value);
    errors
        .map(|error| format!("{error} at {}", error.instance_path))
        .collect()
}

#[test]
fn what_a_manifest_says_is_in_the_texts() {
    graphs().par_iter().for_each(|case| {
        for entry in [Entry::Fragment, Entry::Compute] {
            let artifact = artifact(&case.texture, Method::Point, entry);
            assert_eq!(missing(&artifact), [""; 0], "{}", case.name);
            assert_eq!(invalid(&artifact.manifest), [""; 0], "{}", case.name);
            let dispatch = artifact.manifest.dispatch.as_ref();
            assert_eq!(dispatch.is_some(), entry == Entry::Compute);
        }
    });
}

#[test]
fn a_manifest_predicts_the_errors_of_auto_by_the_size_of_a_pixel() {
    let all = graphs();
    let case = all.iter().find(|case| case.name == "camouflage");
    let texture = &case.expect("the graph").texture;
    let manifest = artifact(texture, Method::Auto, Entry::Fragment).manifest;
    assert_eq!(invalid(&manifest), [""; 0]);
    let output = &manifest.outputs[0];
    assert_eq!(output.color_space, "linear-rec709");
    let predicted = output.predicted_error.expect("`auto` is audited");
    assert!(output.errors.len() > 4, "{:?}", output.errors);
    let worst = output.errors.iter().map(|band| band.error);
    assert!(predicted > 0.0 && worst.clone().all(|error| error < 2.0 * predicted + 0.1));
    let sizes: Vec<f32> = output.errors.iter().map(|band| band.pixel).collect();
    assert!(sizes.is_sorted(), "{sizes:?}");
    let point = artifact(texture, Method::Point, Entry::Fragment).manifest;
    assert_eq!(point.outputs[0].predicted_error, None);
}

#[test]
fn a_manifest_says_what_sliders_show() {
    let json = r#"{ "version": 1, "name": "steps",
        "inputs": { "scale": { "type": "float", "value": 4, "min": 1, "max": 9, "soft_min": 2,
            "soft_max": 8, "doc": "Steps a unit." } },
        "nodes": { "noise": { "type": "noise2d", "inputs": { "frequency": { "input": "scale" } } },
            "place": { "type": "position" },
            "more": { "type": "noise3d", "inputs": { "position": { "node": "place" } } } },
        "outputs": { "height": { "node": "noise" }, "depth": { "node": "more" } } }"#;
    let texture = Texture::from_json(json).expect("the graph has no mistakes");
    let manifest = artifact(&texture, Method::Local, Entry::Compute).manifest;
    let parameter = &manifest.parameters[0];
    assert_eq!(
        (parameter.soft_min, parameter.soft_max),
        (Some(2.0), Some(8.0))
    );
    assert_eq!(parameter.doc, "Steps a unit.");
    let names: Vec<&str> = manifest.arguments.iter().map(|a| a.name.as_str()).collect();
    assert_eq!(names, ["footprint", "position", "parameters"]);
    let sizes: Vec<(&str, u32)> = (manifest.structs.iter())
        .map(|layout| (layout.name.as_str(), layout.size))
        .collect();
    let wanted = [
        ("Footprint", 32),
        ("Position", 64),
        ("Pixel", 96),
        ("StepsParameters", 16),
    ];
    assert_eq!(sizes, wanted);
    assert_eq!(manifest.bindings[0].element, "Pixel");
    assert_eq!(manifest.outputs[1].color_space, "data");

    let check = mipless::CheckOptions::default();
    let baked = texture
        .baked(&[("scale", "5")], &check)
        .expect("it is in range");
    let baked = artifact(&baked, Method::Local, Entry::Compute).manifest;
    assert!(baked.parameters.is_empty() && baked.arguments.len() == 2);
    assert!(texture.baked(&[("scale", "10")], &check).is_err());
    assert!(texture.baked(&[("scal", "5")], &check).is_err());
}

#[test]
fn a_baked_input_is_what_it_was_set_to() {
    let case = graphs().into_iter().find(|case| case.name == "parquet");
    let texture = case.expect("the graph").texture;
    let options = Options {
        method: Method::Point,
        ..Options::default()
    };
    let settings = [("scale", "3"), ("light", "0.5,0.5,0.7")];
    let baked = texture.baked(&settings, &mipless::CheckOptions::default());
    let baked = baked.expect("the values are in range");
    assert_eq!(baked.parameters().len() + 2, texture.parameters().len());
    let mut live = texture.evaluator(&options);
    live.set("scale", &[3.0]).expect("it is there");
    live.set("light", &[0.5, 0.5, 0.7]).expect("it is there");
    let mut constant = baked.evaluator(&options);
    let pixels: Vec<mipless::Footprint> = (0..100)
        .map(|index| mipless::Footprint {
            uv: [0.013 * index as f32, 0.37 + 0.005 * index as f32],
            ..mipless::Footprint::default()
        })
        .collect();
    let (live, constant) = (live.evaluate(&pixels), constant.evaluate(&pixels));
    for (live, constant) in live.iter().flatten().zip(constant.iter().flatten()) {
        assert!((live - constant).abs() < 1e-4, "{live} {constant}");
    }
}
