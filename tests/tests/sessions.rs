//! The laws of sessions: an edit that is taken back was never made; what edits have made is what the text
//! of it is; and what is compiled along the way is what is compiled from scratch, to the byte.

use mipless::session::{Edit, Session, Setup};
use mipless::wgsl::{self, emit};
use mipless::{Catalogue, Diagnostic, Document, Method, Options, Texture};
use mipless_tests::random::Random;
use mipless_tests::{cases, random_edit, random_graph};
use serde_json::{Value, json};

/// Edits of each random graph.
const EDITS: usize = 12;

fn edit(json: Value) -> Edit {
    serde_json::from_value(json.clone()).unwrap_or_else(|error| panic!("{json}: {error}"))
}

/// What a session shows: the document, its mistakes, and which outputs are current.
fn face(session: &Session) -> (Document, Vec<Diagnostic>, Vec<(String, bool)>) {
    let outputs = session.outputs();
    let mut outputs: Vec<(String, bool)> = outputs
        .map(|output| (output.name.clone(), output.is_current))
        .collect();
    outputs.sort();
    (
        session.document().clone(),
        session.diagnostics().to_vec(),
        outputs,
    )
}

fn opened(text: &str) -> Session {
    Session::open(text).unwrap_or_else(|mistakes| panic!("{}\n{text}", mistakes[0]))
}

/// Random sessions, with `look` at each of them before an edit and after it.
fn edited(seeds: u64, mut look: impl FnMut(&mut Session, &mut Random)) {
    for seed in 0..seeds {
        let mut random = Random::new(0x5e55 + seed);
        let text = random_graph::text(&mut random, 4 + seed as usize % 17);
        let mut session = opened(&text);
        for _ in 0..EDITS {
            look(&mut session, &mut random);
        }
    }
}

#[test]
fn an_edit_that_is_taken_back_was_never_made() {
    let (mut done, mut refused) = (0, 0);
    edited(u64::from(cases(40)), |session, random| {
        session.commit();
        let before = face(session);
        let steps = session.steps().0;
        let edit = random_edit::edit(random, session.document());
        match session.apply(edit.clone()) {
            Err(reason) => {
                refused += 1;
                assert!(!reason.message.is_empty());
                assert_eq!(face(session), before, "{edit:?} is refused");
            }
            Ok(_) => {
                done += 1;
                session.commit();
                let after = face(session);
                assert_eq!(session.steps(), (steps + 1, 0));
                session.undo().expect("a step");
                let undone = face(session);
                assert_eq!((&undone.0, &undone.1), (&before.0, &before.1), "{edit:?}");
                session.redo().expect("what was taken back");
                assert_eq!(face(session).0, after.0, "{edit:?}");
                assert_eq!(face(session).1, after.1, "{edit:?}");
            }
        }
    });
    assert!(done > refused, "{done} edits, {refused} refused");
}

#[test]
fn all_edits_taken_back_give_the_document_to_the_byte() {
    for seed in 0..u64::from(cases(20)) {
        let mut random = Random::new(77 + seed);
        let mut session = opened(&random_graph::text(&mut random, 12));
        let text = session.to_text();
        for _ in 0..EDITS {
            let edit = random_edit::edit(&mut random, session.document());
            let _ = session.apply(edit);
        }
        let last = session.to_text();
        while session.undo().is_some() {}
        assert_eq!(session.to_text(), text);
        while session.redo().is_some() {}
        assert_eq!(session.to_text(), last);
    }
}

#[test]
fn what_edits_have_made_is_what_its_text_is_to_the_byte_of_its_shaders() {
    let options = Options {
        method: Method::Local,
        ..Options::default()
    };
    let (mut sound, mut broken) = (0, 0);
    edited(u64::from(cases(12)), |session, random| {
        let edit = random_edit::edit(random, session.document());
        let _ = session.apply(edit.clone());
        session.commit();
        let text = session.to_text();
        let loaded = opened(&text);
        assert_eq!(loaded.document(), session.document(), "{edit:?}\n{text}");
        assert_eq!(loaded.diagnostics(), session.diagnostics(), "{edit:?}");
        assert_eq!(loaded.parameters(), session.parameters(), "{edit:?}");
        let current = |session: &Session| {
            let outputs = session.outputs().filter(|output| output.is_current);
            outputs
                .map(|output| output.name.clone())
                .collect::<Vec<_>>()
        };
        assert_eq!(current(&loaded), current(session), "{edit:?}\n{text}");
        let is_broken = session.diagnostics().iter().any(Diagnostic::is_error);
        match Texture::from_json(&text) {
            Err(mistakes) => {
                broken += 1;
                assert!(is_broken, "{edit:?}: {}\n{text}", mistakes[0]);
            }
            Ok(texture) => {
                sound += 1;
                assert!(!is_broken, "{edit:?}: {:?}\n{text}", session.diagnostics());
                // Not by a session, which would know it.
                let scratch = emit(&texture.compile(&options), &wgsl::Options::default());
                for output in session.outputs() {
                    let shader = output.compiled.shader(&wgsl::Options::default());
                    assert!(shader.source == scratch.source, "{edit:?}\n{text}");
                }
            }
        }
    });
    assert!(
        sound > 20 && broken > 5,
        "{sound} sound graphs, {broken} broken"
    );
}

