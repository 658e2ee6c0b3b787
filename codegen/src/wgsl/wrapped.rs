//! Lines that people can read: long ones are broken behind commas.

/// The longest line that is left as it is.
pub(super) const WIDTH: usize = 120;

/// The same text with its long lines broken.
pub(super) fn wrapped(source: String) -> String {
    if source.lines().all(|line| line.len() <= WIDTH) {
        return source;
    }
    let mut out = String::with_capacity(source.len() + source.len() / 16);
    for line in source.lines() {
        if line.len() <= WIDTH {
            out.push_str(line);
        } else if line.starts_with("///") {
            broken(&mut out, line.split_inclusive(' '), "/// ");
        } else {
            let code = line.trim_start();
            let indent = &line[..line.len() - code.len()];
            broken(
                &mut out,
                line.split_inclusive(", "),
                &format!("{indent}    "),
            );
        }
        out.push('\n');
    }
    out
}

/// Appends the pieces of a line, on as many lines as they need; those after the first begin with
/// `start`. A piece that is too long alone stays whole.
fn broken<'a>(out: &mut String, pieces: impl Iterator<Item = &'a str>, start: &str) {
    let mut line = String::new();
    let mut fresh = true;
    for piece in pieces {
        if !fresh && line.len() + piece.trim_end().len() > WIDTH {
            out.push_str(line.trim_end());
            out.push('\n');
            line.clear();
            line.push_str(start);
        }
        line.push_str(piece);
        fresh = false;
    }
    out.push_str(line.trim_end());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lines_are_broken_behind_commas_and_keep_every_word() {
        let arguments: Vec<String> = (0..60).map(|i| format!("argument_{i}_of_it")).collect();
        let call = format!(
            "    let x = f({});\n    let y = 1.0;\n",
            arguments.join(", ")
        );
        let doc = format!("/// {}\n", "a word and another ".repeat(20).trim_end());
        for text in [call, doc] {
            let wrapped = wrapped(text.clone());
            assert!(wrapped.lines().all(|line| line.len() <= WIDTH), "{wrapped}");
            let words = |text: &str| {
                text.split_whitespace()
                    .filter(|w| *w != "///")
                    .map(str::to_owned)
                    .collect::<Vec<_>>()
            };
            assert_eq!(words(&wrapped), words(&text));
            assert_eq!(super::wrapped(wrapped.clone()), wrapped);
        }
    }
}
