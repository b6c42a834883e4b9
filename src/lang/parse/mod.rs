//! Text → ast. The only place that uses pest.
//!
//! A file is cut into statements first and each is parsed by its own rule, so one run reports every mistake. A
//! statement that is wrong is left out of the ast and named in `broken`. Looks no name up.

mod errors;
mod expected;
pub(in crate::lang) mod lines;
pub(in crate::lang) mod pasted;
pub mod token;
mod tree;

use crate::lang::ast::{Broken, Entry, File, Keyword, Statement, StatementKind};
use crate::lang::diagnostic::Diagnostic;
use crate::lang::source::{FileId, Span};
use lines::Piece;
use token::{Token, TokenKind};
use tree::Rule;

/// Parses one file: all statements that could be understood, and an error for each that could not.
pub fn parse(id: FileId, text: &str) -> (File, Vec<Diagnostic>) {
    let (tokens, mut errors) = token::tokens(id, text);
    let (pieces, bracket_errors) = lines::pieces(id, &tokens);
    errors.extend(bracket_errors);
    let mut file = File {
        id,
        text: text.to_string(),
        statements: Vec::with_capacity(pieces.len()),
        broken: Vec::new(),
    };
    for piece in pieces {
        let found = statement(id, text, &tokens, &piece);
        errors.extend(found.errors);
        let span = span_of(id, slice(&tokens, &piece.tokens));
        match found.kind {
            Some(kind) => file.statements.push(Statement { span, kind }),
            None => file.broken.push(broken(id, &tokens, &piece)),
        }
    }
    errors.sort_by_key(|e| e.labels.iter().filter(|l| l.primary).map(|l| l.span).min());
    (file, errors)
}

/// A statement, if it could be understood, and what was wrong with it.
struct Found {
    kind: Option<StatementKind>,
    errors: Vec<Diagnostic>,
}

impl From<Result<StatementKind, Box<Diagnostic>>> for Found {
    fn from(result: Result<StatementKind, Box<Diagnostic>>) -> Self {
        match result {
            Ok(kind) => Found {
                kind: Some(kind),
                errors: Vec::new(),
            },
            Err(e) => Found {
                kind: None,
                errors: vec![*e],
            },
        }
    }
}

fn statement(id: FileId, text: &str, tokens: &[Token], piece: &Piece) -> Found {
    let own = slice(tokens, &piece.tokens);
    if !piece.sound || piece.keyword != Some(Keyword::Data) && !is_clean(own) {
        return Found {
            kind: None,
            errors: Vec::new(),
        };
    }
    let rule = match piece.keyword {
        Some(Keyword::Sidc) => Rule::version,
        Some(Keyword::System) => Rule::system,
        Some(Keyword::State | Keyword::Input | Keyword::Output | Keyword::Param) => Rule::declare,
        Some(Keyword::Let) => Rule::constant,
        Some(Keyword::Constrain) => Rule::constrain,
        Some(Keyword::Data) => return data(id, text, tokens, piece),
        Some(Keyword::Symmetry) => Rule::symmetry,
        Some(Keyword::Limit) => Rule::limit,
        None => Rule::equation,
    };
    tree::statement(id, text, own, rule, piece.keyword).into()
}

fn data(id: FileId, text: &str, tokens: &[Token], piece: &Piece) -> Found {
    let own = slice(tokens, &piece.tokens);
    let Some(lines) = &piece.entries else {
        return Err(Box::new(errors::data_without_brace(span_of(id, own)))).into();
    };
    if let [_, second, ..] = own
        && !second.is("{")
    {
        return Err(Box::new(errors::data_without_brace(second.span(id)))).into();
    }
    let mut entries: Vec<Entry> = Vec::with_capacity(lines.len());
    let mut errors = Vec::new();
    for line in lines {
        let own = slice(tokens, line);
        if !is_clean(own) {
            continue;
        }
        match tree::entry(id, text, own) {
            Ok(kind) => entries.push(Entry {
                span: span_of(id, own),
                kind,
            }),
            Err(e) => errors.push(*e),
        }
    }
    Found {
        kind: Some(StatementKind::Data(entries)),
        errors,
    }
}

fn slice<'a, 't>(tokens: &'a [Token<'t>], range: &std::ops::Range<usize>) -> &'a [Token<'t>] {
    tokens.get(range.clone()).unwrap_or(&[])
}

/// Free of characters and numbers that are reported already.
fn is_clean(tokens: &[Token]) -> bool {
    tokens
        .iter()
        .all(|t| t.kind != TokenKind::Bad && !t.is("=="))
}

fn span_of(id: FileId, tokens: &[Token]) -> Span {
    let start = tokens.first().map_or(0, |t| t.start);
    let end = tokens.last().map_or(0, |t| t.end);
    Span::new(id, start, end)
}

/// The names a broken statement would have given a meaning to.
fn broken(id: FileId, tokens: &[Token], piece: &Piece) -> Broken {
    let own = slice(tokens, &piece.tokens);
    let declares = match piece.keyword {
        Some(k) => matches!(
            k,
            Keyword::State | Keyword::Input | Keyword::Output | Keyword::Param | Keyword::Let
        ),
        // A misspelt keyword: no equation without a relation.
        None => !own.iter().any(|t| t.is("~") || t.is("=")),
    };
    let names = own
        .iter()
        .skip(1)
        .take_while(|t| declares && !t.is(":") && !t.is("="))
        .filter(|t| matches!(t.kind, TokenKind::Name | TokenKind::Bad))
        .map(|t| token::normalise(t.text))
        .collect();
    Broken {
        keyword: piece.keyword,
        names,
        span: span_of(id, own),
    }
}
