//! Statements: `const g = 9.81`, `for i in 1:3`, `if x > 0`, `include "a.sid"`, `def f(x)`, `x and y`, `;` at the end of a line.
//!
//! In: the tokens of a statement. Out: the error that says how it is written here, instead of the errors of the grammar.

use super::{foreign, foreign_because};
use crate::ast::Keyword;
use crate::diagnostic::{Diagnostic, Edit};
use crate::parse::token::{Token, TokenKind};
use crate::source::{FileId, Span};
use crate::term::Func;

/// Words before the name of a number.
const NUMBERS: [&str; 16] = [
    "const",
    "constant",
    "constexpr",
    "final",
    "static",
    "parameter",
    "parameters",
    "real",
    "Real",
    "float",
    "double",
    "int",
    "var",
    "val",
    "global",
    "auto",
];

/// Calls that choose between two values.
const CHOICES: [&str; 7] = [
    "if",
    "If",
    "ifelse",
    "where",
    "select",
    "piecewise",
    "merge",
];

/// Words that open statements in other languages, and the keyword in this one.
const OPENING: [(&str, &str); 14] = [
    ("constraint", "constrain"),
    ("assume", "constrain"),
    ("require", "constrain"),
    ("variable", "state"),
    ("variables", "state"),
    ("var", "state"),
    ("vars", "state"),
    ("species", "state"),
    ("dynamic", "state"),
    ("control", "input"),
    ("controls", "input"),
    ("exogenous", "input"),
    ("forcing", "input"),
    ("measurement", "output"),
];

const LOOPS: [&str; 4] = ["for", "while", "parfor", "repeat"];
const BRANCHES: [&str; 6] = ["if", "ifelse", "elseif", "elif", "else", "when"];
const FILES: [&str; 4] = ["import", "using", "from", "library"];
const FUNCTIONS: [&str; 5] = ["function", "def", "fn", "func", "lambda"];
const BLOCKS: [&str; 10] = [
    "model",
    "class",
    "module",
    "begin",
    "end",
    "endmodel",
    "equation",
    "equations",
    "algorithm",
    "program",
];

/// The error of a statement that is written in another language.
pub fn statement(
    file: FileId,
    text: &str,
    tokens: &[Token],
    keyword: Option<Keyword>,
) -> Option<Diagnostic> {
    let own: Vec<&Token> = tokens.iter().filter(|t| t.is_code()).collect();
    let s = Written { file, text, own };
    s.opening_word(keyword)
        .or_else(|| s.branch(keyword))
        .or_else(|| s.conjunction(keyword))
}

/// The error of a `;` after a statement, which is then read without it.
pub fn semicolon(file: FileId, token: &Token) -> Diagnostic {
    let at = token.span(file);
    foreign_because(at, ";", "a statement ends with its line")
        .help("leave it out")
        .fix(at, "")
}

struct Written<'a, 't> {
    file: FileId,
    text: &'a str,
    own: Vec<&'a Token<'t>>,
}

impl Written<'_, '_> {
    fn word(&self, place: usize) -> Option<&str> {
        let token = self.own.get(place)?;
        (token.kind == TokenKind::Name).then_some(token.text)
    }

    fn has(&self, sign: &str) -> bool {
        self.own.iter().any(|t| t.is(sign))
    }

    fn at(&self, place: usize) -> Span {
        self.own
            .get(place)
            .map_or(Span::new(self.file, 0, 0), |t| t.span(self.file))
    }

    fn opening_word(&self, keyword: Option<Keyword>) -> Option<Diagnostic> {
        let first = self.word(0).filter(|_| keyword.is_none())?;
        let second = self.own.get(1)?;
        let at = self.at(0);
        let names = second.kind == TokenKind::Name && Func::named(first).is_none();
        let because = |why: &str| foreign_because(at, first, why);
        if LOOPS.contains(&first) && !second.is("~") && !second.is("=") {
            let d = because("there are no loops").help(
                "leave the line out; equations for a row of names `state x1..x10` are `dx[i] ~ <x[i], x[i+1]>, i = 1..10 cyclic`",
            );
            return Some(self.line_out(d));
        }
        if FUNCTIONS.contains(&first) && names {
            let d = because("a function is an expression of its arguments");
            return Some(match self.function_line() {
                Some(line) => d
                    .help(format!("write it as `{line}`"))
                    .fix(self.whole(), line),
                None => d.help("write it as `let f(x) = x^2`"),
            });
        }
        if FILES.contains(&first) && (names || second.kind == TokenKind::Text) {
            if second.kind == TokenKind::Text {
                return Some(foreign(at, first, "include"));
            }
            let d = because("what another file says is read by its path")
                .help("write `include \"file.sid\"`, or leave the line out");
            return Some(self.line_out(d));
        }
        let blocks = names && !self.has("~") && !self.has("=") && BLOCKS.contains(&first);
        if blocks || second.is("{") {
            let d = because("there are no blocks")
                .help("a name is given by `system NAME`; leave the line out");
            return Some(self.line_out(d));
        }
        let equals = self.own.iter().position(|t| t.is("="));
        if let Some(equals) = equals.filter(|_| names && NUMBERS.contains(&first) && !self.has("~"))
        {
            let name = self.word(equals - 1)?;
            let line = format!(
                "let {name}{}",
                self.text
                    .get(self.own[equals - 1].end..self.own.last()?.end)?
            );
            let whole = at.to(self.at(self.own.len() - 1));
            return Some(
                because("a number that is known")
                    .help(format!(
                        "write `{line}`; one that is sought is `unknown {name}`"
                    ))
                    .fix(whole, line),
            );
        }
        if names && NUMBERS.contains(&first) && first.starts_with("param") {
            let name = self.word(1)?;
            return Some(because("known, or sought?").help(format!(
                "a constant that is sought is `unknown {name}`, one that is given for each run `param {name}`"
            )).fix(at, "unknown").fix(at, "param"));
        }
        let declares = OPENING.iter().find(|(word, _)| *word == first);
        let (_, ours) = declares.filter(|_| names && !self.has("~") && equals.is_none())?;
        Some(foreign(at, first, ours))
    }

