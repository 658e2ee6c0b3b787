//! The page of the command line quotes the texts of `mipless help` as they are. `bash .ci/fresh`
//! makes it fresh.

use std::fs;
use std::path::Path;
use std::process::Command;

/// What a command line prints.
fn printed(line: &str) -> String {
    let words = line.split_whitespace().skip(1);
    let output = Command::new(env!("CARGO_BIN_EXE_mipless"))
        .args(words)
        // The width of a terminal changes where lines are broken.
        .env_remove("COLUMNS")
        .output()
        .expect("the command starts");
    assert!(output.status.success(), "{line}");
    String::from_utf8(output.stdout).expect("text")
}

/// The page with each fenced part that begins with a call of `mipless help` made fresh.
fn fresh(page: &str) -> String {
    let fence = "```text\n$ mipless help";
    let mut parts = page.split(fence);
    let mut text = parts.next().expect("a split has a part").to_owned();
    for part in parts {
        let (first, rest) = part.split_once('\n').expect("a line");
        let (_, after) = rest.split_once("```").expect("an end of the fence");
        let line = format!("mipless help{first}");
        let help = printed(&line);
        text += &format!("```text\n$ {line}\n{}\n```{after}", help.trim_end());
    }
    text
}

/// That a generated file is what is wanted; where `MIPLESS_WRITE` asks for it, it becomes that.
fn hold(path: &Path, held: &str, wanted: &str) {
    if held != wanted {
        let asked = std::env::var("MIPLESS_WRITE").is_ok_and(|value| value == "1");
        assert!(
            asked,
            "{} is stale: bash .ci/fresh makes it fresh",
            path.display()
        );
        fs::write(path, wanted).expect("the file is written");
    }
}

#[test]
fn the_page_of_the_command_line_is_fresh() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let path = root.join("docs/book/src/reference/command_line.md");
    // The text of a copy with Windows' line ends is the same text.
    let held = fs::read_to_string(&path)
        .expect("the page is there")
        .replace("\r\n", "\n");
    let wanted = fresh(&held);
    for verb in printed("mipless help").lines() {
        // Verbs are indented by two spaces, options by more.
        let verb = verb.strip_prefix("  ").unwrap_or_default();
        let verb = verb.split(' ').next().unwrap_or_default();
        if !verb.is_empty() && !verb.starts_with('-') && verb != "help" {
            let call = format!("$ mipless help {verb}\n");
            assert!(wanted.contains(&call), "the page says nothing of `{verb}`");
        }
    }
    hold(&path, &held, &wanted);
}

#[test]
fn the_schema_of_the_protocol_is_fresh() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let path = root.join("docs/book/src/reference/serve.schema.json");
    let held = fs::read_to_string(&path).unwrap_or_default();
    let held = held.replace("\r\n", "\n");
    let wanted = printed("mipless serve --schema");
    hold(&path, &held, &wanted);
}
