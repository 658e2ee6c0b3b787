//! What a release promises: the oldest Rust that builds it, what each feature brings, and packages
//! that stand alone.

use mipless_tests::root;
use serde_json::Value;
use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The folders of the crates in the order of their publication: each needs only those before it.
const PUBLISHED: [&str; 7] = [
    "graph", "import", "codegen", "nodes", "runtime", "mipless", "cli",
];

fn read(path: &str) -> String {
    let path = root().join(path);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// What cargo says, without asking the network; `None` where it would have to.
fn cargo(arguments: &str) -> Option<String> {
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .current_dir(root())
        .args(arguments.split_whitespace())
        .args(["--locked", "--offline"])
        .output()
        .expect("cargo starts");
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    output.status.success().then_some(text)
}

/// A version as three numbers.
fn version(text: &str) -> [u32; 3] {
    let mut numbers = [0; 3];
    for (number, part) in numbers.iter_mut().zip(text.split('.')) {
        *number = part.parse().unwrap_or_else(|_| panic!("version {text}"));
    }
    numbers
}

/// The value of a key of the workspace's manifest.
fn stated(key: &str) -> String {
    let manifest = read("Cargo.toml");
    let prefix = format!("{key} = \"");
    let line = manifest.lines().find_map(|line| line.strip_prefix(&prefix));
    let value = line.and_then(|line| line.strip_suffix('"'));
    value.unwrap_or_else(|| panic!("no {key}")).to_owned()
}

#[test]
fn no_dependency_wants_a_newer_rust_than_the_readme_says() {
    let oldest = stated("rust-version");
    let said = format!("With Rust {oldest} or newer");
    assert!(read("README.md").contains(&said), "the README: no `{said}`");

    // The packages of other systems are not here unless `cargo fetch` was asked for them.
    let whole = cargo("metadata --format-version 1");
    let metadata = whole.unwrap_or_else(|| {
        let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
        let output = Command::new(rustc).arg("-vV").output().expect("rustc");
        let text = String::from_utf8(output.stdout).expect("UTF-8");
        let host = text.lines().find_map(|line| line.strip_prefix("host: "));
        let host = host.expect("rustc names its host");
        let only = format!("metadata --format-version 1 --filter-platform {host}");
        cargo(&only).expect("what was built is described")
    });
    let metadata: Value = serde_json::from_str(&metadata).expect("JSON");
    let packages = metadata["packages"].as_array().expect("packages");
    assert!(packages.len() > 100, "{} packages", packages.len());
    let mut newest = String::from("1.0");
    for package in packages {
        let wanted = package["rust_version"].as_str();
        let name = package["name"].as_str().expect("a name");
        if name.starts_with("mipless") {
            assert_eq!(wanted, Some(oldest.as_str()), "{name}");
        } else if let Some(wanted) = wanted {
            assert!(
                version(wanted) <= version(&oldest),
                "{name} wants Rust {wanted}"
            );
            if version(wanted) > version(&newest) {
                newest = wanted.to_owned();
            }
        }
    }
    eprintln!("Rust {oldest} is said, and the dependencies want {newest}");
}

#[test]
fn wgsl_alone_builds_neither_decoders_nor_naga() {
    let tree = |features: &str| {
        let base = "tree -p mipless --edges normal,build --prefix none --no-default-features";
        let text = cargo(&format!("{base} {features}")).expect("what was built is described");
        let names = text.lines().filter_map(|line| line.split(' ').next());
        names.map(str::to_owned).collect::<Vec<_>>()
    };
    let decoders = ["image", "exr", "png", "zune-jpeg"];
    let translators = ["naga"];
    for (features, with, without) in [
        ("", &[][..], [&decoders[..], &translators].concat()),
        ("--features files", &decoders, translators.to_vec()),
        ("--features targets", &translators, decoders.to_vec()),
    ] {
        let names = tree(features);
        let holds = |name: &&&str| names.iter().any(|found| found == **name);
        assert_eq!(with.iter().find(|name| !holds(name)), None, "{features}");
        assert_eq!(without.iter().find(holds), None, "{features}");
    }
}

#[test]
fn crates_can_be_published_one_after_the_other() {
    let workspace = read("Cargo.toml");
    let version = stated("version");
    let mut before = Vec::new();
    for folder in PUBLISHED {
        let manifest = read(&format!("{folder}/Cargo.toml"));
        let name = match folder {
            "mipless" => "mipless".to_owned(),
            _ => format!("mipless-{folder}"),
        };
        assert!(
            manifest.contains(&format!("name = \"{name}\"\n")),
            "{folder}"
        );
        for key in [
            "version",
            "edition",
            "rust-version",
            "license",
            "repository",
            "readme",
            "keywords",
        ] {
            let inherited = format!("\n{key}.workspace = true\n");
            assert!(manifest.contains(&inherited), "{folder}: no {key}");
        }
        for key in ["description", "categories"] {
            assert!(manifest.contains(&format!("\n{key}")), "{folder}: no {key}");
        }
        for line in manifest.lines().filter(|line| line.starts_with("mipless")) {
            let needed = line.split(['.', ' ', '=']).next().unwrap_or_default();
            let known = before.iter().any(|name| name == needed);
            assert!(known, "{folder} comes before {needed}");
        }
        if folder != "cli" {
            // What depends on it finds it in the registry by this version.
            let dependency = format!("\n{name} = {{ version = \"{version}\", path = \"{folder}\"");
            assert!(workspace.contains(&dependency), "{name} has no version");
        }
        for licence in ["LICENSE-APACHE", "LICENSE-MIT"] {
            let text = read(&format!("{folder}/{licence}"));
            assert_eq!(text, read(licence), "{folder}: another {licence}");
        }
        before.push(name);
    }
    assert!(read("tests/Cargo.toml").contains("\npublish = false\n"));
}

/// All Rust files below a folder.
fn sources(of: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(of).expect("a readable folder") {
        let path = entry.expect("a readable entry").path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found
}

#[test]
fn no_package_reads_a_file_outside_its_folder() {
    for folder in PUBLISHED {
        let home = root().join(folder);
        let manifest = read(&format!("{folder}/Cargo.toml"));
        let kept = |path: &PathBuf| {
            let inside = path.strip_prefix(&home).expect("a file of the crate");
            !manifest.contains(&format!("exclude = [\"{}\"]", inside.display()))
        };
        for path in sources(&home).into_iter().filter(kept) {
            let text = fs::read_to_string(&path).expect("a readable file");
            let shown = path.display();
            assert!(!text.contains("CARGO_MANIFEST_DIR"), "{shown} leaves it");
            for word in ["include_str!(\"", "include_bytes!(\"", "#[path = \""] {
                for named in text.split(word).skip(1) {
                    let name = named.split('"').next().unwrap_or_default();
                    let file = path.parent().expect("a folder").join(name);
                    let file = file.canonicalize().expect("the file exists");
                    let home = home.canonicalize().expect("the crate exists");
                    assert!(file.starts_with(home), "{shown} includes {name}");
                }
            }
        }
    }
}

#[test]
fn every_change_passes_each_feature_alone_and_the_oldest_rust() {
    let ci = read(".ci/run");
    for words in [
        "both=(-p mipless -p mipless-runtime)",
        "cargo clippy \"${both[@]}\" --all-targets --no-default-features -- -D warnings",
        "--no-default-features --features mipless/files,mipless-runtime/files -- -D warnings",
        "cargo clippy -p mipless --all-targets --no-default-features --features targets -- -D warnings",
        "cargo clippy -p mipless-runtime --no-default-features --features gpu -- -D warnings",
        "cargo test -p mipless --no-default-features --test without_files",
        "s/^rust-version = ",
        "cargo package --workspace --exclude mipless-tests --no-verify",
    ] {
        assert!(ci.contains(words), ".ci/run: no `{words}`");
    }
}
