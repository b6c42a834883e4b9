//! `sidc fmt`: changes white space only; spelling, comments and line breaks stay.
//!
//! In: a text without errors. Out: the same tokens in one layout. Formatting the output again changes nothing.
//! `+ - ~ = :` and relations have spaces around them, `^ ..` have none; `*` and `/` keep the author's choice, since
//! `2*pi` and `poly(x; 2) * <x>` both read well. Entries of a data block have their `=` aligned.

use crate::ast::Keyword;
use crate::diagnostic::Diagnostic;
use crate::parse::lexer::{Token, TokenKind, tokenize};
use crate::parse::parse;
use crate::parse::statements::{StatementTokens, split_statements};
use crate::source::FileId;
use crate::thresholds::MESSAGES;

const CONTINUATION: usize = 4;
const ENTRY: usize = 2;

/// The formatted text.
///
/// # Errors
/// The errors of the text, since a broken statement has no layout.
pub fn format(id: FileId, text: &str) -> Result<String, Vec<Diagnostic>> {
    let (_, errors) = parse(id, text);
    if !errors.is_empty() {
        return Err(errors);
    }
    let (tokens, _) = tokenize(id, text);
    let (pieces, _) = split_statements(id, &tokens);
    let layout = Layout::of(&tokens, &pieces);
    let mut out = String::with_capacity(text.len());
    let mut blank = true;
    for line in layout.lines() {
        if line.is_empty() {
            blank |= out.is_empty();
            if !blank {
                out.push('\n');
            }
            blank = true;
            continue;
        }
        blank = false;
        layout.write_line(line, &mut out);
    }
    let end = out.trim_end().len();
    out.truncate(end);
    if !out.is_empty() {
        out.push('\n');
    }
    Ok(out)
}

/// What a token is part of. This decides the indentation of a line that begins with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    Outside,
    Statement,
    Inside,
    Block,
    Entry,
    InsideEntry,
}

struct Layout<'a, 't> {
    tokens: &'a [Token<'t>],
    places: Vec<Place>,
    keywords: Vec<Option<Keyword>>,
    /// Spaces added before a `~` or `=` to align it with its neighbours.
    pads: Vec<usize>,
}

