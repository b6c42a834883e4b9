//! Punctuation that the grammar stumbles over: `{x, y}`, `(x, y)` and `x, y` for a list, `degree=3`, `order=2`, `state x = 0`, `;` between
//! statements.
//!
//! In: the tokens of a statement, and the one that was not expected. Out: the error that says how it is written here.

use super::foreign_because;
use crate::ast::ATTRIBUTES;
use crate::diagnostic::Diagnostic;
use crate::parse::grammar::Rule;
use crate::parse::token::{Token, TokenKind};
use crate::source::{FileId, Span};

/// A statement of the file's text, and the place of the token that was not expected.
pub struct PunctuationError<'a, 't> {
    pub file: FileId,
    pub text: &'a str,
    pub tokens: &'a [&'a Token<'t>],
    pub at: usize,
}

/// The error of a token that is punctuation of another language.
pub fn punctuation(s: &PunctuationError, rule: Rule) -> Option<Diagnostic> {
    match s.get(s.at)?.text {
        // `state x : order 2; unit "m"`
        ";" if s
            .get(s.at + 1)
            .is_some_and(|t| ATTRIBUTES.contains(&t.text)) =>
        {
            Some(
                foreign_because(
                    s.span(s.at, s.at),
                    ";",
                    "attributes are separated by commas",
                )
                .help("write a comma")
                .fix(s.span(s.at, s.at), ","),
            )
        }
        ";" if s.open().is_empty() => Some(
            foreign_because(s.span(s.at, s.at), ";", "a statement ends with its line")
                .help("begin a line here")
                .fix(s.span(s.at, s.at), "\n"),
        ),
        "=" => s.equals(rule),
        "{" => s.list(s.at, s.closing("}")?),
        "," => s.comma(rule),
        _ => None,
    }
}

impl<'t> PunctuationError<'_, 't> {
    fn get(&self, place: usize) -> Option<&Token<'t>> {
        self.tokens.get(place).copied()
    }

    fn before(&self, steps: usize) -> Option<&Token<'t>> {
        self.get(self.at.checked_sub(steps)?)
    }

    fn span(&self, from: usize, to: usize) -> Span {
        let place = |i: usize| {
            self.get(i)
                .map_or(Span::new(self.file, 0, 0), |t| t.span(self.file))
        };
        place(from).to(place(to))
    }

    fn written(&self, at: Span) -> &str {
        self.text.get(at.start..at.end).unwrap_or("")
    }

    /// The brackets that are open before the place.
    fn open(&self) -> Vec<usize> {
        let mut open = Vec::new();
        for (place, token) in self.tokens.iter().enumerate().take(self.at) {
            match token.text {
                "(" | "{" | "<" => open.push(place),
                ")" | "}" | ">" => drop(open.pop()),
                _ => (),
            }
        }
        open
    }

    /// The first closing bracket of a kind after the place.
    fn closing(&self, bracket: &str) -> Option<usize> {
        (self.at..self.tokens.len()).find(|i| self.get(*i).is_some_and(|t| t.is(bracket)))
    }

    /// The error of brackets around what is a list in this language.
    fn list(&self, from: usize, to: usize) -> Option<Diagnostic> {
        let at = self.span(from, to);
        let (open, close) = (self.get(from)?, self.get(to)?);
        let inner = self
            .written(Span::new(at.file, open.end, close.start))
            .trim();
        let ours = format!("<{inner}>");
        let theirs = format!("{}…{}", open.text, close.text);
        Some(
            foreign_because(at, &theirs, "a list stands between `<` and `>`")
                .help(format!("write `{ours}`"))
                .fix(at, ours),
        )
    }

    /// A comma outside lists.
    fn comma(&self, rule: Rule) -> Option<Diagnostic> {
        match self.open().last() {
            Some(open) if self.get(*open)?.is("(") => {
                let called = open.checked_sub(1).and_then(|i| self.get(i));
                let called = called.is_some_and(|t| t.kind == TokenKind::Name);
                let close = self.closing(")")?;
                (!called).then(|| self.list(*open, close)).flatten()
            }
            Some(_) => None,
            None if rule == Rule::equation => {
                let relates = |t: &&&Token| t.is("~") || t.is("=");
                let first = 1 + self.tokens.iter().take(self.at).position(|t| relates(&t))?;
                let at = self.span(first, self.tokens.len() - 1);
                let ours = format!("<{}>", self.written(at));
                Some(
                    foreign_because(
                        self.span(self.at, self.at),
                        ",",
                        "a list stands between `<` and `>`",
                    )
                    .help(format!("write `{ours}`"))
                    .fix(at, ours),
                )
            }
            None => None,
        }
    }

    fn equals(&self, rule: Rule) -> Option<Diagnostic> {
        let name = self.before(1).filter(|t| t.kind == TokenKind::Name)?;
        let own = self.span(self.at - 1, self.at);
        let theirs = format!("{}=", name.text);
        if !self.open().is_empty() {
            let sign = self.before(2)?;
            let (at, ours) = match sign.is(",") {
                true => (self.span(self.at - 2, self.at), "; "),
                false => (own, ""),
            };
            return Some(
                foreign_because(own, &theirs, "arguments have no names")
                    .help("numbers stand behind a `;`, as in `poly(x, y; 3)`")
                    .fix(at, ours),
            );
        }
        let keyword = self.get(0)?.text;
        let end = self.span(self.at, self.tokens.len() - 1);
        if rule == Rule::declare && ATTRIBUTES.contains(&name.text) {
            let between = Span::new(self.file, name.end, self.get(self.at)?.end);
            let value = self.get(self.at + 1).map_or("", |t| t.text);
            return Some(
                foreign_because(
                    own,
                    &theirs,
                    "an attribute and its value stand side by side",
                )
                .help(format!("write `{} {value}`", name.text))
                .fix(
                    between,
                    if self.get(self.at + 1)?.start > between.end {
                        ""
                    } else {
                        " "
                    },
                ),
            );
        }
        let value = self.written(end);
        let line = format!("let {} {value}", name.text);
        let whole = self.span(0, self.tokens.len() - 1);
        match (rule, keyword) {
            (Rule::declare, "state") => Some(
                foreign_because(end, value, "no value is declared")
                    .help("leave it out: where a state starts is found from the data")
                    .fix(Span::new(self.file, name.end, end.end), ""),
            ),
            (Rule::declare, _) => Some(
                foreign_because(end, value, "no value is declared")
                    .help(format!("a number that is known is `{line}`"))
                    .fix(whole, line),
            ),
            (Rule::unknown, _) => Some(
                foreign_because(end, value, "what is sought has a range, and no value")
                    .help(format!(
                        "write `unknown {} in 0.1..10`, with the range where it may be",
                        name.text
                    ))
                    .fix(Span::new(self.file, name.end, end.end), ""),
            ),
            _ => None,
        }
    }
}
