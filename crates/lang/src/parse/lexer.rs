//! Text → tokens with places, comments and line ends included.
//!
//! In: any text. Out: tokens that cover everything but blanks, and an error for each character or number that the language does not have.
//! Used by the statement splitter, the explanation of syntax errors, and the formatter. The grammar reads the text itself, where comments
//! and line ends are white space.

use std::collections::BTreeSet;

use unicode_normalization::UnicodeNormalization;

use crate::diagnostic::Diagnostic;
use crate::parse::confusables;
use crate::parse::foreign_spellings::signs::{self, Place};
use crate::parse::syntax_errors;
pub use crate::parse::token::{Token, TokenKind};
use crate::source::{FileId, Span};
use crate::thresholds::MESSAGES;

/// A name in Unicode normalisation form C, as the checker compares names.
pub fn normalise(name: &str) -> String {
    if name.is_ascii() {
        return name.to_string();
    }
    name.nfc().collect()
}

/// Splits a text into tokens.
pub fn tokenize(file: FileId, text: &str) -> (Vec<Token<'_>>, Vec<Diagnostic>) {
    let mut lexer = Lexer {
        file,
        text,
        at: 0,
        out: Vec::with_capacity(text.len() / 3),
        line: 0,
        last_comment_end: text.rfind("*/"),
        indices: indices(text),
        in_index: false,
        errors: Vec::new(),
    };
    while let Some(c) = lexer.peek() {
        lexer.step(c);
    }
    (lexer.out, lexer.errors)
}

pub fn is_blank(c: char) -> bool {
    matches!(c, ' ' | '\t' | '\r' | '\u{A0}' | '\u{FEFF}')
}

/// True if a text can be a name.
pub fn is_name(text: &str) -> bool {
    text.starts_with(starts_name) && text.chars().all(continues_name)
}

fn starts_name(c: char) -> bool {
    c.is_alphabetic() || c == '_'
}

fn continues_name(c: char) -> bool {
    starts_name(c) || c.is_ascii_digit() || unicode_normalization::char::is_combining_mark(c)
}

struct Lexer<'t> {
    file: FileId,
    text: &'t str,
    at: usize,
    out: Vec<Token<'t>>,
    /// The first token of the line in `out`.
    line: usize,
    /// The last `*/` of the text, so that it is searched for only once.
    last_comment_end: Option<usize>,
    /// Names that run over a range somewhere in the text: `, i = 1..10`.
    indices: BTreeSet<&'t str>,
    /// Between the brackets of an index.
    in_index: bool,
    errors: Vec<Diagnostic>,
}

/// Longest text from the comma to the dots of `, i = 1..10` that is searched.
const INDEX_RANGE: usize = 60;

/// The names of all ranges `, i = 1..` of a text.
fn indices(text: &str) -> BTreeSet<&str> {
    let before = |(at, _): (usize, &str)| {
        let start = at.saturating_sub(INDEX_RANGE);
        let start = (start..=at).find(|i| text.is_char_boundary(*i))?;
        let (_, own) = text.get(start..at)?.rsplit_once(',')?;
        let (name, _) = own.split_once('=')?;
        Some(name.trim()).filter(|name| is_name(name))
    };
    text.match_indices("..").filter_map(before).collect()
}

const PAIRS: [&str; 5] = ["..", "<=", ">=", "==", "->"];
const SINGLES: &str = "+-*/^~=:;,()<>{}";

