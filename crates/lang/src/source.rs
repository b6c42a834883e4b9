//! The texts that spans point into: model files whole, data files line by line.
//!
//! In: names and texts. Out: [`FileId`]s and [`Span`]s that any pass can carry. Never reads a file itself.

use std::collections::BTreeMap;

/// Index of a text in [`Sources`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FileId(pub u32);

/// A byte range in one source text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Span {
    pub file: FileId,
    pub start: usize,
    pub end: usize,
}

impl Span {
    pub fn new(file: FileId, start: usize, end: usize) -> Self {
        Span { file, start, end }
    }

    /// The place right before it.
    pub fn before(self) -> Span {
        Span::new(self.file, self.start, self.start)
    }

    /// The place right after it.
    pub fn after(self) -> Span {
        Span::new(self.file, self.end, self.end)
    }

    /// Whether another lies within it.
    pub fn holds(self, other: Span) -> bool {
        self.file == other.file && self.start <= other.start && other.end <= self.end
    }

    /// The smallest span that covers both; `other` must be in the same file.
    pub fn to(self, other: Span) -> Span {
        Span {
            file: self.file,
            start: self.start.min(other.start),
            end: self.end.max(other.end),
        }
    }
}

/// One text: a model, or an excerpt (usually one line) of a data file.
#[derive(Clone, Debug)]
pub struct Source {
    pub name: String,
    pub text: String,
    /// Number of the text's first line in its file, from 1.
    pub first_line: usize,
}

/// All texts of one run, in the order they were added.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    files: Vec<Source>,
    /// For each file, the paths that it includes, each with its text or why it could not be read.
    links: BTreeMap<(FileId, String), Result<FileId, String>>,
}

impl Sources {
    /// Adds a whole text.
    pub fn add(&mut self, name: impl Into<String>, text: impl Into<String>) -> FileId {
        self.add_excerpt(name, 1, text)
    }

    /// Adds part of a file, so that a message can show one line of a large table.
    pub fn add_excerpt(
        &mut self,
        name: impl Into<String>,
        first_line: usize,
        text: impl Into<String>,
    ) -> FileId {
        let id = FileId(self.files.len() as u32);
        self.files.push(Source {
            name: name.into(),
            text: text.into(),
            first_line,
        });
        id
    }

    /// Says which text a file includes by a path, or why it could not be read.
    pub(crate) fn link(&mut self, from: FileId, path: &str, to: Result<FileId, String>) {
        self.links.insert((from, path.to_string()), to);
    }

    /// The text that a file includes by a path, or why it could not be read; `None` if nobody looked for it.
    pub fn linked(&self, from: FileId, path: &str) -> Option<&Result<FileId, String>> {
        self.links.get(&(from, path.to_string()))
    }

    /// Replaces a text; its number and name stay.
    pub fn replace(&mut self, id: FileId, text: String) {
        if let Some(source) = self.files.get_mut(id.0 as usize) {
            source.text = text;
        }
    }

    pub fn iter(&self) -> impl Iterator<Item = &Source> {
        self.files.iter()
    }

    pub fn get(&self, id: FileId) -> Option<&Source> {
        self.files.get(id.0 as usize)
    }

    /// The same texts without characters that control a terminal. Every byte offset stays valid.
    pub fn printable(&self) -> Sources {
        let files = self.files.iter().map(|f| Source {
            name: printable(&f.name),
            text: printable(&f.text),
            first_line: f.first_line,
        });
        Sources {
            files: files.collect(),
            links: BTreeMap::new(),
        }
    }

    /// The text under a span; empty if the span is not of these sources.
    pub fn slice(&self, span: Span) -> &str {
        self.get(span.file)
            .and_then(|f| f.text.get(span.start..span.end))
            .unwrap_or("")
    }
}

/// The largest character boundary of a text at or before a byte offset.
pub(crate) fn floor_boundary(text: &str, at: usize) -> usize {
    let at = at.min(text.len());
    (0..=at)
        .rev()
        .find(|i| text.is_char_boundary(*i))
        .unwrap_or(0)
}

/// Replaces control and invisible characters by visible ones of the same length in bytes. Line ends and tabs stay.
pub fn printable(text: &str) -> String {
    text.chars()
        .map(|c| match c {
            '\n' | '\t' => c,
            // A carriage return would overwrite its line.
            '\r' => ' ',
            c if !is_invisible(c) => c,
            c => match c.len_utf8() {
                1 => '?',
                2 => '¿',
                3 => '\u{fffd}',
                _ => '\u{1fbc4}',
            },
        })
        .collect()
}

/// True of control characters and of invisible ones: joiners, direction marks, soft hyphens.
pub fn is_invisible(c: char) -> bool {
    c.is_control()
        || matches!(
            c,
            '\u{ad}' | '\u{34f}' | '\u{61c}' | '\u{180e}' | '\u{feff}'
        )
        || matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}')
        || matches!(c, '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e0fff}')
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Byte offsets stay valid.
    #[test]
    fn what_nobody_sees_is_replaced_byte_for_byte() {
        for c in ('\0'..=char::MAX).filter(|c| is_invisible(*c)) {
            let shown = printable(&c.to_string());
            assert_eq!(shown.len(), c.len_utf8(), "{c:?}");
            assert!(
                matches!(c, '\n' | '\t') || !shown.contains(is_invisible),
                "{c:?}"
            );
        }
        assert_eq!(
            printable("ä\u{ad}θ\u{7}\u{202e}x\u{e0001}\r\n\t"),
            "ä¿θ?\u{fffd}x\u{1fbc4} \n\t"
        );
    }
}
