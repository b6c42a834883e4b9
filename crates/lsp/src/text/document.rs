//! One text that is open in the editor.
//!
//! In: the text, then changes of parts of it. Out: the text as the editor has it. Its analysis is cached until the text changes.

use std::cell::OnceCell;
use std::ops::Range as Bytes;

use lsp_types::{Position, Range, TextDocumentContentChangeEvent};
use sidc::pipeline::Program;

use sidc_lang::includes;
use sidc_lang::source::Sources;

use crate::analysis::{Analysis, with_line_ends};
use crate::text::positions::{Encoding, Lines};
use crate::thresholds::EDITOR;

pub struct Document {
    pub text: String,
    /// The editor's version number of the text.
    pub version: i32,
    pub encoding: Encoding,
    lines: Lines,
    /// An earlier version of the text, then the files that it includes.
    files: Sources,
    analysis: OnceCell<Analysis>,
    /// For a text with errors, the model without the statements that have them.
    sound_part: OnceCell<Option<Program>>,
}

impl Document {
    pub fn new(text: String, version: i32, encoding: Encoding) -> Document {
        Document {
            lines: Lines::of(&text),
            text,
            version,
            encoding,
            files: Sources::default(),
            analysis: OnceCell::new(),
            sound_part: OnceCell::new(),
        }
    }

    /// Applies one change. The changes of one message must be applied in order.
    pub fn apply(&mut self, change: TextDocumentContentChangeEvent) {
        match change.range {
            None => self.text = change.text,
            Some(range) => {
                let (a, b) = (self.offset(range.start), self.offset(range.end));
                self.text
                    .replace_range(a.min(b)..a.max(b), change.text.as_str());
            }
        }
        self.lines = Lines::of(&self.text);
        self.analysis = OnceCell::new();
        self.sound_part = OnceCell::new();
    }

    /// Reads the files that the text includes.
    pub fn read_files(&mut self, read: includes::Read) {
        self.files = Sources::default();
        if self.text.len() <= EDITOR.text {
            let own = self.files.add("model", with_line_ends(&self.text));
            includes::load(own, &mut self.files, read);
        }
        self.analysis = OnceCell::new();
        self.sound_part = OnceCell::new();
    }

    /// The analysis of another text in place of this one.
    pub fn analysis_of(&self, text: &str) -> Analysis {
        Analysis::of(text, &self.files)
    }

    /// The analysis of the text, computed on first use after a change.
    pub fn analysis(&self) -> &Analysis {
        self.analysis.get_or_init(|| self.analysis_of(&self.text))
    }

    /// The model and its libraries, without the statements that have errors. Computed on demand, so that diagnostics need not wait for it.
    pub fn program(&self) -> Option<&Program> {
        let analysis = self.analysis();
        let rest = || analysis.sound_part(&self.text, &self.files);
        let program = analysis.program.as_ref();
        program.or_else(|| self.sound_part.get_or_init(rest).as_ref())
    }

    pub fn lines(&self) -> &Lines {
        &self.lines
    }

    pub fn offset(&self, position: Position) -> usize {
        self.lines.offset(&self.text, position, self.encoding)
    }

    pub fn position(&self, offset: usize) -> Position {
        self.lines.position(&self.text, offset, self.encoding)
    }

    pub fn range(&self, bytes: Bytes<usize>) -> Range {
        self.lines.positions(&self.text, bytes, self.encoding)
    }

    pub fn slice(&self, bytes: Bytes<usize>) -> &str {
        self.text.get(bytes).unwrap_or("")
    }
}
