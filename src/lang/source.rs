//! The texts that spans point into: model files whole, data files line by line.
//!
//! In: names and texts. Out: [`FileId`]s and [`Span`]s that any pass can carry. Never reads a file itself.

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

    /// The smallest span that covers both; `other` must be in the same file.
    pub fn to(self, other: Span) -> Span {
        Span {
            file: self.file,
            start: self.start.min(other.start),
            end: self.end.max(other.end),
        }
    }
}

/// One text: a model, or an excerpt (one line, usually) of a data file.
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

    pub fn get(&self, id: FileId) -> Option<&Source> {
        self.files.get(id.0 as usize)
    }

    /// The same texts, byte for byte as long, without characters that would steer a terminal.
    pub fn printable(&self) -> Sources {
        let files = self.files.iter().map(|f| Source {
            name: printable(&f.name),
            text: printable(&f.text),
            first_line: f.first_line,
        });
        Sources {
            files: files.collect(),
        }
    }

    /// The text under a span; empty if the span is not of these sources.
    pub fn slice(&self, span: Span) -> &str {
        self.get(span.file)
            .and_then(|f| f.text.get(span.start..span.end))
            .unwrap_or("")
    }
}

/// Control characters but for line ends and tabs replaced by `?` or, where they take two bytes, by `¿`; carriage returns, which would
/// write over the line, by blanks; characters that turn the direction of what follows by U+FFFD.
pub fn printable(text: &str) -> String {
    text.chars()
        .map(|c| match c {
            '\n' | '\t' => c,
            '\r' => ' ',
            '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => '\u{fffd}',
            c if c.is_control() && c.len_utf8() == 1 => '?',
            c if c.is_control() => '¿',
            c => c,
        })
        .collect()
}
