//! Tokens → the token ranges of statements, by the line rules of the language. Error recovery rests on this.
//!
//! In: tokens. Out: one range for each statement, and an error for each bracket without its partner. A line end ends a statement
//! except inside brackets, after an operator or comma, or before an operator. A line that opens with a keyword or `NAMES ~` starts a
//! new statement even if a bracket is open, so that one missing bracket spoils one statement. Reads no expression.

use std::ops::Range;

use crate::ast::Keyword;
use crate::diagnostic::Diagnostic;
use crate::parse::lexer::{Token, TokenKind};
use crate::parse::syntax_errors::{self, closing_bracket};
use crate::source::FileId;
use crate::thresholds::MODEL;

/// One statement: its tokens, and whether its brackets match.
pub struct StatementTokens {
    pub keyword: Option<Keyword>,
    pub tokens: Range<usize>,
    /// The lines of a data block; `None` if no `{` was found.
    pub entries: Option<Vec<Range<usize>>>,
    pub sound: bool,
}

pub fn split_statements(file: FileId, tokens: &[Token]) -> (Vec<StatementTokens>, Vec<Diagnostic>) {
    let mut splitter = Splitter {
        file,
        tokens,
        next: next_code(tokens),
        errors: Vec::new(),
    };
    let mut out = Vec::new();
    let mut at = 0;
    while let Some(start) = splitter.next_code(at) {
        let piece = splitter.piece(start);
        at = piece.tokens.end.max(start + 1);
        out.push(piece);
    }
    (out, splitter.errors)
}

/// For each token, the index of the first code token at or after it.
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

struct Splitter<'t> {
    file: FileId,
    tokens: &'t [Token<'t>],
    next: Vec<Option<usize>>,
    errors: Vec<Diagnostic>,
}

/// Brackets that are open while a statement is read.
struct OpenBrackets {
    brackets: Vec<usize>,
    sound: bool,
    minuses: usize,
}

