//! Tokens → statements, by the line rules of the language.
//!
//! A line end ends a statement except inside brackets, after an operator or comma, or before an operator. A line
//! that opens with a keyword or `NAMES ~` starts a new statement even if a bracket is open: recovery from any error
//! stands on that. Out: ranges of tokens, and an error for each bracket without its partner.

use std::ops::Range;

use super::errors;
use super::token::{Token, TokenKind};
use crate::lang::ast::Keyword;
use crate::lang::diagnostic::Diagnostic;
use crate::lang::source::FileId;

/// One statement: which tokens, and whether its brackets are sound.
pub struct Piece {
    pub keyword: Option<Keyword>,
    pub tokens: Range<usize>,
    /// The lines of a data block; `None` if no `{` was found.
    pub entries: Option<Vec<Range<usize>>>,
    pub sound: bool,
}

/// Deepest nesting of brackets; far below what the stack of a thread holds.
pub const MAX_NESTING: usize = 128;

pub fn pieces(file: FileId, tokens: &[Token]) -> (Vec<Piece>, Vec<Diagnostic>) {
    let mut cutter = Cutter {
        file,
        tokens,
        next: next_code(tokens),
        errors: Vec::new(),
    };
    let mut out = Vec::new();
    let mut at = 0;
    while let Some(start) = cutter.next_code(at) {
        let piece = cutter.piece(start);
        at = piece.tokens.end.max(start + 1);
        out.push(piece);
    }
    (out, cutter.errors)
}

/// For each token, the index of the first code token from there on.
fn next_code(tokens: &[Token]) -> Vec<Option<usize>> {
    let mut next = None;
    let mut out: Vec<_> = (0..tokens.len())
        .rev()
        .map(|i| {
            if tokens.get(i).is_some_and(Token::is_code) {
                next = Some(i);
            }
            next
        })
        .collect();
    out.reverse();
    out
}

struct Cutter<'t> {
    file: FileId,
    tokens: &'t [Token<'t>],
    next: Vec<Option<usize>>,
    errors: Vec<Diagnostic>,
}

/// What is open while a statement is read.
struct Open {
    brackets: Vec<usize>,
    sound: bool,
    minuses: usize,
}

