//! Tests of the forms, on random programs: they have tables, folds and calls.

use super::*;
use crate::ir::random;
use crate::target::{Target, translate, validate};
use crate::wgsl::emit;
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::TestRunner;

/// The shaders of a few programs, the same in every run.
fn shaders(options: Options) -> Vec<Shader> {
    let mut runner = TestRunner::deterministic();
    (0..12)
        .map(|_| {
            let mut program = random::program().new_tree(&mut runner).unwrap().current();
            program.interface.name = "du".to_owned();
            emit(&program, &options)
        })
        .collect()
}

#[test]
fn tables_are_read_from_a_buffer_a_texture_or_an_argument_in_every_target() {
    for tables in [TableForm::Storage, TableForm::Texture, TableForm::Argument] {
        for entry in [Entry::None, Entry::Fragment, Entry::Compute] {
            let options = Options {
                entry,
                tables,
                ..Options::default()
            };
            for shader in shaders(options) {
                let validated = validate(&shader.source)
                    .unwrap_or_else(|error| panic!("{error}\n{}", shader.source));
                for target in Target::ALL {
                    if target.refuses(&shader).is_some() {
                        continue;
                    }
                    let text = validated.translate(&shader, target);
                    let text = text.unwrap_or_else(|error| panic!("{error}"));
                    let text = String::from_utf8_lossy(&text);
                    let is_text = target != Target::Spirv;
                    if is_text && entry == Entry::None {
                        assert!(text.contains(&format!("{}(", shader.function)), "{text}");
                        assert!(!text.contains("#version"), "{text}");
                        assert!(!text.contains("main("), "{text}");
                        assert!(!text.contains("_group_"), "{text}");
                        assert!(!text.contains("mipless_caller"), "{text}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_target_says_what_it_lacks() {
    let shader = &shaders(Entry::Compute.into())[0];
    let said = translate(shader, Target::GlslEs).unwrap_err();
    assert_eq!(said.to_string(), "glsl-es has no compute shaders");
    let shader = &shaders(Entry::Fragment.into())[0];
    let said = translate(shader, Target::GlslEs).unwrap_err();
    assert_eq!(
        said,
        TranslateError::Lacks(Target::GlslEs, "storage buffers, where the tables are")
    );
}

#[test]
fn every_form_has_a_file_that_calls_the_function() {
    for form in Form::ALL {
        for shader in shaders(form.emission(Options::default())) {
            let validated = validate(&shader.source).unwrap();
            let files = form.files(&validated, &shader, "file", |_| (None, None));
            for file in files.unwrap() {
                let is_definition = file.extension == "mtlx";
                let text = &file.text;
                assert!(text.contains(&shader.function), "{text}");
                assert!(is_definition || text.contains("Footprint"), "{text}");
                assert!(!text.contains("_group_"), "{text}");
            }
        }
    }
}
