//! What one text means: its words, names and statements, and the compiler's diagnostics.
//!
//! In: a text. Out: an [`Analysis`]. The whole compiler runs, as in `sidc check`. Words and names come from the tokens, so that texts with errors have them
//! too.

pub mod folder;
pub mod libraries;
pub mod symbols;
pub mod words;

use std::borrow::Cow;
use std::collections::BTreeMap;
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

/// One statement and its position.
#[derive(Clone, Debug)]
pub struct Outline {
    pub keyword: Option<Keyword>,
    pub bytes: Range<usize>,
}

#[derive(Clone, Debug, Default)]
pub struct Analysis {
    /// All tokens except line ends and blanks, in order.
    pub words: Vec<Word>,
    pub symbols: Symbols,
    pub statements: Vec<Outline>,
    /// The checked model with its libraries, if there are no errors.
    pub program: Option<Program>,
    pub found: Vec<Diagnostic>,
    /// Whether the text is too large to be read.
    pub too_large: bool,
    pub included: BTreeMap<FileId, Included>,
}

/// A file that a text includes.
#[derive(Clone, Debug)]
pub struct Included {
    pub name: String,
    /// The bytes of the `include` statement for it; those of the first `include` if another included file includes it.
    pub by: Range<usize>,
    pub symbols: Symbols,
}

/// The text itself among its sources.
pub const OWN: FileId = FileId(0);

impl Analysis {
    /// `files` holds an earlier version of the text, then the files that it includes.
    pub fn of(text: &str, files: &Sources) -> Analysis {
        if text.len() > EDITOR.text {
            return Analysis {
                too_large: true,
                ..Analysis::default()
            };
        }
        let text = with_line_ends(text);
        let (tokens, _) = tokenize(OWN, &text);
        let (statements, _) = split_statements(OWN, &tokens);
        let symbols = Symbols::of(&tokens, &statements);
        let words = words::words(&tokens, &statements, &symbols);
        let bytes = |r: &Range<usize>| bytes(&tokens, r);
        let statements = statements.iter().map(|s| Outline {
            keyword: s.keyword,
            bytes: bytes(&s.tokens),
        });
        let statements: Vec<Outline> = statements.collect();
        let sources = with_own(files, &text);
        let (program, found) = pipeline::compile(OWN, &sources, MEMORY);
        Analysis {
            included: included(&statements, &text, &sources),
            words,
            symbols,
            statements,
            program,
            found,
            too_large: false,
        }
    }

    /// The model without the statements that have errors, if the rest compiles. Removing a statement may break others, so this is repeated a few times.
    /// `text` must be the text of this analysis.
    pub fn sound_part(&self, text: &str, files: &Sources) -> Option<Program> {
        let mut found = Cow::Borrowed(&self.found);
        let mut text = with_line_ends(text).into_owned();
        for _ in 0..EDITOR.attempts {
            let errors = found.iter().filter(|d| d.is_error());
            let places: Vec<usize> = errors
                .filter_map(|d| d.labels.iter().find(|l| l.primary && l.span.file == OWN))
                .map(|l| l.span.start)
                .collect();
            let wrong = |s: &&Outline| {
                let mut places = places.iter();
                places.any(|at| (s.bytes.start..=s.bytes.end).contains(at))
            };
            for statement in self.statements.iter().filter(wrong) {
                blank(&mut text, &statement.bytes);
            }
            let (program, after) = pipeline::compile(OWN, &with_own(files, &text), MEMORY);
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

    /// The word being typed, which holds the byte before this one.
    pub fn typed(&self, at: usize) -> Option<&Word> {
        let behind = self.words.partition_point(|w| w.bytes.start < at);
        let word = self.words.get(behind.checked_sub(1)?)?;
        (at <= word.bytes.end).then_some(word)
    }

    /// The name at a byte and what it refers to.
    pub fn name(&self, at: usize) -> Option<(&Word, Use)> {
        let behind = self.words.partition_point(|w| w.bytes.start <= at);
        // In `x=1` a cursor between `x` and `=` touches both.
        let near = [behind.checked_sub(1), behind.checked_sub(2)];
        let near = near.into_iter().flatten().filter_map(|i| self.words.get(i));
        near.filter(|w| at <= w.bytes.end)
            .find_map(|w| Some((w, w.used()?)))
    }

    /// The last statement that begins at or before a byte, with its index.
    pub fn statement(&self, at: usize) -> Option<(usize, &Outline)> {
        let behind = self.statements.partition_point(|s| s.bytes.start <= at);
        let number = behind.checked_sub(1)?;
        Some((number, self.statements.get(number)?))
    }
}

/// The sources with a new version of the text itself.
fn with_own(files: &Sources, text: &str) -> Sources {
    let mut sources = files.clone();
    match sources.get(OWN) {
        Some(_) => sources.replace(OWN, text.to_string()),
        None => drop(sources.add("model", text)),
    }
    sources
}

/// Each included file.
fn included(statements: &[Outline], text: &str, sources: &Sources) -> BTreeMap<FileId, Included> {
    let own = statements
        .iter()
        .filter(|s| s.keyword == Some(Keyword::Include));
    let own: Vec<&Outline> = own.collect();
    let Some(first) = own.first() else {
        return BTreeMap::new();
    };
    let each = sources.iter().enumerate().skip(1).map(|(i, source)| {
        let id = FileId(i as u32);
        let names = |s: &&&Outline| {
            let path = text.get(s.bytes.clone()).and_then(|t| t.split('"').nth(1));
            path.is_some_and(|p| sources.linked(OWN, p) == Some(&Ok(id)))
        };
        let by = own.iter().find(names).unwrap_or(first);
        let (tokens, _) = tokenize(id, &source.text);
        let (statements, _) = split_statements(id, &tokens);
        let file = Included {
            name: source.name.clone(),
            by: by.bytes.clone(),
            symbols: Symbols::of(&tokens, &statements),
        };
        (id, file)
    });
    each.collect()
}

/// Overwrites everything except line ends with blanks.
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

/// Replaces `\r` by `\n` in texts whose lines end with `\r` only, as `sidc` does when it reads a file.
pub fn with_line_ends(text: &str) -> Cow<'_, str> {
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
