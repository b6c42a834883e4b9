//! Text → ast. The only place that uses pest.
//!
//! In: the text of a file. Out: its statements, and an error for each that is wrong. The text is cut into statements first
//! (`lexer`, `statements`) and each is parsed by its own rule (`grammar`, `ast_builder`), so that one run reports every mistake. A
//! wrong statement is left out and listed in `broken`. Looks up no name.

mod ast_builder;
mod completion;
pub(crate) mod confusables;
mod explain;
mod failure_point;
pub(crate) mod foreign_spellings;
mod grammar;
pub mod lexer;
mod operands;
pub mod statements;
mod syntax_errors;
mod token;

use crate::ast::{Broken, Entry, File, Keyword, Statement, StatementKind};
use crate::diagnostic::Diagnostic;
use crate::source::{FileId, Span};
use grammar::Rule;
use lexer::{Token, TokenKind};
use statements::StatementTokens;

pub use lexer::{is_name, normalise};
pub(crate) use syntax_errors::ambiguous_argument;

/// Parses one file: all statements that could be understood, and an error for each that could not.
pub fn parse(id: FileId, text: &str) -> (File, Vec<Diagnostic>) {
    let (tokens, mut errors) = lexer::tokenize(id, text);
    let (pieces, mut bracket_errors) = statements::split_statements(id, &tokens);
    let mut file = File {
        id,
        text: text.to_string(),
        included: Vec::new(),
        statements: Vec::with_capacity(pieces.len()),
        broken: Vec::new(),
    };
    let mut foreign: Vec<Span> = Vec::new();
    for mut piece in pieces {
        let span = span_of(id, slice(&tokens, &piece.tokens));
        let own = slice(&tokens, &piece.tokens);
        if let Some(error) = foreign_spellings::statements::statement(id, text, own, piece.keyword)
        {
            errors.push(error);
            foreign.push(span);
            file.broken.push(broken(id, &tokens, &piece));
            continue;
        }
        if piece.keyword == Some(Keyword::Include) && !names_one_file(own) {
            errors.retain(|e| !e.labels.iter().any(|l| l.primary && span.holds(l.span)));
            errors.push(syntax_errors::include_without_path(span, text));
            file.broken.push(broken(id, &tokens, &piece));
            continue;
        }
        let ends = own.last().filter(|t| t.is(";") && own.len() > 1);
        if let Some(end) = ends {
            errors.push(foreign_spellings::statements::semicolon(id, end));
            piece.tokens.end -= 1;
        }
        match statement(id, text, &tokens, &piece, &mut errors) {
            Some(kind) => file.statements.push(Statement { span, kind }),
            None => file.broken.push(broken(id, &tokens, &piece)),
        }
    }
    // Brackets in a statement of another language follow its rules, not ours.
    let in_foreign = |at: Span| {
        let before = foreign.partition_point(|s| s.start <= at.start);
        let last = before.checked_sub(1).and_then(|i| foreign.get(i));
        last.is_some_and(|s| s.holds(at))
    };
    bracket_errors.retain(|e| !e.labels.iter().any(|l| l.primary && in_foreign(l.span)));
    errors.extend(bracket_errors);
    errors.sort_by_key(|e| e.labels.iter().filter(|l| l.primary).map(|l| l.span).min());
    (file, errors)
}

/// `include "FILE"`
fn names_one_file(own: &[Token]) -> bool {
    let code: Vec<&Token> = own.iter().filter(|t| t.is_code()).collect();
    matches!(code.as_slice(), [_, path] if path.kind == TokenKind::Text)
}

/// A statement, if it could be understood; its errors are added to `errors`.
fn statement(
    id: FileId,
    text: &str,
    tokens: &[Token],
    piece: &StatementTokens,
    errors: &mut Vec<Diagnostic>,
) -> Option<StatementKind> {
    let own = slice(tokens, &piece.tokens);
    if !piece.sound || piece.keyword != Some(Keyword::Data) && !is_clean(own) {
        return None;
    }
    let rule = match piece.keyword {
        Some(Keyword::Sidc) => Rule::version,
        Some(Keyword::System) => Rule::system,
        Some(Keyword::State | Keyword::Input | Keyword::Output | Keyword::Param) => Rule::declare,
        Some(Keyword::Unknown) => Rule::unknown,
        Some(Keyword::Let) if own.get(2).is_some_and(|t| t.is("(")) => Rule::function,
        Some(Keyword::Let) => Rule::constant,
        Some(Keyword::Coef | Keyword::Constrain) => {
            let per_run = piece.keyword == Some(Keyword::Coef) || own.iter().any(|t| t.is(":"));
            match (per_run, has_index_range(own, false)) {
                (true, true) => Rule::per_run_family,
                (true, false) => Rule::per_run,
                (false, true) => Rule::constrain_family,
                (false, false) => Rule::constrain,
            }
        }
        Some(Keyword::Data) => return data(id, text, tokens, piece, errors),
        Some(Keyword::Symmetry) => Rule::symmetry,
        Some(Keyword::When) => Rule::reset,
        Some(Keyword::Limit) => Rule::limit,
        Some(Keyword::Prefer) => Rule::prefer,
        Some(Keyword::Include) => Rule::include,
        None if has_index_range(own, true) => Rule::family,
        None => Rule::equation,
    };
    let built = ast_builder::statement(id, text, own, rule, piece.keyword);
    built.map_err(|e| errors.push(*e)).ok()
}