#[test]
fn a_session_is_saved_and_gone_on_with() {
    for seed in 0..10 {
        let mut random = Random::new(900 + seed);
        let mut session = opened(&random_graph::text(&mut random, 10));
        for _ in 0..EDITS {
            let edit = random_edit::edit(&mut random, session.document());
            let _ = session.apply(edit);
        }
        session.undo();
        let text = serde_json::to_string(&session.save()).expect("data");
        let saved = serde_json::from_str(&text).expect("what was written");
        let mut other = Session::restore(&saved, Setup::default()).expect("what was saved");
        assert_eq!(other.document(), session.document());
        assert_eq!(other.steps(), session.steps());
        assert_eq!(other.save(), session.save());
        while session.undo().is_some() {
            assert!(other.undo().is_some());
        }
        assert_eq!(other.document(), session.document());
    }
}

const SKY: &str = r##"{ "version": 1, "name": "sky",
    "inputs": { "scale": { "type": "float", "value": 4, "min": 1, "max": 9 } },
    "nodes": {
        "noise": { "type": "fractal2d", "inputs": { "frequency": { "input": "scale" } } },
        "grain": { "type": "noise2d", "inputs": { "frequency": 40 } },
        "rough": { "type": "multiply", "inputs": { "in1": { "node": "grain" }, "in2": 0.5 } },
        "ramp": { "type": "colorramp", "inputs": { "in": { "node": "noise" },
            "stops": [ { "at": -0.5, "value": "#2a5f9e" }, { "at": 0.5, "value": "#ffffff" } ] } },
        "mixed": { "type": "mix", "inputs": { "bg": { "node": "ramp" }, "fg": "#808080",
            "mix": { "node": "rough" } } } },
    "outputs": { "base_color": { "node": "mixed" }, "roughness": { "node": "rough" } } }"##;

#[test]
fn a_drag_is_one_step_and_compiles_nothing() {
    let mut session = opened(SKY);
    let before = session
        .outputs()
        .next()
        .expect("an output")
        .compiled
        .clone();
    for value in [5.0, 6.0, 7.5] {
        let change = session
            .apply(edit(
                json!({ "edit": "set_input", "input": "scale", "value": value }),
            ))
            .expect("an input");
        assert_eq!(change.parameters, ["scale"]);
        assert!(change.shaders.is_empty() && !change.diagnostics_changed);
    }
    assert_eq!(session.numbers(), [7.5]);
    let now = &session.output("base_color").expect("an output").compiled;
    assert!(std::sync::Arc::ptr_eq(&before, now));
    // The value of a node is a step too, until the gesture ends.
    session.commit();
    let set = |value: f64| {
        edit(json!({ "edit": "set", "node": "grain", "input": "frequency", "value": value }))
    };
    session.apply(set(20.0)).expect("a node");
    session.apply(set(30.0)).expect("a node");
    session.commit();
    session.apply(set(35.0)).expect("a node");
    assert_eq!(session.steps().0, 3);
    session.undo();
    session.undo();
    let grain = &session.document().body.nodes["grain"].inputs["frequency"];
    assert_eq!(grain.to_json(), json!(40));
    session.undo();
    assert_eq!((session.numbers(), session.undo()), (vec![4.0], None));
    // A value outside of the range is a mistake, and the next one mends it.
    let out = edit(json!({ "edit": "set_input", "input": "scale", "value": 50 }));
    let change = session.apply(out).expect("an input");
    assert!(change.diagnostics.iter().any(Diagnostic::is_error));
    assert_eq!(
        (&change.broken[..], change.removed.len()),
        (&["base_color".to_owned()][..], 0)
    );
}

