//! Text of functions that hosts include: what two textures share is guarded.

/// A declaration at module scope of a C-like language.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Item<'a> {
    /// Its lines.
    pub(crate) text: &'a str,
    /// What it declares, if it declares one thing.
    pub(crate) name: Option<&'a str>,
}

/// The declarations at module scope of a text as naga writes them: whatever begins at the left margin,
/// up to the line that closes it there.
pub(crate) fn items(text: &str) -> impl Iterator<Item = Item<'_>> {
    let mut rest = text;
    std::iter::from_fn(move || {
        rest = rest.trim_start_matches('\n');
        if rest.is_empty() {
            return None;
        }
        let mut end = 0;
        for line in rest.split_inclusive('\n') {
            end += line.len();
            let code = line.trim_end();
            let is_first = end == line.len();
            let is_flat = code.ends_with(';') || code.starts_with('#') || code.starts_with("//");
            let closes = code == "}" || code == "};" || (is_first && code.starts_with('}'));
            if closes || (is_first && is_flat) {
                break;
            }
        }
        let (text, behind) = rest.split_at(end);
        rest = behind;
        Some(Item {
            text,
            name: declared(text),
        })
    })
}

/// The name that a declaration declares: the last word before its parameters, members, semantics or end.
fn declared(item: &str) -> Option<&str> {
    if item.starts_with('#') || item.starts_with("//") {
        return None;
    }
    let head = match item.find("{ ") {
        // A block's name is not that of its member, which is used.
        Some(at) if item.contains("buffer") => item[at + 2..].split(['[', ';', '}']).next()?,
        _ => item.split(['(', '{', ':', ';', '=']).next()?,
    };
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    head.trim_end()
        .rsplit(|c| !is_part(c))
        .next()
        .filter(|name| !name.is_empty())
}

/// What is the same in the text of every texture.
fn is_shared(name: &str) -> bool {
    [
        "Footprint",
        "Position",
        "ConstructFootprint",
        "ConstructPosition",
    ]
    .contains(&name)
        || name.starts_with("naga_")
        || name.starts_with("_naga")
        || name == "_mslBufferSizes"
        || name == "DefaultConstructible"
}

/// The same text, in which what is shared is declared once however often such texts are included.
pub(super) fn included(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 512);
    for item in items(text) {
        let shared = item.name.filter(|name| is_shared(name));
        match shared {
            Some(_) => {
                // Functions of one name differ in their parameters.
                let head = item.text.split(['{', ';']).next().unwrap_or_default();
                let mut guard = "MIPLESS".to_owned();
                for word in head.split(|c: char| !c.is_ascii_alphanumeric()) {
                    if !word.is_empty() {
                        guard.push('_');
                        guard.push_str(word);
                    }
                }
                let body = item.text.trim_end();
                out.push_str(&format!(
                    "#ifndef {guard}\n#define {guard}\n{body}\n#endif\n"
                ));
            }
            None => out.push_str(item.text),
        }
        if item.text.trim_end().ends_with('}') {
            out.push('\n');
        }
    }
    out.truncate(out.trim_end().len());
    out.push('\n');
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_textures_share_is_guarded_and_everything_else_is_kept() {
        let text = "struct Footprint {\n    ivec2 cell;\n};\nint naga_f2i32(float value) {\n    return 0;\n}\n\n\
                    uniform highp sampler2D marble_tables;\n\nMarble marble(Footprint footprint) {\n    return 1;\n}\n";
        let names: Vec<_> = items(text).filter_map(|item| item.name).collect();
        assert_eq!(
            names,
            ["Footprint", "naga_f2i32", "marble_tables", "marble"]
        );
        let guarded = included(text);
        assert!(
            guarded.starts_with("#ifndef MIPLESS_struct_Footprint\n"),
            "{guarded}"
        );
        assert!(
            guarded.contains("#define MIPLESS_int_naga_f2i32_float_value\n"),
            "{guarded}"
        );
        assert!(guarded.contains("};\n#endif\n"), "{guarded}");
        assert!(guarded.ends_with("    return 1;\n}\n"), "{guarded}");
    }
}