/// Whether `, i =` follows a relation outside brackets. `angles` is true if `<` and `>` are brackets and not relations.
fn has_index_range(own: &[Token], angles: bool) -> bool {
    let code: Vec<&Token> = own.iter().filter(|t| t.is_code()).collect();
    let (mut depth, mut related) = (0usize, false);
    for (i, token) in code.iter().enumerate() {
        match token.text {
            _ if token.kind != TokenKind::Symbol => {}
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth = depth.saturating_sub(1),
            "<" if angles => depth += 1,
            ">" if angles => depth = depth.saturating_sub(1),
            "~" | "=" | "<" | ">" | "<=" | ">=" | ":" => related = true,
            "," if depth == 0 && related => {
                let after = |k: usize| code.get(i + k);
                return after(1).is_some_and(|t| t.kind == TokenKind::Name)
                    && after(2).is_some_and(|t| t.is("="));
            }
            _ => {}
        }
    }
    false
}

fn data(
    id: FileId,
    text: &str,
    tokens: &[Token],
    piece: &StatementTokens,
    errors: &mut Vec<Diagnostic>,
) -> Option<StatementKind> {
    let own = slice(tokens, &piece.tokens);
    let braceless = match (&piece.entries, own.get(1)) {
        (None, _) => Some(span_of(id, own)),
        (_, Some(second)) if !second.is("{") => Some(second.span(id)),
        _ => None,
    };
    if let Some(at) = braceless {
        let inside = span_of(id, slice(own, &(1..own.len())));
        let said = text.get(inside.start..inside.end).unwrap_or("");
        let (inside, ours) = match said.split_once('{') {
            // `data "file" { … }`
            Some((before, _)) => {
                let end = inside.start + before.len() + 1;
                (Span::new(id, inside.start, end), "{".to_string())
            }
            None => (
                inside,
                format!("{{ {} }}", said.trim_end_matches('}').trim()),
            ),
        };
        errors.push(syntax_errors::data_without_brace(at, inside, &ours));
        return None;
    }
    let lines = piece.entries.iter().flatten();
    let lines = lines.map(|line| slice(tokens, line));
    let entries = lines.filter(|own| is_clean(own)).filter_map(|own| {
        let built = ast_builder::entry(id, text, own);
        let kind = built.map_err(|e| errors.push(*e)).ok()?;
        let span = span_of(id, own);
        Some(Entry { span, kind })
    });
    Some(StatementKind::Data(entries.collect()))
}

fn slice<'a, 't>(tokens: &'a [Token<'t>], range: &std::ops::Range<usize>) -> &'a [Token<'t>] {
    tokens.get(range.clone()).unwrap_or(&[])
}

/// True if no token was reported by the lexer.
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

/// What a broken statement would have declared.
fn broken(id: FileId, tokens: &[Token], piece: &StatementTokens) -> Broken {
    let own = slice(tokens, &piece.tokens);
    let declares = match piece.keyword {
        Some(k) => matches!(
            k,
            Keyword::State
                | Keyword::Input
                | Keyword::Output
                | Keyword::Param
                | Keyword::Unknown
                | Keyword::Let
        ),
        // Without a relation it is not an equation, so its keyword is misspelt.
        None => !own.iter().any(|t| t.is("~") || t.is("=")),
    };
    let names = own
        .iter()
        .skip(1)
        .take_while(|t| declares && !t.is(":") && !t.is("="))
        .filter(|t| matches!(t.kind, TokenKind::Name | TokenKind::Bad))
        .map(|t| lexer::normalise(t.text))
        .collect();
    Broken {
        keyword: piece.keyword,
        names,
        span: span_of(id, own),
    }
}