#[test]
fn only_the_outputs_that_an_edit_reaches_have_another_shader() {
    let mut session = opened(SKY);
    let stop = json!({ "edit": "set_stop", "node": "ramp", "index": 1, "value": "#f0f0ff" });
    let change = session.apply(edit(stop)).expect("a stop");
    assert_eq!(change.shaders, ["base_color"]);
    let loose = json!({ "edit": "add", "nodes": { "loose": { "type": "noise2d" } } });
    let change = session.apply(edit(loose)).expect("a free name");
    assert!(change.shaders.is_empty() && change.diagnostics_changed);
    let moved = json!({ "edit": "set_extra", "node": "loose", "extra": { "at": [4, 5] } });
    let change = session.apply(edit(moved)).expect("a node");
    assert!(change.shaders.is_empty() && !change.diagnostics_changed);
    let grain = json!({ "edit": "set", "node": "grain", "input": "seed", "value": 3 });
    let change = session.apply(edit(grain)).expect("a node");
    assert_eq!(change.shaders, ["base_color", "roughness"]);
}

#[test]
fn a_broken_graph_keeps_the_last_good_program_of_each_output() {
    let mut session = opened(SKY);
    let sources = |session: &Session| -> Vec<(String, bool, String)> {
        let outputs = session.outputs();
        outputs
            .map(|output| {
                let shader = output.compiled.shader(&wgsl::Options::default());
                (
                    output.name.clone(),
                    output.is_current,
                    shader.source.clone(),
                )
            })
            .collect()
    };
    let good = sources(&session);
    let cycle =
        json!({ "edit": "connect", "node": "noise", "input": "amplitude", "from": "mixed" });
    let change = session.apply(edit(cycle)).expect("nodes");
    assert_eq!(change.broken, ["base_color"]);
    let broken = sources(&session);
    for (name, is_current, source) in &broken {
        assert_eq!(*is_current, name == "roughness");
        let before = good.iter().find(|(known, ..)| known == name);
        assert_eq!(before.map(|before| &before.2), Some(source));
    }
    // What the break does not reach goes on.
    let seed = json!({ "edit": "set", "node": "grain", "input": "seed", "value": 9 });
    let change = session.apply(edit(seed)).expect("a node");
    assert_eq!(change.shaders, ["roughness"]);
    let roughness = session.output("roughness").expect("it is there");
    assert_eq!(roughness.compiled.outputs().len(), 1);
    // Mended, all are of one program again.
    session.undo();
    let change = session.undo().expect("a step");
    assert_eq!((change.broken.len(), sources(&session)), (0, good));
}

#[test]
fn a_group_and_back_is_the_same_texture() {
    let mut session = opened(SKY);
    let options = wgsl::Options::default();
    let mean = |session: &Session| {
        let compiled = &session.output("base_color").expect("an output").compiled;
        let footprints = [0.1, 0.4, 0.8].map(|u| mipless::Footprint {
            uv: [u, 0.3],
            du: [0.01, 0.0],
            dv: [0.0, 0.02],
            ..mipless::Footprint::default()
        });
        compiled.evaluator().evaluate(&footprints)
    };
    let before = mean(&session);
    let text = session.to_text();
    let group = json!({ "edit": "group", "nodes": ["grain", "rough", "ramp"], "name": "parts" });
    session.apply(edit(group)).expect("nodes");
    assert_eq!(session.diagnostics(), []);
    let sub = &session.document().graphs["parts"];
    assert_eq!(sub.inputs.keys().collect::<Vec<_>>(), ["noise"]);
    assert_eq!(sub.outputs.keys().collect::<Vec<_>>(), ["ramp", "rough"]);
    assert_eq!(mean(&session), before);
    let shader = session
        .output("roughness")
        .expect("an output")
        .compiled
        .shader(&options);
    assert!(shader.source.contains("fn sky(footprint"));
    session
        .apply(edit(json!({ "edit": "ungroup", "node": "parts" })))
        .expect("a sub-graph");
    assert_eq!((session.diagnostics(), mean(&session)), (&[][..], before));
    let nodes = |document: &Document| {
        let mut nodes: Vec<_> = document.body.nodes.clone().into_iter().collect();
        nodes.sort_by(|x, y| x.0.cmp(&y.0));
        (
            nodes,
            document.body.outputs.clone(),
            document.graphs.clone(),
        )
    };
    let (original, _) = Document::parse(&text);
    assert_eq!(
        nodes(session.document()),
        nodes(&original.expect("a document"))
    );
    // What would need itself is refused.
    let group = json!({ "edit": "group", "nodes": ["noise", "mixed"], "name": "no" });
    assert_eq!(
        session
            .apply(edit(group))
            .expect_err("ramp lies between")
            .code,
        "group-cycle"
    );
}

