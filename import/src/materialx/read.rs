//! From XML to the tree, with what a document includes.

use crate::element::{Element, Id, Tree};
use crate::place::{Findings, Place, Source};
use mipless_graph::Diagnostic;
use roxmltree::{Document, ParsingOptions};

/// How deep documents may include each other, and how many there may be.
const DEEPEST: usize = 32;
const MOST_INCLUDES: usize = 256;

/// Reads the bytes of a file that is named in a document.
pub(crate) type Read<'a> = &'a dyn Fn(&str) -> std::io::Result<Vec<u8>>;

/// Reads documents into one tree.
pub(crate) struct Reader<'a> {
    pub(crate) read: Read<'a>,
    pub(crate) findings: &'a mut Findings,
    includes: usize,
    /// The files that are being read, for circles.
    open: Vec<String>,
    /// Below which element documents go.
    root: Id,
}

impl<'a> Reader<'a> {
    pub(crate) fn new(read: Read<'a>, findings: &'a mut Findings, root: Id) -> Self {
        Self {
            read,
            findings,
            includes: 0,
            open: Vec::new(),
            root,
        }
    }

    /// Reads a text into the tree, below its root. Nothing where it is not XML.
    pub(crate) fn document(&mut self, tree: &mut Tree, name: &str, text: String) -> Option<()> {
        let file = self.findings.sources.len();
        // A byte order mark is passed over by the parser, and no column of an editor.
        let text = match text.strip_prefix('\u{feff}') {
            Some(rest) => rest.to_owned(),
            None => text,
        };
        self.findings
            .sources
            .push(Source::new(name.to_owned(), text.clone()));
        let options = ParsingOptions {
            // Entities are what bombs are made of, and no document needs them.
            allow_dtd: false,
            nodes_limit: 32_000_000,
        };
        let strict = match strict(&text) {
            Ok(strict) => strict,
            Err(offset) => {
                let message = format!("elements are nested more than {NESTED} deep");
                self.say(file, offset, Diagnostic::error("import-limit", message));
                return None;
            }
        };
        let parsed = match Document::parse_with_options(&strict, options) {
            Ok(parsed) => copy(&parsed, file),
            Err(error) => {
                let place = error.pos();
                let message = format!("this is not XML: {error}");
                let offset = offset_of(&text, place.row, place.col);
                self.say(file, offset, Diagnostic::error("import-syntax", message));
                return None;
            }
        };
        let root = parsed.first()?;
        if root.element.tag != "materialx" {
            let message = format!("`{}` is no MaterialX document", root.element.tag);
            let diagnostic = Diagnostic::error("import-syntax", message)
                .help("the first element of a MaterialX document is `materialx`");
            self.say(file, 0, diagnostic);
            return None;
        }
        self.open.push(name.to_owned());
        self.append(tree, parsed, file);
        self.open.pop();
        Some(())
    }

    fn say(&mut self, file: usize, offset: usize, diagnostic: Diagnostic) {
        let place = Place {
            file,
            offset,
            path: String::new(),
        };
        self.findings.say(&place, diagnostic);
    }

    /// Puts what was read below the root of the tree.
    fn append(&mut self, tree: &mut Tree, parsed: Vec<Parsed>, file: usize) {
        let mut ids: Vec<Id> = Vec::with_capacity(parsed.len());
        // What the root of an included file says holds for its own elements.
        let mut scope: Vec<(String, String)> = Vec::new();
        for (index, item) in parsed.into_iter().enumerate() {
            if index == 0 {
                scope.clone_from(&item.element.attributes);
                if self.open.len() == 1 && self.root == Tree::ROOT {
                    let root = tree.get_mut(Tree::ROOT);
                    *root = Element {
                        children: std::mem::take(&mut root.children),
                        file,
                        ..item.element
                    };
                }
                ids.push(self.root);
                continue;
            }
            let parent = ids[item.parent];
            if item.element.tag == "include" && parent == self.root {
                ids.push(self.root);
                self.include(tree, &item.element, &scope);
                continue;
            }
            let mut element = item.element;
            if parent == self.root && (self.open.len() > 1 || self.root != Tree::ROOT) {
                inherit(&mut element, &scope);
            }
            ids.push(tree.add(parent, element));
        }
    }

    fn include(&mut self, tree: &mut Tree, element: &Element, scope: &[(String, String)]) {
        let place = |findings: &mut Findings, diagnostic| {
            let place = Place {
                file: element.file,
                offset: element.offset,
                path: "/include".to_owned(),
            };
            findings.say(&place, diagnostic);
        };
        let Some(href) = element.attribute("href") else {
            let message = "an include names no file";
            place(self.findings, Diagnostic::error("import-include", message));
            return;
        };
        // Names are relative to the file that includes.
        let folder = self.open.last().and_then(|name| name.rsplit_once('/'));
        let name = match folder {
            Some((folder, _)) if self.open.len() > 1 => format!("{folder}/{href}"),
            _ => href.to_owned(),
        };
        let refusal = if self.open.contains(&name) {
            Some(format!("`{name}` includes itself"))
        } else if self.open.len() > DEEPEST || self.includes >= MOST_INCLUDES {
            Some(format!("`{name}` is one include too many"))
        } else {
            None
        };
        if let Some(message) = refusal {
            place(self.findings, Diagnostic::error("import-include", message));
            return;
        }
        self.includes += 1;
        match (self.read)(&name).map(String::from_utf8) {
            Ok(Ok(text)) => {
                let before = tree.get(self.root).children.len();
                if self.document(tree, &name, text).is_some() {
                    for place in before..tree.get(self.root).children.len() {
                        let id = tree.get(self.root).children[place];
                        inherit(tree.get_mut(id), scope);
                    }
                }
            }
            Ok(Err(_)) => {
                let message = format!("`{name}` is not UTF-8");
                place(self.findings, Diagnostic::error("import-include", message));
            }
            Err(error) => {
                let message = format!("`{name}` cannot be read: {error}");
                let diagnostic = Diagnostic::error("import-include", message)
                    .help("names are relative to the file that includes");
                place(self.findings, diagnostic);
            }
        }
    }
}

