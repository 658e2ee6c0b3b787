//! JSON text as a tree that knows where each key and value begins, duplicate keys included.
//!
//! `serde_json` does the parsing and limits the depth to 128. It reads one byte at a time through
//! an adapter that counts, so that the visitor, which shares the count, knows the position.

use std::cell::Cell;
use std::fmt;
use std::io::{self, Read};

use rustc_hash::FxHashMap;
use serde::de::{DeserializeSeed, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_json::Number;

use crate::Diagnostic;

/// A value and the byte at which it begins.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub(crate) at: usize,
    pub(crate) value: Json,
}

/// A JSON value.
#[derive(Clone, Debug)]
pub(crate) enum Json {
    Null,
    Boolean(bool),
    Number(Number),
    Text(String),
    Array(Vec<Tree>),
    Object(Vec<Member>),
}

/// A member of an object, as often as it was written.
#[derive(Clone, Debug)]
pub(crate) struct Member {
    pub(crate) key: String,
    pub(crate) key_at: usize,
    pub(crate) tree: Tree,
}

impl Json {
    /// What it is, for messages.
    pub(crate) fn kind(&self) -> &'static str {
        match self {
            Self::Null => "null",
            Self::Boolean(_) => "a truth value",
            Self::Number(_) => "a number",
            Self::Text(_) => "a string",
            Self::Array(_) => "an array",
            Self::Object(_) => "an object",
        }
    }
}

impl Tree {
    /// Parses text.
    ///
    /// # Errors
    /// The one syntax error, with its line and column.
    pub(crate) fn parse(text: &str) -> Result<Self, Box<Diagnostic>> {
        let read = Cell::new(0);
        let seed = Place {
            text: text.as_bytes(),
            read: &read,
        };
        let mut deserializer = serde_json::Deserializer::from_reader(seed);
        let parsed = seed.deserialize(&mut deserializer);
        parsed
            .and_then(|tree| deserializer.end().map(|()| tree))
            .map_err(|error| {
                let whole = error.to_string();
                let reason = whole.split(" at line ").next().unwrap_or(&whole);
                let line = error.line().max(1);
                let column = text.lines().nth(line - 1).map_or(1, |content| {
                    // serde_json counts bytes.
                    let bytes = error.column().saturating_sub(1).min(content.len());
                    String::from_utf8_lossy(&content.as_bytes()[..bytes])
                        .chars()
                        .count()
                        + 1
                });
                let message = format!("this is not JSON: {reason}");
                let diagnostic = Diagnostic::error("syntax", message);
                Box::new(diagnostic.at_line(small(line), small(column)))
            })
    }

    /// The members of an object.
    pub(crate) fn members(&self) -> Option<&[Member]> {
        match &self.value {
            Json::Object(members) => Some(members),
            _ => None,
        }
    }
}

/// Where the reader is in the text.
#[derive(Clone, Copy)]
struct Place<'a> {
    text: &'a [u8],
    read: &'a Cell<usize>,
}

impl Place<'_> {
    /// The byte at which the next token begins. `serde_json` has either just taken the colon
    /// before it (or nothing at all), or has peeked at its first byte.
    fn start(self) -> usize {
        let read = self.read.get();
        match read.checked_sub(1).map(|last| self.text[last]) {
            None | Some(b':') => {
                let rest = &self.text[read..];
                let blank = rest
                    .iter()
                    .take_while(|byte| byte.is_ascii_whitespace())
                    .count();
                read + blank
            }
            Some(_) => read - 1,
        }
    }
}

impl Read for Place<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let start = self.read.get();
        let count = buffer.len().min(self.text.len() - start);
        buffer[..count].copy_from_slice(&self.text[start..start + count]);
        self.read.set(start + count);
        Ok(count)
    }
}

impl<'de> DeserializeSeed<'de> for Place<'_> {
    type Value = Tree;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Tree, D::Error> {
        let at = self.start();
        let value = deserializer.deserialize_any(self)?;
        Ok(Tree { at, value })
    }
}

