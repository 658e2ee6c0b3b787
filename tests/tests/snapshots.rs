//! The IR of every graph by `local`, its WGSL by `local` and `auto`, and that compilation is
//! deterministic.
//!
//! After a change that is meant, look at `git diff tests/tests/snapshots` of
//! `INSTA_UPDATE=always cargo test -p mipless-tests --test snapshots`, and commit it.

use mipless::wgsl::{Entry, emit};
use mipless::{Method, Options, Program, Texture};
use mipless_codegen::ir::{Module, verify};
use mipless_tests::case::{Case, all, graphs, materials};
use mipless_tests::{METHODS, generated, name_of};
use std::fmt::Write as _;
use std::path::Path;

/// What is shown of every graph. The IR of `auto` is twice as long and holds nothing that its WGSL
/// does not show.
const SHOWN: [(Method, &str); 3] = [
    (Method::Local, "ir"),
    (Method::Local, "wgsl"),
    (Method::Auto, "wgsl"),
];

/// What is shown of every material, whose parts are many and alike.
const SHOWN_OF_MATERIALS: [(Method, &str); 1] = [(Method::Local, "wgsl")];

/// Every graph with what is shown of it.
fn shown() -> Vec<(Case, Vec<(Method, &'static str)>)> {
    let graphs = graphs().into_iter().map(|case| (case, SHOWN.to_vec()));
    let materials = materials().into_iter();
    let materials = materials.map(|case| (case, SHOWN_OF_MATERIALS.to_vec()));
    graphs.chain(materials).collect()
}

fn compile(texture: &Texture, method: Method) -> Program {
    texture.compile(&Options {
        method,
        ..Options::default()
    })
}

/// The IR with the length of each table in place of its numbers.
fn ir_text(program: &Program) -> String {
    let mut text = String::new();
    for line in program.module.to_string().lines() {
        let table = line
            .strip_prefix("table ")
            .and_then(|rest| rest.split_once(" = ["));
        let written = match table {
            Some((name, numbers)) => {
                writeln!(
                    text,
                    "table {name}: {} numbers",
                    numbers.split(", ").count()
                )
            }
            None => writeln!(text, "{line}"),
        };
        written.expect("strings grow");
    }
    text
}

fn name_of_snapshot(case: &Case, method: Method, what: &str) -> String {
    format!("{}_{}_{what}", case.name, name_of(method))
}

#[test]
fn every_graph_compiles_to_what_it_did() {
    let mut settings = insta::Settings::clone_current();
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| {
        for (case, shown) in shown() {
            for (method, what) in shown {
                let program = compile(&case.texture, method);
                let text = match what {
                    "ir" => ir_text(&program),
                    _ => emit(&program, &Entry::None.into()).source,
                };
                insta::assert_snapshot!(name_of_snapshot(&case, method, what), text);
            }
        }
    });
}

#[test]
fn no_snapshot_is_left_over() {
    let used: Vec<String> = (shown().iter())
        .flat_map(|(case, shown)| {
            let names = shown
                .iter()
                .map(|&(method, what)| name_of_snapshot(case, method, what));
            names.map(|name| name + ".snap").collect::<Vec<_>>()
        })
        .collect();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/snapshots");
    let stale: Vec<String> = generated::names(&folder, ".snap")
        .into_iter()
        .filter(|name| !used.contains(name))
        .collect();
    assert!(stale.is_empty(), "delete what no test uses: {stale:?}");
}

#[test]
fn compilation_is_deterministic() {
    for case in all() {
        let again = Case::new(case.name.as_str(), case.text.as_str());
        for method in METHODS {
            let programs = [&case, &again].map(|case| compile(&case.texture, method));
            assert!(
                programs[0] == programs[1],
                "{} by {method}: two programs",
                case.name
            );
            let texts = programs.map(|program| emit(&program, &Entry::Compute.into()).source);
            assert!(
                texts[0] == texts[1],
                "{} by {method}: two shaders",
                case.name
            );
        }
    }
}

#[test]
fn every_program_is_valid_and_survives_its_text_form() {
    for case in all() {
        for method in METHODS {
            let module = compile(&case.texture, method).module;
            if let Err(violations) = verify(&module) {
                panic!("{} by {method}: {}", case.name, violations[0]);
            }
            let text = module.to_string();
            let read =
                Module::parse(&text).unwrap_or_else(|error| panic!("{}: {error}", case.name));
            assert!(
                read == module,
                "{} by {method} changes in its text form",
                case.name
            );
        }
    }
}