/// What elements have from the root of their file.
fn inherit(element: &mut Element, scope: &[(String, String)]) {
    for (key, value) in scope {
        match key.as_str() {
            "colorspace" if element.attribute(key).is_none() => element.set(key, value),
            "fileprefix" => {
                let own = element.attribute(key).unwrap_or("").to_owned();
                element.set(key, &format!("{value}{own}"));
            }
            _ => {}
        }
    }
}

/// Stands for `<` inside of attributes, where XML has none and documents of pictures have.
const LESS: char = '\u{7f}';

/// How deep elements may be nested: the parser recurses, and no document needs ten.
const NESTED: usize = 256;

/// The text as XML that a strict reader takes, with as many bytes as before, so that places stay:
/// `.` for the colon of prefixes in names of elements, which nothing declares, and [`LESS`] for `<`
/// inside of attributes. Where elements are nested too deep, the byte where that is.
fn strict(text: &str) -> Result<String, usize> {
    let mut bytes = text.as_bytes().to_vec();
    let (mut at, mut depth) = (0, 0_usize);
    let after = |from: usize, end: &str| match text.get(from..).and_then(|rest| rest.find(end)) {
        Some(found) => from + found + end.len(),
        None => text.len(),
    };
    while let Some(found) = bytes[at..].iter().position(|byte| *byte == b'<') {
        at += found;
        let rest = &text[at..];
        let skipped = [("<!--", "-->"), ("<?", "?>"), ("<![CDATA[", "]]>")];
        if let Some((_, end)) = skipped.iter().find(|(begin, _)| rest.starts_with(begin)) {
            at = after(at, end);
            continue;
        }
        let start = at;
        at = tag(&mut bytes, at + 1);
        match (
            bytes.get(start + 1),
            at.checked_sub(1).and_then(|last| bytes.get(last)),
        ) {
            (Some(b'/'), _) => depth = depth.saturating_sub(1),
            (_, Some(b'/')) => {}
            _ => depth += 1,
        }
        if depth > NESTED {
            return Err(start);
        }
    }
    // ASCII has become ASCII.
    Ok(String::from_utf8(bytes).unwrap_or_else(|_| text.to_owned()))
}

/// Makes a tag strict that begins before `at`; the place of its end.
fn tag(bytes: &mut [u8], mut at: usize) -> usize {
    while let Some(byte) = bytes.get_mut(at) {
        match byte {
            b':' => *byte = b'.',
            b'/' | b'_' | b'-' | b'.' => {}
            byte if byte.is_ascii_alphanumeric() => {}
            _ => break,
        }
        at += 1;
    }
    let mut quote = None;
    while let Some(byte) = bytes.get_mut(at) {
        match (quote, *byte) {
            (None, b'>' | b'<') => break,
            (None, b'"' | b'\'') => quote = Some(*byte),
            (Some(open), byte) if open == byte => quote = None,
            (Some(_), b'<') => *byte = LESS as u8,
            _ => {}
        }
        at += 1;
    }
    at
}

/// An element and the position of its parent.
struct Parsed {
    element: Element,
    parent: usize,
}

/// The elements in the order of the text.
fn copy(document: &Document<'_>, file: usize) -> Vec<Parsed> {
    let mut parsed: Vec<Parsed> = Vec::new();
    let mut open: Vec<(roxmltree::NodeId, usize)> = Vec::new();
    for node in document
        .root()
        .descendants()
        .filter(|node| node.is_element())
    {
        let parent = node.parent().map(|parent| parent.id());
        while open.last().is_some_and(|(id, _)| Some(*id) != parent) {
            open.pop();
        }
        let tag = match node.tag_name().name() {
            "xi.include" => "include".to_owned(),
            tag => tag.replace('.', ":"),
        };
        let element = Element {
            tag,
            name: node.attribute("name").unwrap_or("").to_owned(),
            attributes: (node.attributes())
                .map(|attribute| {
                    let value = attribute.value().replace(LESS, "<");
                    (attribute.name().to_owned(), value)
                })
                .collect(),
            file,
            offset: node.range().start,
            ..Element::default()
        };
        let index = parsed.len();
        parsed.push(Parsed {
            element,
            parent: open.last().map_or(0, |(_, index)| *index),
        });
        open.push((node.id(), index));
    }
    parsed
}

/// The byte of a line and a column of characters.
fn offset_of(text: &str, row: u32, column: u32) -> usize {
    let line = (text.split_inclusive('\n')).nth(row.saturating_sub(1) as usize);
    let before: usize = (text.split_inclusive('\n'))
        .take(row.saturating_sub(1) as usize)
        .map(str::len)
        .sum();
    let inside = line.map_or(0, |line| {
        let columns = column.saturating_sub(1) as usize;
        line.char_indices()
            .nth(columns)
            .map_or(line.len(), |(at, _)| at)
    });
    before + inside
}