impl<'t> Cutter<'t> {
    fn get(&self, i: usize) -> Option<&Token<'t>> {
        self.tokens.get(i)
    }

    fn next_code(&self, from: usize) -> Option<usize> {
        self.next.get(from).copied().flatten()
    }

    fn piece(&mut self, start: usize) -> Piece {
        let keyword = self.keyword_at(start);
        let mut open = Open {
            brackets: Vec::new(),
            sound: true,
            minuses: 0,
        };
        let mut entries = None;
        let (mut i, mut last) = (start, start);
        while let Some(token) = self.get(i).copied() {
            if token.kind == TokenKind::Newline {
                let relation = keyword == Some(Keyword::Constrain);
                match self.next_code(i) {
                    Some(next)
                        if !self.ends_between(last, next, open.brackets.is_empty(), relation) =>
                    {
                        i = next
                    }
                    _ => break,
                }
                continue;
            } else if token.is_code() {
                if keyword == Some(Keyword::Data) && token.is("{") && open.brackets.is_empty() {
                    let (lines, end) = self.data_lines(i, &mut open);
                    entries = Some(lines);
                    last = end;
                    break;
                }
                last = i;
                self.track(i, token, keyword, &mut open);
            }
            i += 1;
        }
        self.report_open(&open);
        Piece {
            keyword,
            tokens: start..last + 1,
            entries,
            sound: open.sound && open.brackets.is_empty(),
        }
    }

    /// The entries between `{` at `brace` and its `}`, and the last token of the block.
    fn data_lines(&mut self, brace: usize, open: &mut Open) -> (Vec<Range<usize>>, usize) {
        open.brackets.push(brace);
        let mut lines = Vec::new();
        let mut first: Option<usize> = None;
        let (mut i, mut last) = (brace + 1, brace);
        while let Some(token) = self.get(i).copied() {
            let mut ends = token.is("}") || token.is(";") && open.brackets.len() == 1;
            if token.kind == TokenKind::Newline {
                let Some(next) = self.next_code(i).filter(|&n| !self.opens_statement(n)) else {
                    break;
                };
                let entry = self.opens_entry(next);
                if entry && open.brackets.len() > 1 {
                    self.report_open(open);
                    open.sound = false;
                    open.brackets.truncate(1);
                }
                ends = entry || self.ends_between(last, next, open.brackets.len() == 1, false);
                i = next - 1;
            }
            if ends {
                if let Some(first) = first.take() {
                    lines.push(first..last + 1);
                }
                if token.is("}") {
                    if open.brackets.len() > 1 {
                        self.close(i, open);
                    }
                    open.brackets.clear();
                    return (lines, i);
                }
            } else if token.is_code() {
                first.get_or_insert(i);
                last = i;
                self.track(i, token, Some(Keyword::Data), open);
            }
            i += 1;
        }
        if let Some(first) = first {
            lines.push(first..last + 1);
        }
        (lines, last)
    }

    /// Opens and closes brackets, and counts what would nest the parser too deep.
    fn track(&mut self, i: usize, token: Token, keyword: Option<Keyword>, open: &mut Open) {
        let angles = !matches!(
            keyword,
            Some(Keyword::Constrain | Keyword::Data | Keyword::Symmetry)
        );
        open.minuses = if token.is("-") { open.minuses + 1 } else { 0 };
        match token.text {
            _ if token.kind != TokenKind::Symbol => {}
            "(" | "{" => self.open(i, open),
            "<" if angles => self.open(i, open),
            ")" | "}" => self.close(i, open),
            ">" if angles => self.close(i, open),
            _ => {}
        }
        if open.sound && open.minuses > MAX_NESTING {
            open.sound = false;
            self.errors
                .push(errors::too_deep(token.span(self.file), MAX_NESTING));
        }
    }

    fn open(&mut self, i: usize, open: &mut Open) {
        open.brackets.push(i);
        if open.brackets.len() == MAX_NESTING + 1 && open.sound {
            open.sound = false;
            if let Some(token) = self.get(i) {
                self.errors
                    .push(errors::too_deep(token.span(self.file), MAX_NESTING));
            }
        }
    }

    fn close(&mut self, i: usize, open: &mut Open) {
        let Some(closing) = self.get(i).copied() else {
            return;
        };
        let opening = open.brackets.pop().and_then(|o| self.get(o).copied());
        let matches = opening.is_some_and(|o| partner(o.text) == closing.text);
        if !matches && open.sound {
            open.sound = false;
            let error = match opening {
                Some(o) => errors::wrong_bracket(
                    o.span(self.file),
                    closing.span(self.file),
                    o.text,
                    closing.text,
                ),
                None => errors::stray_bracket(closing.span(self.file), closing.text),
            };
            self.errors.push(error);
        }
    }

    fn report_open(&mut self, open: &Open) {
        let innermost = open.brackets.last().and_then(|&i| self.get(i).copied());
        if let (true, Some(token)) = (open.sound, innermost) {
            self.errors.push(errors::unclosed_bracket(
                token.span(self.file),
                token.text,
                partner(token.text),
            ));
        }
    }

    /// Whether the line ends between two code tokens end a statement.
    fn ends_between(&self, last: usize, next: usize, closed: bool, relation: bool) -> bool {
        if self.opens_statement(next) {
            return true;
        }
        let joined = self.get(last).is_some_and(|t| continues_after(t, relation))
            || self.get(next).is_some_and(continues_before);
        closed && !joined
    }

    /// `NAME =`, inside a data block.
    fn opens_entry(&self, i: usize) -> bool {
        self.get(i).is_some_and(|t| t.kind == TokenKind::Name)
            && self.get(i + 1).is_some_and(|t| t.is("="))
    }

    /// The keyword that opens a statement here; a name of the model if `~`, `=` or the like follows.
    fn keyword_at(&self, i: usize) -> Option<Keyword> {
        let token = self.get(i).filter(|t| t.kind == TokenKind::Name)?;
        let keyword = Keyword::named(token.text)?;
        let is_name = self.get(i + 1).is_some_and(|next| {
            next.kind == TokenKind::Symbol && ["~", "=", ",", "..", "=="].contains(&next.text)
        });
        (!is_name).then_some(keyword)
    }

    /// True if the line that begins at token `i` starts a statement whatever is open.
    fn opens_statement(&self, i: usize) -> bool {
        if self.keyword_at(i).is_some() {
            return self.get(i + 1).is_some_and(|next| {
                matches!(next.kind, TokenKind::Name | TokenKind::Number) || next.is("{")
            });
        }
        if self.get(i).is_none_or(|t| t.kind != TokenKind::Name) {
            return false;
        }
        self.tokens
            .iter()
            .skip(i)
            .find(|t| t.kind != TokenKind::Name && ![",", "..", "(", ")"].contains(&t.text))
            .is_some_and(|t| t.is("~"))
    }
}

fn partner(open: &str) -> &'static str {
    match open {
        "(" => ")",
        "<" => ">",
        _ => "}",
    }
}

/// `relation`: `>` compares, as it does in a constraint, and closes no list.
fn continues_after(token: &Token, relation: bool) -> bool {
    let closes = matches!(token.text, ")" | "}" | "{") || token.text == ">" && !relation;
    token.kind == TokenKind::Symbol && !closes
}

fn continues_before(token: &Token) -> bool {
    token.kind == TokenKind::Symbol && !matches!(token.text, "(" | "}")
}
