//! Tests of the translations.

use super::*;
use crate::ir::random;
use crate::wgsl::{Entry, emit};
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::TestRunner;
use std::io::Write;
use std::process::{Command, Stdio};

/// A few random programs, the same in every run: they have tables, folds and calls.
fn shaders(entry: Entry) -> Vec<Shader> {
    let mut runner = TestRunner::deterministic();
    (0..12)
        .map(|_| {
            let mut program = random::program().new_tree(&mut runner).unwrap().current();
            program.interface.name = "texture".to_owned();
            emit(&program, &entry.into())
        })
        .collect()
}

#[test]
fn every_target_takes_every_entry_point() {
    for entry in [Entry::None, Entry::Fragment, Entry::Compute] {
        for shader in shaders(entry) {
            for target in Target::ALL {
                let translated = translate(&shader, target);
                if let Some(refused) = target.refuses(&shader) {
                    assert_eq!(translated, Err(refused));
                    continue;
                }
                let bytes = translated.unwrap_or_else(|e| panic!("{e}\n{}", shader.source));
                let again = translate(&shader, target).expect("it was translated before");
                assert_eq!(bytes, again, "{} differs from run to run", target.name());
                if target == Target::Spirv {
                    assert_eq!(bytes[..4], 0x0723_0203_u32.to_le_bytes());
                    continue;
                }
                let text = String::from_utf8(bytes).expect("text is UTF-8");
                if let Some(entry) = &shader.entry_point
                    && target != Target::Glsl
                {
                    assert!(
                        text.contains(&entry.name),
                        "{} lacks {}",
                        target.name(),
                        entry.name
                    );
                }
            }
        }
    }
}

/// Feeds `input` to a program and asserts that it accepts it.
fn assert_accepted(command: &mut Command, input: &[u8]) {
    let mut child = (command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped()))
    .spawn()
    .unwrap_or_else(|e| panic!("{command:?}: {e}"));
    child
        .stdin
        .take()
        .expect("it is piped")
        .write_all(input)
        .expect("the program reads it all");
    let output = child.wait_with_output().expect("the program ends");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success(),
        "{said}{}\n{}",
        String::from_utf8_lossy(&output.stderr),
        String::from_utf8_lossy(input)
    );
}

#[test]
#[ignore = "needs spirv-val and glslangValidator in PATH"]
fn khronos_validators_accept_the_translations() {
    for (entry, stage) in [(Entry::Fragment, "frag"), (Entry::Compute, "comp")] {
        for shader in shaders(entry) {
            let spirv = translate(&shader, Target::Spirv).unwrap();
            assert_accepted(
                Command::new("spirv-val").args(["--target-env", "vulkan1.1", "-"]),
                &spirv,
            );
            let glsl = translate(&shader, Target::Glsl).unwrap();
            assert_accepted(
                Command::new("glslangValidator").args(["--stdin", "-S", stage]),
                &glsl,
            );
        }
    }
}
