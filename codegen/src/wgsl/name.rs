//! Names: identifiers that every target accepts, from arbitrary text, unique in their scope.

use super::reserved::{is_reserved, is_word};
use rustc_hash::{FxBuildHasher, FxHashMap};
use std::collections::hash_map::Entry;
use std::hash::BuildHasher;

/// An identifier made of arbitrary text: ASCII letters, digits and single underscores between them,
/// not beginning or ending with a digit, and not a reserved word of any target.
///
/// A name that ends in a digit is legal everywhere, but naga's writers, and with them naga_oil, put an
/// underscore behind it, so that what refers to it by name no longer finds it.
pub fn identifier(text: &str) -> String {
    let mut name = spelled(text);
    if ends_in_digit(&name) || is_reserved(&name) {
        name.push_str("_value");
    }
    name
}

/// An identifier for what nobody outside the shader names: the number at the end of `sum_0` or
/// `wave_1` becomes a letter, `sum_a` and `wave_b`.
pub(super) fn internal(text: &str) -> String {
    let mut name = spelled(text);
    let digits = name.bytes().rev().take_while(u8::is_ascii_digit).count();
    let stem = name.len() - digits;
    if digits > 0
        && name[..stem].ends_with('_')
        && let Ok(number) = name[stem..].parse()
    {
        name.truncate(stem);
        push_letters(&mut name, number);
    }
    if ends_in_digit(&name) || is_reserved(&name) {
        name.push_str("_value");
    }
    name
}

fn ends_in_digit(name: &str) -> bool {
    name.ends_with(|c: char| c.is_ascii_digit())
}

/// Appends a number as letters: `a` for 0, `z` for 25, `aa` for 26.
pub(super) fn push_letters(out: &mut String, number: u32) {
    if number >= 26 {
        push_letters(out, number / 26 - 1);
    }
    out.push(char::from(b'a' + (number % 26) as u8));
}

/// The number as letters, the first a capital.
pub(super) fn capitals(number: u32) -> String {
    let mut letters = String::new();
    push_letters(&mut letters, number);
    camel(&letters)
}

/// The letters, digits and gaps of a text as an identifier, which may be a reserved word.
fn spelled(text: &str) -> String {
    let mut name = String::with_capacity(text.len() + 6);
    let mut gap = false;
    if is_identifier(text) {
        name.push_str(text);
    }
    for c in text[name.len()..].chars() {
        if c.is_ascii_alphanumeric() {
            if gap && !name.is_empty() {
                name.push('_');
            }
            if name.is_empty() && c.is_ascii_digit() {
                name.push('n');
            }
            gap = false;
            name.push(c);
        } else {
            gap = true;
        }
    }
    if name.is_empty() {
        name.push('x');
    }
    name
}

/// Whether text is an identifier already, unless it is a reserved word.
fn is_identifier(text: &str) -> bool {
    let mut before = b'_';
    for byte in text.bytes() {
        let fits = match byte {
            b'_' => before != b'_',
            _ => byte.is_ascii_alphanumeric(),
        };
        if !fits {
            return false;
        }
        before = byte;
    }
    before != b'_' && !text.starts_with(|c: char| c.is_ascii_digit())
}

/// The name of a type: the words of an identifier, capitalised and joined.
pub(crate) fn camel(identifier: &str) -> String {
    let mut name = String::with_capacity(identifier.len());
    for word in identifier.split('_') {
        let mut rest = word.chars();
        name.extend(rest.next().map(|c| c.to_ascii_uppercase()));
        name.push_str(rest.as_str());
    }
    name
}

/// What the texture's function and the entry points call their arguments and values: a function of
/// that name could not be called where it stands for something else.
const LOCALS: &str =
    "footprint position parameters outputs index first id uv xyz pixels tables du dv dx dy";

/// Address spaces, access modes and built-in values, which a declaration of the module hides.
const ENUMERANTS: &str = "
    function handle private read read_write storage uniform workgroup write clip_distances
    frag_depth front_facing global_invocation_id instance_index local_invocation_id
    local_invocation_index num_workgroups position sample_index sample_mask subgroup_invocation_id
    subgroup_size vertex_index workgroup_id bgra8unorm r32float r32sint r32uint rg32float rg32sint
    rg32uint rgba16float rgba16sint rgba16uint rgba32float rgba32sint rgba32uint rgba8sint rgba8snorm
    rgba8uint rgba8unorm linear perspective flat center centroid sample first either";