impl<'a, 't> Layout<'a, 't> {
    fn of(tokens: &'a [Token<'t>], pieces: &[StatementTokens]) -> Self {
        let mut layout = Layout {
            tokens,
            places: vec![Place::Outside; tokens.len()],
            keywords: vec![None; tokens.len()],
            pads: vec![0; tokens.len()],
        };
        for piece in pieces {
            layout.mark(piece);
        }
        for run in equations_on_adjacent_lines(tokens, pieces) {
            layout.align(&run);
        }
        layout
    }

    fn mark(&mut self, piece: &StatementTokens) {
        let inside = if piece.entries.is_some() {
            Place::Block
        } else {
            Place::Inside
        };
        set(&mut self.places, piece.tokens.clone(), inside);
        set(&mut self.keywords, piece.tokens.clone(), piece.keyword);
        set(
            &mut self.places,
            piece.tokens.start..piece.tokens.start + 1,
            Place::Statement,
        );
        let entries = piece.entries.iter().flatten();
        for entry in entries.clone() {
            set(&mut self.places, entry.clone(), Place::InsideEntry);
            set(&mut self.places, entry.start..entry.start + 1, Place::Entry);
        }
        let starts: Vec<usize> = entries.map(|e| e.start).collect();
        self.align(&starts);
    }

    /// Aligns the `~` or `=` of the statements that begin at these tokens.
    fn align(&mut self, starts: &[usize]) {
        let relations: Vec<(usize, usize)> = starts
            .iter()
            .filter_map(|&start| {
                let begins_line = start == 0 || self.is_kind(start - 1, TokenKind::Newline);
                let at = (start..self.tokens.len())
                    .take_while(|&i| !self.is_kind(i, TokenKind::Newline))
                    .find(|&i| self.tokens.get(i).is_some_and(|t| t.is("~") || t.is("=")))?;
                begins_line.then(|| (at, self.width(start..at)))
            })
            .collect();
        let widest = relations.iter().map(|(_, w)| *w).max().unwrap_or(0);
        for (at, width) in relations {
            if let Some(pad) = self.pads.get_mut(at) {
                *pad = widest - width;
            }
        }
    }

    fn is_kind(&self, i: usize, kind: TokenKind) -> bool {
        self.tokens.get(i).is_some_and(|t| t.kind == kind)
    }

    /// Characters that these tokens take on a line.
    fn width(&self, range: std::ops::Range<usize>) -> usize {
        let start = range.start;
        range
            .map(|i| {
                let text = self.tokens.get(i).map_or(0, |t| t.text.chars().count());
                text + if i > start { self.gap(i) } else { 0 }
            })
            .sum()
    }

    /// The tokens of each line, as ranges without the line ends.
    fn lines(&self) -> impl Iterator<Item = std::ops::Range<usize>> {
        let mut start = 0;
        let ends = self
            .tokens
            .iter()
            .enumerate()
            .filter(|(_, t)| t.kind == TokenKind::Newline)
            .map(|(i, _)| i)
            .chain([self.tokens.len()]);
        ends.map(move |end| std::mem::replace(&mut start, end + 1)..end)
    }

    fn write_line(&self, line: std::ops::Range<usize>, out: &mut String) {
        out.push_str(&" ".repeat(self.indent(line.start)));
        for i in line.clone() {
            let Some(token) = self.tokens.get(i) else {
                continue;
            };
            if i > line.start {
                out.push_str(&" ".repeat(self.gap(i)));
            }
            out.push_str(token.text.trim_end());
        }
        out.push('\n');
    }

    fn indent(&self, first: usize) -> usize {
        match self.places.get(first) {
            Some(Place::Inside) => CONTINUATION,
            Some(Place::Block)
                if self
                    .tokens
                    .get(first)
                    .is_some_and(|t| t.is("}") || t.is("{")) =>
            {
                0
            }
            Some(Place::Block | Place::Entry) => ENTRY,
            Some(Place::InsideEntry) => ENTRY + CONTINUATION,
            _ => 0,
        }
    }

    /// Spaces before token `i`, which is not the first of its line.
    fn gap(&self, i: usize) -> usize {
        let (Some(token), Some(last)) = (
            self.tokens.get(i),
            i.checked_sub(1).and_then(|k| self.tokens.get(k)),
        ) else {
            return 0;
        };
        if token.kind == TokenKind::Comment {
            return (token.start - last.end).max(2);
        }
        let relation = self.keywords.get(i).copied().flatten();
        let relation = relation.is_some_and(Keyword::compares);
        let pad = self.pads.get(i).copied().unwrap_or(0);
        pad + usize::from(match (last.text, token.text) {
            _ if last.kind == TokenKind::Text || token.kind == TokenKind::Text => {
                self.beside_text(i, last, token)
            }
            ("{", _) | (_, "}" | "{") => true,
            _ if self.in_index(i) => false,
            (_, "," | ";" | ")" | ".." | "^" | "[") | ("(" | ".." | "^", _) => false,
            ("<" | ">", _) | (_, "<" | ">") if relation => true,
            (_, ">") | ("<", _) => false,
            ("," | ";" | ":" | "~" | "=" | "<=" | ">=", _) => true,
            ("-", _) => self.is_binary(i - 1),
            ("*" | "/", _) => self.is_loose(i - 1),
            (_, "*" | "/") => self.is_loose(i),
            ("+", _) | (_, "+" | "-") => true,
            ("coef", "(") => false,
            (_, "(") => last.kind == TokenKind::Name && self.opens_statement(i - 1),
            _ => true,
        })
    }

    /// Whether token `i` is inside the brackets of `x[i-1]`. An index is short, so only a few tokens are searched.
    fn in_index(&self, i: usize) -> bool {
        let before = self.tokens.iter().take(i).rev();
        let mut near = before.take(MESSAGES.index);
        let bracket = near.find(|t| t.kind == TokenKind::Symbol && matches!(t.text, "[" | "]"));
        bracket.is_some_and(|t| t.text == "[")
    }

    /// [`Layout::gap`] beside a quoted text, whose content must not be compared with symbols.
    fn beside_text(&self, i: usize, last: &Token, token: &Token) -> bool {
        if last.kind == TokenKind::Text {
            return match token.text {
                "*" | "/" => self.is_loose(i),
                "," | ";" | ")" | "^" => false,
                _ => true,
            };
        }
        match last.text {
            "(" => false,
            "*" | "/" => self.is_loose(i - 1),
            "-" => self.is_binary(i - 1),
            _ => true,
        }
    }

    fn opens_statement(&self, i: usize) -> bool {
        self.places.get(i) == Some(&Place::Statement)
            && self.keywords.get(i).is_some_and(Option::is_some)
    }

    /// True if the `-` at `i` has a left operand.
    fn is_binary(&self, i: usize) -> bool {
        let left = self.tokens.iter().take(i).rev().find(|t| t.is_code());
        let Some(left) = left else {
            return false;
        };
        let keyword = self.keywords.get(i).copied().flatten();
        match left.kind {
            TokenKind::Symbol => {
                matches!(left.text, ")" | "]")
                    || left.text == ">" && !keyword.is_some_and(Keyword::compares)
            }
            TokenKind::Name => {
                let begins_range = keyword == Some(Keyword::Unknown) && left.text == "in";
                let is_keyword = keyword.is_some_and(|k| k.text() == left.text);
                !(is_keyword || begins_range || left.text == "step")
            }
            _ => true,
        }
    }

    /// True if the author left space beside the operator at `i`.
    fn is_loose(&self, i: usize) -> bool {
        let on_line = |k: &usize| self.tokens.get(*k).is_some_and(Token::is_code);
        let here = self.tokens.get(i).map_or((0, 0), |t| (t.start, t.end));
        let left = i
            .checked_sub(1)
            .filter(on_line)
            .and_then(|k| self.tokens.get(k));
        let right = Some(i + 1).filter(on_line).and_then(|k| self.tokens.get(k));
        // An operator at either end of a line counts as spaced.
        left.is_none_or(|t| t.end != here.0) || right.is_none_or(|t| t.start != here.1)
    }
}

/// Runs of one-line equations on consecutive lines, as the index of the first token of each.
fn equations_on_adjacent_lines(tokens: &[Token], pieces: &[StatementTokens]) -> Vec<Vec<usize>> {
    let mut runs: Vec<Vec<usize>> = Vec::new();
    let mut next_start = None;
    for piece in pieces {
        let own = tokens.get(piece.tokens.clone()).unwrap_or(&[]);
        if piece.keyword.is_some() || own.iter().any(|t| t.kind == TokenKind::Newline) {
            next_start = None;
            continue;
        }
        match runs
            .last_mut()
            .filter(|_| next_start == Some(piece.tokens.start))
        {
            Some(run) => run.push(piece.tokens.start),
            None => runs.push(vec![piece.tokens.start]),
        }
        let after = (piece.tokens.end..tokens.len())
            .find(|&i| tokens.get(i).is_some_and(|t| t.kind != TokenKind::Comment));
        next_start = after.map(|newline| newline + 1);
    }
    runs
}

/// Fills the part of a range that exists.
fn set<T: Copy>(marks: &mut [T], range: std::ops::Range<usize>, value: T) {
    let end = range.end.min(marks.len());
    if let Some(part) = marks.get_mut(range.start..end) {
        part.fill(value);
    }
}