    /// `if x > 0 then … else …`, `x > 0 ? … : …`
    fn branch(&self, keyword: Option<Keyword>) -> Option<Diagnostic> {
        if !matches!(keyword, None | Some(Keyword::Let)) {
            return None;
        }
        let relates = |t: &&Token| t.is("~") || t.is("=");
        // A state may be called `when`.
        let opens = self.word(0).is_some_and(|w| BRANCHES.contains(&w))
            && !self.own.get(1).is_some_and(relates);
        let chooses = |place: &usize| {
            let word = self.word(*place);
            let called = self.own.get(place + 1).is_some_and(|t| t.is("("));
            word == Some("if") || called && word.is_some_and(|w| CHOICES.contains(&w))
        };
        let place = match opens {
            true => 0,
            false => (1..self.own.len()).find(chooses)?,
        };
        let because = "laws that change are sums of pieces";
        let pieces = "`step(x)` is 1 for x > 0 and 0 below: `step(x)*x + step(-x)*x^2`; `min` and `max` limit";
        let d = foreign_because(self.at(place), self.word(place)?, because).help(pieces);
        let ours = self.pieces(place);
        Some(ours.into_iter().fold(d, |d, (at, ours)| d.fix(at, ours)))
    }

    /// `if x > 0 then a else b`: `step(x)*a + step(-x)*b`, with its place.
    fn pieces(&self, place: usize) -> Option<(Span, String)> {
        let find = |words: &[&str]| {
            (place..self.own.len())
                .find(|i| self.own.get(*i).is_some_and(|t| words.contains(&t.text)))
        };
        let (then, other) = (find(&["then"])?, find(&["else"])?);
        let relation = find(&["<", "<=", ">", ">="]).filter(|r| *r < then)?;
        let (left, right) = (
            self.bracketed(place + 1, relation)?,
            self.bracketed(relation + 1, then)?,
        );
        let (left, right) = match self.own.get(relation)?.text {
            "<" | "<=" => (right, left),
            _ => (left, right),
        };
        let (above, below) = match (left.as_str(), right.as_str()) {
            (x, "0") => (x.to_string(), format!("-{x}")),
            ("0", x) => (format!("-{x}"), x.to_string()),
            (x, y) => (format!("{x} - {y}"), format!("{y} - {x}")),
        };
        let a = self.bracketed(then + 1, other)?;
        let b = self.bracketed(other + 1, self.own.len())?;
        let at = self.at(place).to(self.whole());
        let at = Span::new(at.file, self.at(place).start, at.end);
        Some((at, format!("step({above})*{a} + step({below})*{b}")))
    }

    /// The text of the tokens `from..to`, in parentheses if there are several.
    fn bracketed(&self, from: usize, to: usize) -> Option<String> {
        let text = self.between(from, to)?;
        Some(match to - from {
            1 => text.to_string(),
            _ => format!("({text})"),
        })
    }

    fn between(&self, from: usize, to: usize) -> Option<&str> {
        let (first, last) = (self.own.get(from)?, self.own.get(to.checked_sub(1)?)?);
        self.text.get(first.start..last.end)
    }

    fn whole(&self) -> Span {
        self.at(0).to(self.at(self.own.len().saturating_sub(1)))
    }

    /// Adds a fix that removes the line, unless it opens a block.
    fn line_out(&self, d: Diagnostic) -> Diagnostic {
        match self.has("{") {
            true => d,
            false => d.edit(Edit::RemoveLine(self.whole())),
        }
    }

    /// `def f(x): return x^2` as `let f(x) = x^2`.
    fn function_line(&self) -> Option<String> {
        let open = 2;
        self.own.get(open).filter(|t| t.is("("))?;
        let close = self.own.iter().position(|t| t.is(")"))?;
        let head = self.between(1, close + 1)?;
        let opening = [":", "=", "->", "=>", "{", "return"];
        let closing = ["}", ";", "end"];
        let begins = |i: &usize| !self.own.get(*i).is_some_and(|t| opening.contains(&t.text));
        let body = (close + 1..self.own.len()).find(begins);
        let mut end = self.own.len();
        while end > 0
            && self
                .own
                .get(end - 1)
                .is_some_and(|t| closing.contains(&t.text))
        {
            end -= 1;
        }
        let written = body.filter(|b| *b < end).and_then(|b| self.between(b, end));
        let first = self.word(open + 1)?;
        Some(match written {
            Some(body) => format!("let {head} = {body}"),
            None => format!("let {head} = {first}^2"),
        })
    }

    /// `state x and y`
    fn conjunction(&self, keyword: Option<Keyword>) -> Option<Diagnostic> {
        let names = matches!(
            keyword,
            Some(Keyword::State | Keyword::Input | Keyword::Output | Keyword::Param)
        );
        let place = self
            .own
            .iter()
            .position(|t| t.text == "and")
            .filter(|place| names && *place > 1)?;
        let at = Span::new(self.file, self.own[place - 1].end, self.own[place].end);
        Some(
            foreign_because(self.at(place), "and", "items of a list stand behind commas")
                .help(format!(
                    "write `{}, {}`",
                    self.word(place - 1)?,
                    self.word(place + 1)?
                ))
                .fix(at, ","),
        )
    }
}