/// The name of a function of the module, from an identifier.
pub(super) fn callable(identifier: String) -> String {
    let mut taken = LOCALS
        .split_whitespace()
        .chain(ENUMERANTS.split_whitespace());
    if taken.any(|word| word == identifier) {
        identifier + "_value"
    } else {
        identifier
    }
}

/// The names taken in a scope, as hashes: a name whose hash is another's counts as taken.
#[derive(Debug, Default, Clone)]
pub(super) struct Scope {
    /// For each name, the number that its next namesake gets.
    taken: FxHashMap<u64, u32>,
}

fn hashed(name: &str) -> u64 {
    FxBuildHasher.hash_one(name)
}

impl Scope {
    /// Takes `name`, or the first free of `name_b`, `name_c`, ….
    pub(super) fn take(&mut self, name: String) -> String {
        let next = match self.taken.entry(hashed(&name)) {
            Entry::Vacant(place) => {
                place.insert(1);
                return name;
            }
            Entry::Occupied(next) => *next.get(),
        };
        for number in next.. {
            let mut candidate = name.clone() + "_";
            push_letters(&mut candidate, number);
            if is_word(&candidate) {
                continue;
            }
            if let Entry::Vacant(place) = self.taken.entry(hashed(&candidate)) {
                place.insert(1);
                self.taken.insert(hashed(&name), number + 1);
                return candidate;
            }
        }
        unreachable!("there are more numbers than names")
    }

    /// Whether a name is taken.
    pub(super) fn holds(&self, name: &str) -> bool {
        self.taken.contains_key(&hashed(name))
    }
}

/// Whether an identifier could be mistaken for one of the emitter's own short names: `t_` (values) or
/// `p_` (parts) and letters.
pub(super) fn looks_generated(name: &str) -> bool {
    let rest = name.strip_prefix("t_").or_else(|| name.strip_prefix("p_"));
    rest.is_some_and(|r| r.bytes().all(|b| b.is_ascii_lowercase()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_avoid_reserved_words_and_foreign_letters() {
        for (text, expected) in [
            ("marble", "marble"),
            ("3d noise!", "n3d_noise"),
            ("a__b_", "a_b"),
            ("σ", "x"),
            ("texture", "texture_value"),
            ("Pass", "Pass_value"),
            ("lerp", "lerp_value"),
            ("gl_Position", "gl_Position_value"),
            ("thread", "thread_value"),
            ("_", "x"),
            ("fn", "fn_value"),
            ("Wald & Höhe", "Wald_H_he"),
            ("layer_1", "layer_1_value"),
            ("color2", "color2_value"),
        ] {
            assert_eq!(identifier(text), expected, "{text}");
        }
    }

    #[test]
    fn numbers_inside_a_shader_are_letters() {
        for (text, expected) in [
            ("sum_0", "sum_a"),
            ("e_1_27", "e_1_ab"),
            ("v14", "v14_value"),
            ("noise_99999999999", "noise_99999999999_value"),
            ("half_", "half_value"),
            ("size_19", "size_t_value"),
            ("u", "u"),
        ] {
            assert_eq!(internal(text), expected, "{text}");
        }
    }

    #[test]
    fn a_scope_never_gives_a_name_twice() {
        let mut scope = Scope::default();
        let given: Vec<_> = ["a", "a_b", "a", "a", "a_b"]
            .map(|n| scope.take(n.to_owned()))
            .into();
        assert_eq!(given, ["a", "a_b", "a_c", "a_d", "a_b_b"]);
        let hostile = ["gl_Position_value"; 2].map(|n| scope.take(n.to_owned()));
        assert_eq!(hostile, ["gl_Position_value", "gl_Position_value_b"]);
        let times: Vec<String> = (0..20).map(|_| scope.take("size".to_owned())).collect();
        assert!(!times.iter().any(|name| name == "size_t"), "{times:?}");
    }
}
