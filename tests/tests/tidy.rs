//! The order of the house. `bash .ci/fresh` makes generated files fresh.

use mipless_tests::case::all;
use mipless_tests::generated::compare;
use mipless_tests::root;
use std::fs;
use std::path::{Path, PathBuf};

/// The crates with the crates of the workspace that each may depend on.
const ARROWS: [(&str, &[&str]); 8] = [
    ("graph", &[]),
    ("import", &["graph"]),
    ("codegen", &["graph"]),
    ("nodes", &["graph", "codegen"]),
    ("runtime", &["graph", "codegen"]),
    (
        "mipless",
        &["graph", "import", "codegen", "nodes", "runtime"],
    ),
    (
        "cli",
        &["graph", "import", "codegen", "nodes", "runtime", "mipless"],
    ),
    (
        "tests",
        &[
            "graph", "import", "codegen", "nodes", "runtime", "mipless", "cli",
        ],
    ),
];

/// The longest file.
const LINES: usize = 600;

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// All files of a crate with this extension, sources, tests, benches and examples.
fn files(of: &Path, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![of.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a readable folder") {
            let path = entry.expect("a readable entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|found| found == extension) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

fn sources() -> Vec<PathBuf> {
    ARROWS
        .iter()
        .flat_map(|(name, _)| files(&root().join(name), "rs"))
        .collect()
}

/// The dependencies that a manifest names, development ones included.
fn dependencies(manifest: &str) -> Vec<String> {
    let mut dependencies = Vec::new();
    let mut inside = false;
    for line in manifest.lines().map(str::trim) {
        if let Some(section) = line.strip_prefix('[') {
            inside = section.trim_end_matches(']').ends_with("dependencies");
        } else if inside && !line.is_empty() && !line.starts_with('#') {
            let name = line.split(['.', '=', ' ']).next().unwrap_or_default();
            dependencies.push(name.trim_matches('"').to_owned());
        }
    }
    dependencies
}

#[test]
fn arrows_between_the_crates_point_one_way() {
    let members = read(&root().join("Cargo.toml"));
    for (room, allowed) in ARROWS {
        assert!(
            members.contains(&format!("\"{room}\"")),
            "{room} is no member"
        );
        let manifest = read(&root().join(room).join("Cargo.toml"));
        for dependency in dependencies(&manifest) {
            let Some(other) = dependency.strip_prefix("mipless") else {
                continue;
            };
            let other = other.strip_prefix('-').unwrap_or("mipless");
            assert!(allowed.contains(&other), "{room} depends on {other}");
        }
    }
}

#[test]
fn what_only_one_crate_may_know_no_other_depends_on() {
    let only = [
        ("wgpu", &["runtime"][..]),
        ("naga", &["codegen"]),
        ("petgraph", &["graph"]),
        ("clap", &["cli"]),
        ("roxmltree", &["import"]),
    ];
    for (room, _) in ARROWS {
        let manifest = read(&root().join(room).join("Cargo.toml"));
        for dependency in dependencies(&manifest) {
            for (known, by) in only {
                assert!(
                    dependency != known || by.contains(&room),
                    "{room} depends on {known}"
                );
            }
        }
    }
}

#[test]
fn nodes_hold_no_shader_text() {
    for path in files(&root().join("nodes/src"), "rs") {
        let text = read(&path);
        for word in [
            "vec2f", "vec3f", "vec4f", "@group", "@compute", "fn main", "->f32 {",
        ] {
            assert!(!text.contains(word), "{} holds `{word}`", path.display());
        }
    }
}

/// Names of ops as a builder's methods, which `ir` alone may call: everywhere else they are operators
/// and methods of expressions.
#[test]
fn formulas_are_written_with_operators() {
    let folders = ["nodes/src", "codegen/src/moments", "codegen/src/lower"];
    let methods = [
        "add", "sub", "mul", "div", "neg", "scale", "offset", "square", "sqrt", "exp", "min",
        "max", "lt", "le", "and", "or", "not", "select", "add_i", "mul_u", "f32", "i32", "u32",
        "dot", "clamp",
    ];
    for path in folders
        .iter()
        .flat_map(|folder| files(&root().join(folder), "rs"))
    {
        for (line, text) in (1..).zip(read(&path).lines()) {
            let words: Vec<&str> =
                (text.split(|c: char| !(c.is_alphanumeric() || "_.".contains(c)))).collect();
            for builder in [
                "b",
                "self.b",
                "lower.b",
                "builder",
                "lower.builder",
                "algebra.b",
            ] {
                let old = |word: &&&str| {
                    (word.strip_prefix(builder))
                        .and_then(|rest| rest.strip_prefix('.'))
                        .is_some_and(|method| methods.contains(&method))
                };
                let found = words.iter().find(old);
                assert!(found.is_none(), "{}:{line}: {found:?}", path.display());
            }
        }
    }
}

#[test]
fn codegen_names_no_node() {
    for path in files(&root().join("codegen/src"), "rs") {
        let text = read(&path);
        for def in mipless::catalogue() {
            // Words that are no name but that of a node.
            let name = def.spec.name;
            if name.ends_with("2d") || ["colorramp", "checkerboard"].contains(&name) {
                let quoted = format!("\"{name}\"");
                assert!(!text.contains(&quoted), "{} names {name}", path.display());
            }
        }
    }
}

/// The file of a node, by the line of its room that lists it: `clamp,` is a file of its own, and
/// `rounding::floor,` is a row of a family's file; `brick with things,` says what is summed.
fn listed(room: &str, node: &str) -> Option<(String, String)> {
    let lines = read(&root().join(format!("nodes/src/{room}.rs")));
    // A name that is a keyword is written raw.
    let names = [node.to_owned(), format!("r#{node}")];
    lines.lines().find_map(|line| {
        let line = line.strip_prefix("    ")?.strip_suffix(',')?;
        let line = line.split(" with ").next().unwrap_or(line);
        let (family, name) = line.split_once("::").unwrap_or((node, line));
        let file = format!("nodes/src/{room}/{family}.rs");
        names
            .contains(&name.to_owned())
            .then(|| (file, line.to_owned()))
    })
}

#[test]
fn a_node_stands_in_the_room_of_its_category_in_its_file_or_a_row_of_its_family() {
    for def in mipless::catalogue() {
        let name = def.spec.name;
        let room = def.spec.category.name().to_lowercase();
        let (file, line) =
            listed(&room, name).unwrap_or_else(|| panic!("{room} does not list {name}"));
        let text = read(&root().join(&file));
        // A file holds the name as text, a row begins with it.
        let said = match line.split_once("::") {
            None => text.contains(&format!("name: \"{name}\"")),
            Some((_, row)) => (text.lines())
                .filter_map(|line| line.trim().strip_prefix(row))
                .any(|rest| rest.starts_with([' ', ':'])),
        };
        assert!(said, "{file} holds another node");
        let example = format!("\"type\": \"{name}\"");
        assert!(
            def.spec.example.contains(&example),
            "the example of {name} is one of another"
        );
    }
}

#[test]
fn files_are_short_and_named_after_what_they_hold() {
    for path in sources() {
        let lines = read(&path).lines().count();
        assert!(lines <= LINES, "{} has {lines} lines", path.display());
        let stem = path.file_stem().expect("a name").to_string_lossy();
        for vague in ["utils", "util", "helpers", "common", "misc", "mod"] {
            assert!(
                stem != vague,
                "{} says nothing of what it holds",
                path.display()
            );
        }
    }
}

#[test]
fn nothing_is_left_unwritten_or_allowed_without_reason() {
    for path in sources() {
        let text = read(&path);
        // In parts, so that this file passes.
        for word in [
            concat!("todo", "!("),
            concat!("unimplemented", "!("),
            concat!("dbg", "!("),
        ] {
            assert!(!text.contains(word), "{} holds {word}", path.display());
        }
        for allowed in text.split(concat!("#[", "allow(")).skip(1) {
            let attribute = allowed.split(")]").next().unwrap_or_default();
            assert!(
                attribute.contains("reason = "),
                "{}: allow({attribute})",
                path.display()
            );
        }
    }
}

fn schema() -> serde_json::Value {
    mipless::schema(&mipless::specs())
}

#[test]
fn the_schema_is_fresh() {
    let text = serde_json::to_string_pretty(&schema()).expect("JSON") + "\n";
    compare("graph/graph.schema.json", &text).unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn the_schema_of_manifests_is_fresh() {
    let schema = mipless::manifest::manifest_schema();
    let text = serde_json::to_string_pretty(&schema).expect("JSON") + "\n";
    compare("mipless/manifest.schema.json", &text).unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn the_schema_accepts_every_graph_and_refuses_mistakes() {
    let validator = jsonschema::validator_for(&schema()).expect("the schema is one");
    for case in all() {
        let graph: serde_json::Value = serde_json::from_str(&case.text).expect("JSON");
        let errors: Vec<String> = validator
            .iter_errors(&graph)
            .map(|error| format!("{} at {}", error, error.instance_path))
            .collect();
        assert!(errors.is_empty(), "{}: {}", case.name, errors.join("\n"));
        for (pointer, mistake) in [("/version", "one"), ("/nodes", "none"), ("/outputs", "out")] {
            let mut wrong = graph.clone();
            *wrong.pointer_mut(pointer).expect("the key") = mistake.into();
            assert!(
                !validator.is_valid(&wrong),
                "{}: {pointer} may be {mistake}",
                case.name
            );
        }
        let mut wrong = graph.clone();
        wrong["nodes"]["odd"] = serde_json::json!({ "type": "no such node" });
        assert!(
            !validator.is_valid(&wrong),
            "{}: any type will do",
            case.name
        );
    }
}

#[test]
fn the_readme_says_how_to_render_and_how_to_test() {
    let readme = read(&root().join("README.md"));
    let render = "cargo run --release -- render graphs/marble.json -o marble.png";
    for command in [render, "cargo test --workspace"] {
        assert!(
            readme.contains(command),
            "README.md does not say `{command}`"
        );
    }
    let ci = read(&root().join(".ci/run"));
    assert!(ci.contains("cargo test --workspace") && ci.contains("render graphs/marble.json"));
}

#[test]
fn the_licences_are_those_of_the_manifest() {
    assert!(read(&root().join("Cargo.toml")).contains("license = \"MIT OR Apache-2.0\""));
    assert!(read(&root().join("LICENSE-MIT")).contains("WITHOUT WARRANTY OF ANY KIND"));
    assert!(read(&root().join("LICENSE-APACHE")).contains("Version 2.0, January 2004"));
}