impl<'de> Visitor<'de> for Place<'_> {
    type Value = Json;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Json, E> {
        Ok(Json::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Json, E> {
        Ok(Json::Boolean(value))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Json, E> {
        Ok(Json::Number(value.into()))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Json, E> {
        Ok(Json::Number(value.into()))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Json, E> {
        // serde_json refuses numbers beyond f64, so a number always fits.
        Ok(Number::from_f64(value).map_or(Json::Null, Json::Number))
    }

    fn visit_str<E>(self, value: &str) -> Result<Json, E> {
        Ok(Json::Text(value.to_owned()))
    }

    fn visit_string<E>(self, value: String) -> Result<Json, E> {
        Ok(Json::Text(value))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Json, A::Error> {
        let mut items = Vec::new();
        while let Some(item) = sequence.next_element_seed(self)? {
            items.push(item);
        }
        Ok(Json::Array(items))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Json, A::Error> {
        let mut members = Vec::new();
        while let Some((key, key_at)) = map.next_key_seed(Key(self))? {
            let tree = map.next_value_seed(self)?;
            members.push(Member { key, key_at, tree });
        }
        Ok(Json::Object(members))
    }
}

/// Reads a key with its position.
struct Key<'a>(Place<'a>);

impl<'de> DeserializeSeed<'de> for Key<'_> {
    type Value = (String, usize);

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        let at = self.0.start();
        let key = <String as serde::Deserialize>::deserialize(deserializer)?;
        Ok((key, at))
    }
}

/// Lines and columns of a text.
pub(crate) struct Lines<'t> {
    text: &'t str,
    marks: Vec<Mark>,
}

/// A byte whose line and column are known.
struct Mark {
    at: usize,
    line: usize,
    column: usize,
}

impl<'t> Lines<'t> {
    /// Marks every line, and places within long ones: a document may be all on one line.
    pub(crate) fn new(text: &'t str) -> Self {
        const APART: usize = 256;
        let mut marks = vec![Mark {
            at: 0,
            line: 1,
            column: 1,
        }];
        let (mut line, mut column, mut marked) = (1, 1, 0);
        for (at, character) in text.char_indices() {
            if at - marked >= APART {
                marks.push(Mark { at, line, column });
                marked = at;
            }
            column += 1;
            if character == '\n' {
                line += 1;
                column = 1;
                marked = at + 1;
                marks.push(Mark {
                    at: marked,
                    line,
                    column,
                });
            }
        }
        Self { text, marks }
    }

    /// The line, and the column in characters, of a byte: both from 1.
    pub(crate) fn position(&self, at: usize) -> (u32, u32) {
        let mark = &self.marks[self.marks.partition_point(|mark| mark.at <= at) - 1];
        let between = &self.text.as_bytes()[mark.at..at];
        let characters = between
            .iter()
            .filter(|byte| (**byte & 0xc0) != 0x80)
            .count();
        (small(mark.line), small(mark.column + characters))
    }
}

fn small(number: usize) -> u32 {
    u32::try_from(number).unwrap_or(u32::MAX)
}

/// Gives line and column to the diagnostics that have only a pointer.
pub(crate) fn locate(text: &str, tree: &Tree, diagnostics: &mut [Diagnostic]) {
    let without = |diagnostic: &Diagnostic| diagnostic.line.is_none();
    if !diagnostics.iter().any(without) {
        return;
    }
    let lines = Lines::new(text);
    let mut index: FxHashMap<usize, FxHashMap<&str, usize>> = FxHashMap::default();
    for diagnostic in diagnostics
        .iter_mut()
        .filter(|diagnostic| without(diagnostic))
    {
        let Some(pointer) = diagnostic.pointer.as_deref() else {
            continue;
        };
        let mut here = tree;
        // Where the pointer leads out of the document (a missing key), the parent is the place.
        for segment in pointer.split('/').skip(1) {
            let name = segment.replace("~1", "/").replace("~0", "~");
            let next = match &here.value {
                Json::Array(items) => name.parse().ok().and_then(|i: usize| items.get(i)),
                Json::Object(members) => index
                    .entry(here.at)
                    .or_insert_with(|| {
                        let keys = members.iter().enumerate();
                        keys.map(|(i, member)| (member.key.as_str(), i)).collect()
                    })
                    .get(name.as_str())
                    .map(|i| &members[*i].tree),
                _ => None,
            };
            let Some(next) = next else { break };
            here = next;
        }
        let (line, column) = lines.position(here.at);
        diagnostic.line = Some(line);
        diagnostic.column = Some(column);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_and_values_know_where_they_begin() {
        let text = " {\n  \"a\" : [ 1 ,\t\"x\",{} ],\"ü\":-2e3, \"a\":true}";
        let tree = Tree::parse(text).expect("JSON");
        let lines = Lines::new(text);
        let members = tree.members().expect("an object");
        assert_eq!(lines.position(tree.at), (1, 2));
        assert_eq!(lines.position(members[0].key_at), (2, 3));
        assert_eq!(lines.position(members[0].tree.at), (2, 9));
        let Json::Array(items) = &members[0].tree.value else {
            panic!("an array")
        };
        let starts: Vec<u32> = items.iter().map(|item| lines.position(item.at).1).collect();
        assert_eq!(starts, [11, 15, 19]);
        assert_eq!(lines.position(members[1].key_at), (2, 24));
        assert_eq!(lines.position(members[1].tree.at), (2, 28));
        assert_eq!((members[2].key.as_str(), members.len()), ("a", 3));
        assert_eq!(&text[members[2].tree.at..members[2].tree.at + 4], "true");
    }

    #[test]
    fn a_thousand_times_too_deep_is_one_located_error() {
        let error = Tree::parse(&"[".repeat(10_000)).expect_err("too deep");
        assert_eq!(
            (error.code, error.line, error.column),
            ("syntax", Some(1), Some(128))
        );
        assert!(
            error.message.contains("recursion limit"),
            "{}",
            error.message
        );
    }
}
