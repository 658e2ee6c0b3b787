//! JSON whose values know where in the text they stand.

use crate::build::Refusal;
use serde_json::Value as Plain;

/// A value and the byte where it begins.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Json {
    pub(crate) offset: usize,
    pub(crate) value: Content,
}

/// What it is.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Content {
    Null,
    Bool(bool),
    Number(f64),
    Text(String),
    List(Vec<Json>),
    Object(Vec<(String, Json)>),
}

/// How deep lists and objects may be nested.
const DEEPEST: usize = 128;

impl Json {
    /// Reads a text; the place of what is wrong with it is in bytes.
    pub(crate) fn parse(text: &str) -> Result<Self, (usize, Refusal)> {
        let mut reader = Reader {
            text,
            at: if text.starts_with('\u{feff}') { 3 } else { 0 },
        };
        let value = reader.value(0)?;
        reader.skip();
        if reader.at < text.len() {
            return Err(reader.wrong("nothing more is wanted"));
        }
        Ok(value)
    }

    /// A member of an object.
    pub(crate) fn get(&self, key: &str) -> Option<&Self> {
        let found = self.members().iter().find(|(name, _)| name == key);
        found.map(|(_, value)| value)
    }

    /// The value at the end of several keys.
    pub(crate) fn at(&self, keys: &[&str]) -> Option<&Self> {
        keys.iter().try_fold(self, |value, key| value.get(key))
    }

    pub(crate) fn members(&self) -> &[(String, Self)] {
        match &self.value {
            Content::Object(members) => members,
            _ => &[],
        }
    }

    pub(crate) fn items(&self) -> &[Self] {
        match &self.value {
            Content::List(items) => items,
            _ => &[],
        }
    }

    pub(crate) fn text(&self) -> Option<&str> {
        match &self.value {
            Content::Text(text) => Some(text),
            _ => None,
        }
    }

    pub(crate) const fn number(&self) -> Option<f64> {
        match self.value {
            Content::Number(number) => Some(number),
            _ => None,
        }
    }

    /// A number that counts or points.
    pub(crate) fn index(&self) -> Option<usize> {
        let number = self
            .number()
            .filter(|x| *x >= 0.0 && x.fract() == 0.0 && *x < 1e9)?;
        Some(number as usize)
    }
}

struct Reader<'a> {
    text: &'a str,
    at: usize,
}

type Found<T> = Result<T, (usize, Refusal)>;

impl Reader<'_> {
    fn wrong(&self, what: &str) -> (usize, Refusal) {
        let message = format!("this is not JSON: {what}");
        (
            self.at.min(self.text.len()),
            Refusal::new("import-syntax", message),
        )
    }

    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    fn skip(&mut self) {
        while matches!(self.peek(), Some(b' ' | b'\n' | b'\t' | b'\r')) {
            self.at += 1;
        }
    }

    fn take(&mut self, byte: u8) -> bool {
        self.skip();
        let found = self.peek() == Some(byte);
        self.at += usize::from(found);
        found
    }

    // The depth is limited, so that recursion is.
    fn value(&mut self, depth: usize) -> Found<Json> {
        self.skip();
        let offset = self.at;
        if depth > DEEPEST {
            return Err(self.wrong("it is nested too deep"));
        }
        let value = match self.peek() {
            Some(b'{') => {
                self.at += 1;
                let mut members = Vec::new();
                while !self.take(b'}') {
                    if !members.is_empty() && !self.take(b',') {
                        return Err(self.wrong("a comma is wanted"));
                    }
                    self.skip();
                    let key = self.quoted()?;
                    if !self.take(b':') {
                        return Err(self.wrong("a colon is wanted"));
                    }
                    members.push((key, self.value(depth + 1)?));
                }
                Content::Object(members)
            }
            Some(b'[') => {
                self.at += 1;
                let mut items = Vec::new();
                while !self.take(b']') {
                    if !items.is_empty() && !self.take(b',') {
                        return Err(self.wrong("a comma is wanted"));
                    }
                    items.push(self.value(depth + 1)?);
                }
                Content::List(items)
            }
            Some(b'"') => Content::Text(self.quoted()?),
            Some(_) => self.word()?,
            None => return Err(self.wrong("it ends too early")),
        };
        Ok(Json { offset, value })
    }

    fn quoted(&mut self) -> Found<String> {
        let start = self.at;
        if self.peek() != Some(b'"') {
            return Err(self.wrong("a text in quotes is wanted"));
        }
        self.at += 1;
        loop {
            match self.peek() {
                Some(b'"') => break,
                Some(b'\\') => self.at += 2,
                Some(_) => self.at += 1,
                None => return Err(self.wrong("a text does not end")),
            }
        }
        self.at += 1;
        match self.text.get(start..self.at).map(serde_json::from_str) {
            Some(Ok(text)) => Ok(text),
            _ => {
                self.at = start;
                Err(self.wrong("a text is broken"))
            }
        }
    }

    fn word(&mut self) -> Found<Content> {
        let start = self.at;
        while matches!(
            self.peek(),
            Some(b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'+' | b'-' | b'.')
        ) {
            self.at += 1;
        }
        match self.text.get(start..self.at).map(serde_json::from_str) {
            Some(Ok(Plain::Null)) => Ok(Content::Null),
            Some(Ok(Plain::Bool(flag))) => Ok(Content::Bool(flag)),
            Some(Ok(Plain::Number(number))) => {
                Ok(Content::Number(number.as_f64().unwrap_or(f64::NAN)))
            }
            _ => {
                self.at = start;
                Err(self.wrong("a value is wanted"))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_know_where_they_stand() {
        let json = Json::parse("{ \"a\": [1, {\"b\": \"x\\n\"}] }").expect("it is JSON");
        let list = json.get("a").expect("a member");
        assert_eq!(list.offset, 7);
        assert_eq!(list.items()[1].get("b").and_then(Json::text), Some("x\n"));
    }

    #[test]
    fn what_is_cut_off_is_told_and_never_a_panic() {
        let text = "{\"a\": [1, true, null, \"\\u00e4\"], \"b\": {\"c\": -1.5e3}}";
        assert!(Json::parse(text).is_ok());
        for end in 0..text.len() {
            if let Some(cut) = text.get(..end) {
                let (at, _) = Json::parse(cut).expect_err("it is cut off");
                assert!(at <= cut.len());
            }
        }
        assert!(Json::parse(&"[".repeat(100_000)).is_err());
    }
}
