//! Statements: `const g = 9.81`, `for i in 1:3`, `if x > 0`, `include "a.sid"`, `def f(x)`, `x and y`, `;` at the end of a line.
//!
//! In: the tokens of a statement. Out: the error that says how it is written here, in place of all that the grammar would say.

use super::{foreign, foreign_because};
use crate::ast::Keyword;
use crate::diagnostic::Diagnostic;
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

/// Words that open statements, and the keyword here.
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
const FILES: [&str; 5] = ["include", "import", "using", "from", "library"];
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

/// `;` behind a statement: the error, and the statement goes on without it.
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
            return Some(because("there are no loops").help(
                "equations for a row of names `state x1..x10` are `dx[i] ~ <x[i], x[i+1]>, i = 1..10 cyclic`",
            ));
        }
        if FUNCTIONS.contains(&first) && names {
            return Some(
                because("a function is an expression of its arguments")
                    .help("write it as `let f(x) = x^2`"),
            );
        }
        if FILES.contains(&first) && (names || second.kind == TokenKind::Text) {
            return Some(
                because("a model is one file").help("copy what it needs from the other file"),
            );
        }
        let blocks = names && !self.has("~") && !self.has("=") && BLOCKS.contains(&first);
        if blocks || second.is("{") {
            return Some(
                because("there are no blocks")
                    .help("a name is given by `system NAME`; leave the line out"),
            );
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
        Some(foreign_because(self.at(place), self.word(place)?, because).help(pieces))
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
