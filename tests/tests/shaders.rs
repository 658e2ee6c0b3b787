//! Every shader that can be emitted is valid WGSL and translates to every target; other people's
//! validators agree.
//!
//! The SPIR-V and GLSL cases show as ignored where `spirv-val` or `glslangValidator` is not
//! installed; with `MIPLESS_REQUIRE_COMPILERS=1` they fail then.

use libtest_mimic::{Arguments, Failed, Trial};
use mipless::target::{Target, TranslateError, translate, validate};
use mipless::wgsl::{Entry, Stage, emit};
use mipless::{Method, Options};
use mipless_tests::case::{Case, all, random};
use mipless_tests::random_graph::{asked as asked_graphs, methods};
use mipless_tests::{METHODS, asked, name_of};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::{env, fs};

/// A validator of another project.
#[derive(Clone, Copy)]
struct Compiler {
    program: &'static str,
    target: Target,
}

const COMPILERS: [Compiler; 2] = [
    Compiler {
        program: "spirv-val",
        target: Target::Spirv,
    },
    Compiler {
        program: "glslangValidator",
        target: Target::Glsl,
    },
];

/// Random graphs of which other compilers see every shader, unless `MIPLESS_GRAPHS` says how many;
/// that naga takes those of 300 graphs is a law (`composition`).
const RANDOM: u64 = 30;

fn main() {
    let arguments = Arguments::from_args();
    let required = asked("MIPLESS_REQUIRE_COMPILERS");
    let cases: Vec<Arc<Case>> = all().into_iter().map(Arc::new).collect();
    let mut trials = Vec::new();
    for case in &cases {
        for method in METHODS {
            let (name, case) = (
                format!("{}_{}", case.name, name_of(method)),
                Arc::clone(case),
            );
            trials.push(Trial::test(format!("targets_{name}"), move || {
                targets(&case, method)
            }));
        }
    }
    for compiler in COMPILERS {
        let missing = !is_installed(compiler.program);
        for case in &cases {
            let (name, case) = (
                format!("{}_{}", compiler.program, case.name),
                Arc::clone(case),
            );
            let trial = Trial::test(name, move || compile(&case, compiler, &METHODS));
            trials.push(trial.with_ignored_flag(missing && !required));
        }
        for seed in 0..asked_graphs().unwrap_or(RANDOM) {
            let name = format!("{}_random_{seed}", compiler.program);
            let run = move || compile(&random(seed), compiler, &methods(seed));
            trials.push(Trial::test(name, run).with_ignored_flag(missing && !required));
        }
    }
    libtest_mimic::run(&arguments, trials).exit();
}

fn is_installed(program: &str) -> bool {
    let paths = env::var_os("PATH").unwrap_or_default();
    env::split_paths(&paths).any(|folder| {
        let file = folder.join(program);
        file.is_file() || file.with_extension("exe").is_file()
    })
}

fn targets(case: &Case, method: Method) -> Result<(), Failed> {
    let program = case.texture.compile(&Options {
        method,
        ..Options::default()
    });
    for entry in [Entry::None, Entry::Fragment, Entry::Compute] {
        let shader = emit(&program, &entry.into());
        let longest = longest_function(&shader.source);
        // naga's front end takes time quadratic in the declarations of one function.
        assert!(longest <= 300, "a function of {longest} statements");
        let widest = widest(&shader.source);
        assert!(widest < 160, "a line of {widest} letters");
        let validated = validate(&shader.source)?;
        let digits = numbered(&shader.source);
        assert!(digits.is_empty(), "names that end in digits: {digits:?}");
        if entry == Entry::None {
            assert!(
                !shader.source.contains("dpdx"),
                "a derivative outside of a fragment shader"
            );
            let refused = translate(&shader, Target::Spirv);
            assert_eq!(refused, Err(TranslateError::NeedsEntry(Target::Spirv)));
        }
        for target in Target::ALL {
            if target.refuses(&shader).is_some() {
                continue;
            }
            let translated = validated.translate(&shader, target)?;
            assert!(!translated.is_empty(), "{} is empty", target.name());
        }
    }
    Ok(())
}

/// The names that end in a digit, which naga's writers and naga_oil change: all but those of WGSL's own
/// types and functions.
fn numbered(source: &str) -> Vec<&str> {
    const OWN: [&str; 7] = ["f32", "i32", "u32", "vec2", "vec3", "log2", "exp2"];
    let code = source.lines().filter(|line| !line.starts_with("///"));
    code.flat_map(|line| line.split(|c: char| !c.is_ascii_alphanumeric() && c != '_'))
        .filter(|word| word.starts_with(|c: char| c.is_ascii_alphabetic()))
        .filter(|word| word.ends_with(|c: char| c.is_ascii_digit()) && !OWN.contains(word))
        .collect()
}

/// The longest line.
fn widest(source: &str) -> usize {
    source.lines().map(str::len).max().unwrap_or(0)
}

/// The number of lines that end a statement in the longest function.
fn longest_function(source: &str) -> usize {
    let functions = source.split("\nfn ").skip(1);
    let statements = |function: &str| {
        let body = function.split("\n}").next().unwrap_or_default();
        body.lines().filter(|line| line.ends_with(';')).count()
    };
    functions.map(statements).max().unwrap_or(0)
}

fn compile(case: &Case, compiler: Compiler, methods: &[Method]) -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    for &method in methods {
        let program = case.texture.compile(&Options {
            method,
            ..Options::default()
        });
        for (entry, stage) in [
            (Entry::Fragment, Stage::Fragment),
            (Entry::Compute, Stage::Compute),
        ] {
            let shader = emit(&program, &entry.into());
            let translated = translate(&shader, compiler.target)?;
            let extension = compiler.target.extension(Some(stage));
            let file = folder
                .path()
                .join(format!("{}.{extension}", name_of(method)));
            fs::write(&file, translated)?;
            accepts(compiler, &file).map_err(|error| format!("{method}, {stage:?}: {error}"))?;
        }
    }
    Ok(())
}

fn accepts(compiler: Compiler, file: &Path) -> Result<(), String> {
    let mut command = Command::new(compiler.program);
    if compiler.target == Target::Spirv {
        command.args(["--target-env", "vulkan1.1"]);
    }
    let output = command.arg(file).stdin(Stdio::null()).output();
    let output = output.map_err(|error| format!("{}: {error}", compiler.program))?;
    if output.status.success() {
        return Ok(());
    }
    let said = [output.stdout, output.stderr].concat();
    Err(String::from_utf8_lossy(&said).into_owned())
}
