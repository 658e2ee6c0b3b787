//! Messages on streams: one a line, or each behind a head `Content-Length: N` and an empty line, as editors'
//! language servers have it. A message is answered as it came.

use std::io::{self, BufRead, Read, Write};
use std::sync::{Mutex, PoisonError};

/// The most bytes of the lines of a head.
const HEAD: u64 = 4096;

/// How a message is framed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Framing {
    #[default]
    Line,
    Length,
}

/// What has been read.
#[derive(Debug)]
pub(super) enum Incoming {
    Message(Vec<u8>),
    /// A message of more bytes than are allowed, which was passed over.
    TooLarge,
    /// A head that says no length.
    NoLength,
    End,
}

/// Reads one message of at most `most` bytes.
pub(super) fn read(from: &mut impl BufRead, most: u64) -> io::Result<(Incoming, Framing)> {
    // The first line of a head may be longer than the longest message.
    let longest = most.max(HEAD);
    loop {
        let mut line = Vec::new();
        let length = from
            .by_ref()
            .take(longest + 2)
            .read_until(b'\n', &mut line)?;
        if length == 0 {
            return Ok((Incoming::End, Framing::Line));
        }
        let is_whole = line.ends_with(b"\n");
        if !is_whole && length as u64 > longest + 1 {
            pass_line(from)?;
            return Ok((Incoming::TooLarge, Framing::Line));
        }
        let text = line.trim_ascii();
        if text.is_empty() {
            continue;
        }
        if is_head(text) {
            return framed(from, text, most).map(|read| (read, Framing::Length));
        }
        let message = match text.len() as u64 > most {
            true => Incoming::TooLarge,
            false => Incoming::Message(text.to_vec()),
        };
        return Ok((message, Framing::Line));
    }
}

/// Passes over the rest of a line.
fn pass_line(from: &mut impl BufRead) -> io::Result<()> {
    loop {
        let buffer = from.fill_buf()?;
        if buffer.is_empty() {
            return Ok(());
        }
        let end = buffer.iter().position(|&byte| byte == b'\n');
        let used = end.map_or(buffer.len(), |end| end + 1);
        from.consume(used);
        if end.is_some() {
            return Ok(());
        }
    }
}

/// Reads what follows the first line of a head.
fn framed(from: &mut impl BufRead, first: &[u8], most: u64) -> io::Result<Incoming> {
    let mut length = length_of(first);
    let mut head = from.by_ref().take(HEAD);
    loop {
        // A line that begins as a message does is none of a head, whatever came before.
        if matches!(head.fill_buf()?.first(), None | Some(b'{' | b'[')) {
            return Ok(Incoming::NoLength);
        }
        let mut line = Vec::new();
        head.read_until(b'\n', &mut line)?;
        let text = line.trim_ascii();
        if text.is_empty() {
            break;
        }
        if !is_head(text) {
            return Ok(Incoming::NoLength);
        }
        length = length.or_else(|| length_of(text));
    }
    let Some(length) = length else {
        return Ok(Incoming::NoLength);
    };
    let mut body = from.by_ref().take(length);
    if length > most {
        io::copy(&mut body, &mut io::sink())?;
        return Ok(Incoming::TooLarge);
    }
    let mut bytes = Vec::new();
    body.read_to_end(&mut bytes)?;
    Ok(Incoming::Message(bytes))
}

/// Whether a line is `Name: value`.
fn is_head(line: &[u8]) -> bool {
    let colon = line.iter().position(|&byte| byte == b':');
    let name = colon.map(|colon| &line[..colon]).unwrap_or_default();
    let is_letter = |byte: &u8| byte.is_ascii_alphabetic() || *byte == b'-';
    !name.is_empty() && name.iter().all(is_letter)
}

fn length_of(line: &[u8]) -> Option<u64> {
    let line = std::str::from_utf8(line).ok()?;
    let (name, value) = line.split_once(':')?;
    let is_length = name.trim().eq_ignore_ascii_case("content-length");
    is_length.then(|| value.trim().parse().ok()).flatten()
}

/// Where messages go, whole and one after the other, from any thread.
pub(super) struct Writer<W>(Mutex<W>);

impl<W: Write> Writer<W> {
    pub(super) fn new(to: W) -> Self {
        Self(Mutex::new(to))
    }

    /// Writes a message. Whoever does not read any more is not written to: that is no failure of a call.
    pub(super) fn write(&self, message: &serde_json::Value, framing: Framing) {
        let text = message.to_string();
        let mut to = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let written = match framing {
            Framing::Line => writeln!(to, "{text}"),
            Framing::Length => write!(to, "Content-Length: {}\r\n\r\n{text}", text.len()),
        };
        drop(written.and_then(|()| to.flush()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(text: &[u8], most: u64) -> Vec<String> {
        let mut from = text;
        let mut found = Vec::new();
        loop {
            match read(&mut from, most).expect("a slice") {
                (Incoming::End, _) => return found,
                (Incoming::Message(bytes), framing) => {
                    let text = String::from_utf8_lossy(&bytes).into_owned();
                    found.push(format!("{text} {framing:?}"));
                }
                (other, _) => found.push(format!("{other:?}")),
            }
        }
    }

    #[test]
    fn messages_are_lines_or_have_heads_and_large_ones_are_passed_over() {
        let text = b"{\"a\":1}\n\n  [2] \r\nContent-Length: 3\r\nX: y\r\n\r\n[3]0123456789abc\n4\n";
        assert_eq!(
            all(text, 10),
            [
                "{\"a\":1} Line",
                "[2] Line",
                "[3] Length",
                "TooLarge",
                "4 Line"
            ]
        );
        let text = b"A: b\n{\"c\":1}\nA: b";
        assert_eq!(all(text, 10), ["NoLength", "{\"c\":1} Line", "NoLength"]);
        let text = b"Content-Length: 12\n\n0123456789ab[5]\nContent-Length: x\n\n[6]";
        assert_eq!(
            all(text, 10),
            ["TooLarge", "[5] Line", "NoLength", "[6] Line"]
        );
    }
}
