//! What a document in Markdown points to: links, pictures, included files, and the headings that
//! links may name.

use std::path::{Path, PathBuf};

/// A document.
#[derive(Clone, Debug)]
pub struct Markdown {
    /// The file.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
}

impl Markdown {
    /// Reads a document.
    ///
    /// # Panics
    /// If it cannot be read.
    pub fn read(path: &Path) -> Self {
        let text = std::fs::read_to_string(path);
        Self {
            path: path.to_owned(),
            text: text.unwrap_or_else(|error| panic!("{}: {error}", path.display())),
        }
    }

    /// The lines outside fenced code.
    fn prose(&self) -> impl Iterator<Item = &str> {
        let mut inside = false;
        self.text.lines().filter(move |line| {
            let fence = line.trim_start().starts_with("```");
            inside ^= fence;
            !inside && !fence
        })
    }

    /// The targets of links and pictures, those of other sites left out.
    pub fn links(&self) -> Vec<String> {
        let mut links = Vec::new();
        for line in self.prose() {
            // Code in a line may look like a link.
            let spoken: String = line.split('`').step_by(2).collect();
            for (begin, end) in [("](", ')'), ("src=\"", '"'), ("href=\"", '"')] {
                let found = spoken.split(begin).skip(1);
                links.extend(found.filter_map(|rest| Some(rest.split_once(end)?.0.to_owned())));
            }
        }
        links.retain(|link| !link.is_empty() && !link.contains("://"));
        links
    }

    /// The files that mdBook puts in place of a line, in fenced code too.
    pub fn includes(&self) -> Vec<String> {
        let found = self.text.split("{{#include ").skip(1);
        found
            .filter_map(|rest| rest.split_once("}}"))
            .map(|(target, _)| target.split(':').next().unwrap_or_default().to_owned())
            .collect()
    }

    /// The names by which links reach the headings: in small letters, spaces as hyphens, without
    /// other signs, and numbered where two are alike.
    pub fn anchors(&self) -> Vec<String> {
        let mut anchors: Vec<String> = Vec::new();
        for line in self.prose().filter(|line| line.starts_with('#')) {
            let heading = line.trim_start_matches('#').trim().to_lowercase();
            let letters = heading.chars().filter_map(|c| match c {
                ' ' => Some('-'),
                c if c.is_alphanumeric() || c == '-' || c == '_' => Some(c),
                _ => None,
            });
            let name: String = letters.collect();
            let mut numbered = name.clone();
            let mut number = 0;
            while anchors.contains(&numbered) {
                number += 1;
                numbered = format!("{name}-{number}");
            }
            anchors.push(numbered);
        }
        anchors
    }

    /// The fenced parts in this language.
    pub fn fenced(&self, language: &str) -> Vec<String> {
        let mut parts: Vec<String> = Vec::new();
        let mut inside = None;
        for line in self.text.lines() {
            if let Some(info) = line.trim_start().strip_prefix("```") {
                inside = match inside {
                    Some(_) => None,
                    None => Some(info == language),
                };
                if inside == Some(true) {
                    parts.push(String::new());
                }
            } else if inside == Some(true) {
                let part = parts.last_mut().expect("it began");
                part.push_str(line);
                part.push('\n');
            }
        }
        parts
    }
}