impl<'t> Lexer<'t> {
    fn rest(&self) -> &'t str {
        self.text.get(self.at..).unwrap_or("")
    }

    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    /// Moves past characters while they satisfy `wanted`.
    fn skip(&mut self, wanted: impl Fn(char) -> bool) {
        let rest = self.rest();
        self.at += rest.find(|c| !wanted(c)).unwrap_or(rest.len());
    }

    fn push(&mut self, kind: TokenKind, start: usize) -> &'t str {
        let text = self.text.get(start..self.at).unwrap_or("");
        self.out.push(Token {
            kind,
            start,
            end: self.at,
            text,
        });
        text
    }

    fn span(&self, start: usize) -> Span {
        Span::new(self.file, start, self.at)
    }

    fn step(&mut self, c: char) {
        let start = self.at;
        if is_blank(c) {
            self.skip(is_blank);
        } else if c == '\n' {
            self.at += 1;
            self.push(TokenKind::Newline, start);
            self.line = self.out.len();
        } else if c == '#' {
            self.skip(|c| c != '\n');
            self.push(TokenKind::Comment, start);
        } else if c == '"' {
            self.quoted(start);
        } else if c.is_ascii_digit() {
            self.number(start);
        } else if starts_name(c) {
            self.name(start);
        } else if self.index_bracket(c) {
            self.at += 1;
            self.push(TokenKind::Symbol, start);
        } else if !self.foreign(start, c) {
            self.symbol(start, c);
        }
    }

    /// Whether a name is declared here: after the keyword of a declaration, with only names and commas between.
    fn declares(&self) -> bool {
        let line = self.out.get(self.line..).unwrap_or(&[]);
        let mut code = line.iter().filter(|t| t.is_code());
        let opens = code.next().is_some_and(|t| {
            matches!(
                t.text,
                "system" | "state" | "input" | "output" | "param" | "unknown" | "let"
            )
        });
        opens && code.all(|t| t.kind == TokenKind::Name || t.is(","))
    }

    fn quoted(&mut self, start: usize) {
        self.at += 1;
        self.skip(|c| c != '"' && c != '\n');
        if self.peek() == Some('"') {
            self.at += 1;
            self.push(TokenKind::Text, start);
        } else {
            let text = self.push(TokenKind::Bad, start);
            self.errors
                .push(syntax_errors::unclosed_quote(self.span(start), text));
        }
    }

    fn number(&mut self, start: usize) {
        self.skip(|c| c.is_ascii_digit());
        let mut dangling = false;
        if self.rest().starts_with('.') && !self.rest().starts_with("..") {
            self.at += 1;
            let digits = self.at;
            self.skip(|c| c.is_ascii_digit());
            dangling = self.at == digits;
        }
        self.exponent();
        let text = self.text.get(start..self.at).unwrap_or("");
        if dangling {
            self.bad(start, syntax_errors::dangling_dot(self.span(start), text));
        } else if !in_range(text) {
            self.bad(start, syntax_errors::number_range(self.span(start), text));
        } else if self.peek().is_some_and(starts_name) {
            let number = text;
            let name = self.at;
            self.skip(continues_name);
            let name = self.text.get(name..self.at).unwrap_or("");
            let span = self.span(start);
            let error = match self.declares() {
                true => syntax_errors::digit_first(span, number, name),
                false => syntax_errors::implicit_product(span, number, name),
            };
            self.bad(start, error);
        } else {
            // `2%`, `2 %`
            let after = self.rest().trim_start_matches(' ');
            if after.starts_with('%') {
                self.at += self.rest().len() - after.len() + 1;
            }
            self.push(TokenKind::Number, start);
        }
    }

    /// `e-3`, if digits follow: `2e` is the number 2 and the name e.
    fn exponent(&mut self) {
        let rest = self.rest();
        let Some(tail) = rest.strip_prefix(['e', 'E']) else {
            return;
        };
        let digits = tail.strip_prefix(['+', '-']).unwrap_or(tail);
        if digits.starts_with(|c: char| c.is_ascii_digit()) {
            self.at += rest.len() - digits.len();
            self.skip(|c| c.is_ascii_digit());
        }
    }

    fn name(&mut self, start: usize) {
        self.skip(continues_name);
        let name = self.text.get(start..self.at).unwrap_or("");
        if !name.is_ascii()
            && let Some(ascii) = confusables::accented(&normalise(name))
        {
            let span = self.span(start);
            return self.bad(start, syntax_errors::pasted(span, name, &ascii));
        }
        self.skip(|c| c == '\'');
        self.push(TokenKind::Name, start);
    }

    /// A bracket of `x[i + 1]`, where i is an index of the text.
    fn index_bracket(&mut self, c: char) -> bool {
        if c == ']' && self.in_index {
            self.in_index = false;
            return true;
        }
        if c != '[' || self.indices.is_empty() || !self.is_index() {
            return false;
        }
        let inner = self.rest().get(1..).and_then(|r| r.split(']').next());
        let mut words = inner.unwrap_or("").split(|c| !continues_name(c));
        self.in_index = words.any(|word| self.indices.contains(word));
        self.in_index
    }

    /// A sign of another language, if one begins here.
    fn foreign(&mut self, start: usize, c: char) -> bool {
        if !signs::may_begin(c) {
            return false;
        }
        let place = Place {
            file: self.file,
            start,
            rest: self.rest(),
            line: self.out.get(self.line..).unwrap_or(&[]),
            comment_ends: self.last_comment_end.is_some_and(|end| start < end),
        };
        let Some(sign) = signs::sign(&place) else {
            return false;
        };
        self.at += sign.len;
        let kind = match sign.comment {
            true => TokenKind::Comment,
            false => TokenKind::Bad,
        };
        self.push(kind, start);
        self.errors.push(sign.error);
        true
    }

    fn symbol(&mut self, start: usize, c: char) {
        let rest = self.rest();
        if PAIRS.iter().any(|p| rest.starts_with(p)) {
            self.at += 2;
            let text = self.push(TokenKind::Symbol, start);
            if text == "==" {
                self.errors
                    .push(syntax_errors::double_equals(self.span(start)));
            }
        } else if SINGLES.contains(c) {
            self.at += 1;
            self.push(TokenKind::Symbol, start);
        } else if c == '.'
            && rest
                .get(1..)
                .is_some_and(|r| r.starts_with(|c: char| c.is_ascii_digit()))
        {
            self.at += 1;
            self.skip(|c| c.is_ascii_digit());
            self.exponent();
            let text = self.text.get(start..self.at).unwrap_or("");
            self.bad(start, syntax_errors::dangling_dot(self.span(start), text));
        } else if c == '[' && self.is_index() {
            self.skip(|c| c != ']' && c != '\n');
            self.skip(|c| c == ']');
            let (whole, ours) = self.name_without_index(start);
            self.bad(start, syntax_errors::index(self.span(start), whole, ours));
        } else {
            self.unexpected_character(start, c);
        }
    }

    /// `z[1..3]` as `z1..z3`, `x[3]` as `x3`, any other index left out; with its place.
    fn name_without_index(&self, bracket: usize) -> (Span, String) {
        let start = self.out.last().map_or(bracket, |t| t.start);
        let name = self.text.get(start..bracket).unwrap_or("");
        let index = self.text.get(bracket + 1..self.at).unwrap_or("");
        let index = index.trim_end_matches(']').trim();
        let (from, to) = index.split_once("..").unwrap_or((index, ""));
        let whole = |n: &str| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit());
        let ours = match (whole(from), whole(to)) {
            (true, true) => format!("{name}{from}..{name}{to}"),
            (true, false) => format!("{name}{from}"),
            _ => name.to_string(),
        };
        (self.span(start), ours)
    }

    /// True at the `[` of `x[k+1]`: right after a name, and closed within a few characters. The bound keeps the lexer linear.
    fn is_index(&self) -> bool {
        let beside = |t: &Token| t.kind == TokenKind::Name && t.end == self.at;
        let mut inside = self.rest().chars().take(MESSAGES.index);
        let closed = inside.find(|c| matches!(c, ']' | '\n')) == Some(']');
        self.out.last().is_some_and(beside) && closed
    }

    /// The text before the next quote of a word processor on this line, and where the quote ends.
    fn to_pasted_quote(&self) -> Option<(&'t str, usize)> {
        let line = self.rest().split('\n').next()?;
        let closes = |(_, c): &(usize, char)| confusables::ascii(*c) == Some("\"");
        let (at, quote) = line.char_indices().find(closes)?;
        Some((line.get(..at)?, self.at + at + quote.len_utf8()))
    }

    /// A character that the language does not have, with the confusable characters that follow it (`²³`).
    fn unexpected_character(&mut self, start: usize, c: char) {
        self.at += c.len_utf8();
        if confusables::ascii(c) == Some("\"")
            && let Some((inside, end)) = self.to_pasted_quote()
        {
            self.at = end;
            let text = self.text.get(start..end).unwrap_or("");
            let ours = format!("\"{inside}\"");
            let d = syntax_errors::pasted_quotes(self.span(start), c, text, &ours);
            return self.bad(start, d);
        }
        match confusables::ascii(c) {
            Some(_) => {
                self.skip(|c| confusables::ascii(c).is_some());
                let run = self.text.get(start..self.at).unwrap_or("");
                let ascii = confusables::ascii_run(run);
                self.bad(start, syntax_errors::pasted(self.span(start), run, &ascii));
            }
            None => self.bad(start, syntax_errors::strange_character(self.span(start), c)),
        }
    }

    fn bad(&mut self, start: usize, error: Diagnostic) {
        self.push(TokenKind::Bad, start);
        self.errors.push(error);
    }
}

/// True if the number is finite and did not underflow to 0.
fn in_range(text: &str) -> bool {
    let mantissa = text.split(['e', 'E']).next().unwrap_or("");
    text.parse::<f64>().is_ok_and(|x| {
        x.is_finite() && (x != 0.0 || !mantissa.contains(|c: char| ('1'..='9').contains(&c)))
    })
}
