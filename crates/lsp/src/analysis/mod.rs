//! What one text means: its words, its names, its statements, and all that the compiler finds.
//!
//! In: a text. Out: an [`Analysis`]. The compiler runs whole, as in `sidc check`; words and names come from the tokens, so that they exist
//! in a text with mistakes too.

pub mod libraries;
pub mod symbols;
pub mod tables;
pub mod words;

use std::borrow::Cow;
use std::ops::Range;

use sidc::pipeline::{self, Program};
use sidc_lang::ast::Keyword;
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::library::MEMORY;
use sidc_lang::parse::lexer::{Token, tokenize};
use sidc_lang::parse::statements::split_statements;
use sidc_lang::source::{FileId, Sources};

use crate::thresholds::EDITOR;
use symbols::{Symbols, Use};
use words::{Role, Word};

/// One statement by its place.
#[derive(Clone, Debug)]
pub struct Outline {
    pub keyword: Option<Keyword>,
    pub bytes: Range<usize>,
}

#[derive(Clone, Debug, Default)]
pub struct Analysis {
    /// All of the text but line ends and blanks, in order.
    pub words: Vec<Word>,
    pub symbols: Symbols,
    pub statements: Vec<Outline>,
    /// The checked model with its libraries, if there are no errors.
    pub program: Option<Program>,
    pub found: Vec<Diagnostic>,
    /// The text is larger than any model that is read.
    pub too_large: bool,
}

impl Analysis {
    pub fn of(text: &str) -> Analysis {
        if text.len() > EDITOR.text {
            return Analysis {
                too_large: true,
                ..Analysis::default()
            };
        }
        let text = with_line_ends(text);
        let (tokens, _) = tokenize(FileId(0), &text);
        let (statements, _) = split_statements(FileId(0), &tokens);
        let symbols = Symbols::of(&tokens, &statements);
        let words = words::words(&tokens, &statements, &symbols);
        let bytes = |r: &Range<usize>| bytes(&tokens, r);
        let statements = statements.iter().map(|s| Outline {
            keyword: s.keyword,
            bytes: bytes(&s.tokens),
        });
        let statements = statements.collect();
        let mut sources = Sources::default();
        let file = sources.add("model", text.as_ref());
        let (program, found) = pipeline::compile(file, &sources, MEMORY);
        Analysis {
            words,
            symbols,
            statements,
            program,
            found,
            too_large: false,
        }
    }

    /// The model without the statements in which errors are, if what is left is one. Others may need those, so it is tried again without
    /// them, a few times. `text` is that of this analysis.
    pub fn sound_part(&self, text: &str) -> Option<Program> {
        let mut found = Cow::Borrowed(&self.found);
        let mut text = with_line_ends(text).into_owned();
        for _ in 0..EDITOR.attempts {
            let errors = found.iter().filter(|d| d.is_error());
            let places: Vec<usize> = errors
                .filter_map(|d| d.labels.iter().find(|l| l.primary))
                .map(|l| l.span.start)
                .collect();
            let wrong = |s: &&Outline| {
                let mut places = places.iter();
                places.any(|at| (s.bytes.start..=s.bytes.end).contains(at))
            };
            for statement in self.statements.iter().filter(wrong) {
                blank(&mut text, &statement.bytes);
            }
            let mut sources = Sources::default();
            let file = sources.add("model", text.as_str());
            let (program, after) = pipeline::compile(file, &sources, MEMORY);
            if program.is_some() {
                return program;
            }
            found = Cow::Owned(after);
        }
        None
    }

    /// The word at a byte, or the one that ends there.
    pub fn word(&self, at: usize) -> Option<&Word> {
        let behind = self.words.partition_point(|w| w.bytes.start <= at);
        let word = self.words.get(behind.checked_sub(1)?)?;
        (at <= word.bytes.end).then_some(word)
    }

    /// The word that holds the byte before this one: what is being typed.
    pub fn typed(&self, at: usize) -> Option<&Word> {
        let behind = self.words.partition_point(|w| w.bytes.start < at);
        let word = self.words.get(behind.checked_sub(1)?)?;
        (at <= word.bytes.end).then_some(word)
    }

    /// The name at a byte and whose it is.
    pub fn name(&self, at: usize) -> Option<(&Word, Use)> {
        let behind = self.words.partition_point(|w| w.bytes.start <= at);
        // Between `x` and `=` in `x=1` a cursor is at both.
        let near = [behind.checked_sub(1), behind.checked_sub(2)];
        let near = near.into_iter().flatten().filter_map(|i| self.words.get(i));
        near.filter(|w| at <= w.bytes.end)
            .find_map(|w| Some((w, w.used()?)))
    }

    /// The last statement that begins at or before a byte, with its number.
    pub fn statement(&self, at: usize) -> Option<(usize, &Outline)> {
        let behind = self.statements.partition_point(|s| s.bytes.start <= at);
        let number = behind.checked_sub(1)?;
        Some((number, self.statements.get(number)?))
    }
}

/// Blanks in place of all but line ends.
fn blank(text: &mut String, bytes: &Range<usize>) {
    let Some(old) = text.get(bytes.clone()) else {
        return;
    };
    let new: String = old
        .bytes()
        .map(|b| if b == b'\n' { '\n' } else { ' ' })
        .collect();
    text.replace_range(bytes.clone(), &new);
}

impl Word {
    pub fn used(&self) -> Option<Use> {
        match self.role {
            Role::Declaration(used) | Role::Use(used) => Some(used),
            _ => None,
        }
    }
}

/// As `sidc` reads a file: a text whose lines end with `\r` alone has `\n` in its place.
fn with_line_ends(text: &str) -> Cow<'_, str> {
    match text.contains('\n') || !text.contains('\r') {
        true => Cow::Borrowed(text),
        false => Cow::Owned(text.replace('\r', "\n")),
    }
}

fn bytes(tokens: &[Token], range: &Range<usize>) -> Range<usize> {
    let own = tokens.get(range.clone()).unwrap_or(&[]);
    let start = own.first().map_or(0, |t| t.start);
    start..own.last().map_or(start, |t| t.end)
}