#[test]
fn names_are_followed_and_what_is_not_there_is_refused_with_a_suggestion() {
    let mut session = opened(SKY);
    let rename = json!({ "edit": "rename", "node": "noise", "to": "clouds" });
    session.apply(edit(rename)).expect("a node");
    let rename = json!({ "edit": "rename_input", "input": "scale", "to": "size" });
    session.apply(edit(rename)).expect("an input");
    assert_eq!(session.diagnostics(), []);
    let clouds = &session.document().body.nodes["clouds"].inputs["frequency"];
    assert_eq!(clouds.to_json(), json!({ "input": "size" }));
    let reason = session
        .apply(edit(json!({ "edit": "remove", "nodes": ["cloud"] })))
        .expect_err("there is no such node");
    assert_eq!(reason.code, "unknown-node");
    assert_eq!(reason.help.as_deref(), Some("did you mean `clouds`?"));
    let unfinite = json!({ "edit": "set", "node": "grain", "input": "frequency", "value": 1e300 });
    assert!(session.apply(edit(unfinite)).is_err());
    let unknown = json!({ "edit": "set", "node": "grain", "inptu": "frequency", "value": 1 });
    assert!(serde_json::from_value::<Edit>(unknown).is_err());
}

#[test]
fn any_node_is_previewed_whatever_is_wrong_elsewhere() {
    let mut session = opened(SKY);
    let group = json!({ "edit": "group", "nodes": ["grain", "rough"], "name": "parts" });
    session.apply(edit(group)).expect("nodes");
    let broken = json!({ "edit": "set", "node": "mixed", "input": "mix", "value": "nonsense" });
    session.apply(edit(broken)).expect("a node");
    let point = Options {
        method: Method::Point,
        ..Options::default()
    };
    for path in ["noise", "ramp", "parts", "parts/grain"] {
        let preview = session.preview(path, "out", &point).expect("a sound node");
        let values = preview
            .evaluator()
            .evaluate(&[mipless::Footprint::default()]);
        assert!(values[0][0].is_finite(), "{path}");
    }
    assert!(session.preview("mixed", "out", &point).is_err());
    let unknown = session
        .preview("parts/gain", "out", &point)
        .expect_err("no node");
    assert!(unknown[0].is_error());
}

#[test]
fn a_session_moves_between_threads_and_says_the_same_there() {
    fn sent<T: Send>(_: &T) {}
    let session = opened(SKY);
    sent(&session);
    let text = session.to_text();
    let there = std::thread::spawn(move || session.to_text())
        .join()
        .expect("no panic");
    assert_eq!(there, text);
}

#[test]
fn a_new_session_is_built_from_nothing() {
    let mut session = Session::new(Setup::default());
    assert!(session.diagnostics().iter().any(Diagnostic::is_error));
    for json in [
        json!({ "edit": "set_name", "name": "built" }),
        json!({ "edit": "add", "nodes": { "n": { "type": "noise2d" } } }),
        json!({ "edit": "put_output", "output": "height", "node": "n" }),
    ] {
        session.apply(edit(json)).expect("an edit");
    }
    assert_eq!(session.diagnostics(), []);
    let output = session.output("height").expect("an output");
    let shader = output.compiled.shader(&wgsl::Options::default());
    assert!(shader.source.contains("fn built(footprint"));
}

#[test]
fn graphs_of_a_library_are_nodes_of_every_document() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(
        folder.path().join("fluff.json"),
        r#"{ "version": 1, "inputs": { "scale": { "type": "float", "value": 4 } },
            "nodes": { "n": { "type": "noise2d", "inputs": { "frequency": { "input": "scale" } } },
                       "in": { "type": "graph:half", "inputs": { "in": { "node": "n" } } } },
            "outputs": { "out": { "node": "in" } },
            "graphs": { "half": { "inputs": { "in": { "type": "float", "value": 0 } },
                "nodes": { "m": { "type": "multiply", "inputs": { "in1": { "input": "in" }, "in2": 0.5 } } },
                "outputs": { "out": { "node": "m" } } } } }"#,
    )
    .expect("a file");
    let catalogue = Catalogue::shipped()
        .with_library(folder.path())
        .expect("no mistakes");
    let text = r#"{ "version": 1, "nodes": {
        "fluff": { "type": "graph:fluff", "inputs": { "scale": 8 } } },
        "outputs": { "height": { "node": "fluff" } } }"#;
    let setup = Setup {
        catalogue,
        ..Setup::default()
    };
    let session = Session::open_with(text, setup).expect("a document");
    assert_eq!(session.diagnostics(), []);
    assert!(
        session
            .output("height")
            .is_some_and(|output| output.is_current)
    );
    assert!(
        !session.to_text().contains("half"),
        "the library stays where it is"
    );

    std::fs::write(folder.path().join("bad.json"), r#"{ "version": 1,
        "nodes": { "n": { "type": "noise2d", "inputs": { "nothing": 1 } } }, "outputs": { "out": { "node": "n" } } }"#)
        .expect("a file");
    let error = Catalogue::shipped()
        .with_library(folder.path())
        .expect_err("a mistake");
    assert!(error.to_string().contains("bad.json"), "{error}");
}