impl<'t> Splitter<'t> {
    fn get(&self, i: usize) -> Option<&Token<'t>> {
        self.tokens.get(i)
    }

    fn next_code(&self, from: usize) -> Option<usize> {
        self.next.get(from).copied().flatten()
    }

    fn piece(&mut self, start: usize) -> StatementTokens {
        let keyword = self.keyword_at(start);
        let mut open = OpenBrackets {
            brackets: Vec::new(),
            sound: true,
            minuses: 0,
        };
        if let Some(end) = self.unopened_block(start, keyword) {
            return StatementTokens {
                keyword,
                tokens: start..end + 1,
                entries: None,
                sound: true,
            };
        }
        let mut entries = None;
        let (mut i, mut last) = (start, start);
        while let Some(token) = self.get(i).copied() {
            if token.kind == TokenKind::Newline {
                let relation = keyword.is_some_and(Keyword::compares);
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
        self.report_open(&open, last);
        StatementTokens {
            keyword,
            tokens: start..last + 1,
            entries,
            sound: open.sound && open.brackets.is_empty(),
        }
    }

    /// The `}` of a data block without its `{`: the lines before it belong to the block and are not equations.
    fn unopened_block(&self, start: usize, keyword: Option<Keyword>) -> Option<usize> {
        let next = self.next_code(start + 1)?;
        if keyword != Some(Keyword::Data) || self.get(next)?.is("{") {
            return None;
        }
        let mut i = start + 1;
        loop {
            let token = self.get(i)?;
            if token.is("}") {
                return Some(i);
            }
            let opens = token.kind == TokenKind::Newline
                && self.next_code(i).is_some_and(|n| self.opens_statement(n));
            if token.is("{") || opens {
                return None;
            }
            i += 1;
        }
    }

    /// The entries between `{` at `brace` and its `}`, and the last token of the block.
    fn data_lines(&mut self, brace: usize, open: &mut OpenBrackets) -> (Vec<Range<usize>>, usize) {
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
                    self.report_open(open, last);
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

    /// Opens and closes brackets, and counts nesting and runs of minus signs, which the recursive parser descends into.
    fn track(&mut self, i: usize, token: Token, keyword: Option<Keyword>, open: &mut OpenBrackets) {
        let angles = !keyword
            .is_some_and(|k| k.compares() || matches!(k, Keyword::Data | Keyword::Symmetry));
        // An unclosed quote may have swallowed a closing bracket.
        let quote = token.kind == TokenKind::Bad && token.text.starts_with('"');
        open.sound &= !quote;
        open.minuses = if token.is("-") { open.minuses + 1 } else { 0 };
        match token.text {
            _ if token.kind != TokenKind::Symbol => {}
            "(" | "{" => self.open(i, open),
            "<" if angles => self.open(i, open),
            ")" | "}" => self.close(i, open),
            ">" if angles => self.close(i, open),
            _ => {}
        }
        if open.sound && open.minuses > MODEL.nesting {
            open.sound = false;
            self.errors.push(syntax_errors::too_deep(
                token.span(self.file),
                MODEL.nesting,
            ));
        }
    }

    fn open(&mut self, i: usize, open: &mut OpenBrackets) {
        open.brackets.push(i);
        if open.brackets.len() == MODEL.nesting + 1 && open.sound {
            open.sound = false;
            if let Some(token) = self.get(i) {
                self.errors.push(syntax_errors::too_deep(
                    token.span(self.file),
                    MODEL.nesting,
                ));
            }
        }
    }

    fn close(&mut self, i: usize, open: &mut OpenBrackets) {
        let Some(closing) = self.get(i).copied() else {
            return;
        };
        let opening = open.brackets.pop().and_then(|o| self.get(o).copied());
        let matches = opening.is_some_and(|o| closing_bracket(o.text) == closing.text);
        if !matches && open.sound {
            open.sound = false;
            let error = match opening {
                Some(o) => {
                    let outer = open.brackets.last().and_then(|i| self.get(*i));
                    syntax_errors::wrong_bracket(
                        (o.span(self.file), closing.span(self.file)),
                        (o.text, closing.text),
                        outer.is_some_and(|o| closing_bracket(o.text) == closing.text),
                    )
                }
                None => syntax_errors::stray_bracket(closing.span(self.file), closing.text),
            };
            self.errors.push(error);
        }
    }

    /// `last`: the last token of the statement or entry.
    fn report_open(&mut self, open: &OpenBrackets, last: usize) {
        let innermost = open.brackets.last().and_then(|&i| self.get(i).copied());
        if let (true, Some(token)) = (open.sound, innermost) {
            let end = self.get(last).unwrap_or(&token).span(self.file).after();
            self.errors.push(syntax_errors::unclosed_bracket(
                token.span(self.file),
                end,
                token.text,
                closing_bracket(token.text),
            ));
        }
    }

    /// True if the line ends between two code tokens end a statement.
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

    /// The keyword that opens a statement here. A keyword before `~`, `=` or the like is a name of the model.
    fn keyword_at(&self, i: usize) -> Option<Keyword> {
        let token = self.get(i).filter(|t| t.kind == TokenKind::Name)?;
        let keyword = Keyword::named(token.text)?;
        let is_name = self.get(i + 1).is_some_and(|next| {
            next.kind == TokenKind::Symbol && ["~", "=", ",", "..", "=="].contains(&next.text)
        });
        // Elsewhere `coef` is a name, or stands in a constraint.
        let called = self.get(i + 1).is_some_and(|next| next.is("("));
        (!is_name && (keyword != Keyword::Coef || called)).then_some(keyword)
    }

    /// True if the line that begins at token `i` starts a statement, even inside brackets.
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
            .find(|t| {
                t.kind != TokenKind::Name && ![",", "..", "(", ")", "[", "]"].contains(&t.text)
            })
            .is_some_and(|t| t.is("~"))
    }
}

/// True if a statement continues after this token at the end of a line. `relation`: `>` compares, as in a constraint.
fn continues_after(token: &Token, relation: bool) -> bool {
    let closes =
        matches!(token.text, ")" | "]" | "}" | "{" | ";") || token.text == ">" && !relation;
    token.kind == TokenKind::Symbol && !closes
}

fn continues_before(token: &Token) -> bool {
    token.kind == TokenKind::Symbol && !matches!(token.text, "(" | "}")
}
