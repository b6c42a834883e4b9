//! Explains where a statement does not match its grammar rule.
//!
//! In: the error of the grammar, and the tokens of the statement. Out: one diagnostic. The usual mistakes are named (a missing `*`,
//! `sin 2*theta`, attributes without a colon); the rest reads "expected …, found …". Parses nothing.

use std::collections::BTreeSet;

use pest::error::{Error, ErrorVariant, InputLocation};

use crate::ast::ATTRIBUTES;
use crate::ast::{KEYWORDS, Keyword};
use crate::diagnostic::{Diagnostic, Edit, did_you_mean};
use crate::parse::completion::{MAX_STUB_TOKENS, completed, symmetry_line};
use crate::parse::failure_point::FailurePoint;
use crate::parse::foreign_spellings::punctuation::{PunctuationError, punctuation};
use crate::parse::grammar::Rule;
use crate::parse::lexer::{Token, TokenKind};
use crate::parse::syntax_errors;
use crate::source::{FileId, Span};
use crate::term::Func;

pub fn explain(
    (file, text, start): (FileId, &str, usize),
    tokens: &[Token],
    keyword: Option<Keyword>,
    rule: Rule,
    error: &Error<Rule>,
) -> Box<Diagnostic> {
    let offset = match error.location {
        InputLocation::Pos(p) | InputLocation::Span((p, _)) => start + p,
    };
    let tokens: Vec<&Token> = tokens.iter().filter(|t| t.is_code()).collect();
    let at = tokens
        .iter()
        .position(|t| t.end > offset)
        .unwrap_or(tokens.len());
    let stumble = PunctuationError {
        file,
        text,
        tokens: &tokens,
        at,
    };
    if let Some(error) = punctuation(&stumble, rule) {
        return Box::new(error);
    }
    let stop = FailurePoint {
        file,
        tokens,
        at,
        keyword,
    };
    let named = stop
        .misspelt_keyword(rule)
        .or_else(|| stop.missing_colon(rule))
        .or_else(|| stop.missing_arrow(rule))
        .or_else(|| stop.missing_in(rule))
        .or_else(|| stop.juxtaposed())
        .or_else(|| stop.missing_operator());
    Box::new(named.unwrap_or_else(|| stop.generic(rule, error)))
}

impl<'t> FailurePoint<'_, 't> {
    /// `stat x, y`
    fn misspelt_keyword(&self, rule: Rule) -> Option<Diagnostic> {
        let first = self.get(0).filter(|t| t.kind == TokenKind::Name)?;
        let relates = self.tokens.iter().any(|t| t.is("~") || t.is("="));
        if rule != Rule::equation || relates {
            return None;
        }
        let error = syntax_errors::not_a_statement(first.span(self.file), first.text);
        if first.text == "time" {
            return Some(syntax_errors::time_as_statement(
                error,
                first.span(self.file),
            ));
        }
        Some(
            match did_you_mean(first.text, KEYWORDS.iter().map(|(t, _)| *t)) {
                Some(keyword) => error
                    .help(format!("did you mean `{keyword}`?"))
                    .fix(first.span(self.file), keyword),
                None if self.tokens.len() > MAX_STUB_TOKENS => {
                    error.help("an equation has a `~`: `dx ~ poly(x; 3)`")
                }
                None => error
                    .help("delete the line, or complete it: an equation has a `~`")
                    .edit(Edit::RemoveLine(self.whole())),
            },
        )
    }

    /// `state x order 2`
    fn missing_colon(&self, rule: Rule) -> Option<Diagnostic> {
        if self.tokens.iter().any(|t| t.is(":")) {
            return None;
        }
        let opens = |t: &Token| match rule {
            Rule::declare => ATTRIBUTES.contains(&t.text),
            // `coef(dx, x) per run`
            Rule::per_run | Rule::constrain => t.text == "per",
            _ => false,
        };
        let key = [self.at.checked_sub(1)?, self.at]
            .into_iter()
            .find(|&i| self.get(i).is_some_and(opens))?;
        let word = self.get(key)?;
        let (names, rest) = (self.phrase(0, key), self.phrase(key, self.tokens.len()));
        Some(
            syntax_errors::unexpected(word.span(self.file), word.text, "`:` before the attributes")
                .help(format!("write `{names} : {rest}`"))
                .fix(word.span(self.file).before(), ": "),
        )
    }

    /// `symmetry x = -x`
    fn missing_arrow(&self, rule: Rule) -> Option<Diagnostic> {
        if rule != Rule::symmetry || self.tokens.iter().any(|t| t.is("->")) {
            return None;
        }
        let d = match self.found() {
            Some(found) => syntax_errors::unexpected(found.span(self.file), found.text, "`->`"),
            None => syntax_errors::ends_early(self.before(1)?.span(self.file), "`->`"),
        };
        Some(match symmetry_line(self) {
            Some(line) => d.help(format!("write `{line}`")).fix(self.whole(), line),
            None => d.help(format!("the form is `{}`", example(rule))),
        })
    }

    /// `delay 0..0.2`, `unknown k 0.1..10`
    fn missing_in(&self, rule: Rule) -> Option<Diagnostic> {
        let has = |text: &str| self.tokens.iter().any(|t| t.is(text));
        if !has("..") || has("in") {
            return None;
        }
        let from = match rule {
            Rule::declare => {
                let attribute =
                    |i: &usize| self.get(*i).is_some_and(|t| ATTRIBUTES.contains(&t.text));
                (0..self.at).rev().find(attribute)? + 1
            }
            Rule::unknown => self.at,
            _ => return None,
        };
        let (range, last) = (self.get(from)?, self.tokens.len());
        let (before, after) = (self.phrase(0, from), self.phrase(from, last));
        Some(
            syntax_errors::unexpected(range.span(self.file), range.text, "`in` before the range")
                .help(format!("write `{before} in {after}`"))
                .fix(range.span(self.file).before(), "in "),
        )
    }

    /// `sin 2*theta`, `sin "Angle"`, `exp sin x`
    fn juxtaposed(&self) -> Option<Diagnostic> {
        let (found, last) = (self.found()?, self.before(1)?);
        if is_function(last) && matches!(found.kind, TokenKind::Number | TokenKind::Text) {
            let end = self.product_end(self.at);
            let (whole, to) = (self.text(self.at, end), self.get(end)?);
            let name = last.text;
            let mut readings = vec![format!("{name}({whole})")];
            if end > self.at {
                let rest = self.text(self.at + 1, end);
                readings.insert(0, format!("{name}({}){rest}", found.text));
            }
            return Some(syntax_errors::ambiguous_argument(
                self.span(last, to),
                name,
                &readings,
            ));
        }
        let outer = self.before(2).filter(|t| is_function(t))?;
        if is_function(last) && found.kind == TokenKind::Name {
            let (f, g, x) = (outer.text, last.text, found.text);
            let readings = [format!("{f}({g}({x}))"), format!("{f}(…) * {g}({x})")];
            return Some(syntax_errors::ambiguous_argument(
                self.span(outer, found),
                f,
                &readings,
            ));
        }
        None
    }

    /// The last token of the product that begins at `from`.
    fn product_end(&self, from: usize) -> usize {
        let mut end = from;
        while let (Some(op), Some(next)) = (self.get(end + 1), self.get(end + 2)) {
            let joins = ["*", "/", "^"].contains(&op.text);
            if !joins || !matches!(next.kind, TokenKind::Name | TokenKind::Number) {
                break;
            }
            end += 2;
        }
        end
    }

    /// `2 x`, `(a)(b)`, a comma forgotten at the end of a line
    fn missing_operator(&self) -> Option<Diagnostic> {
        let (found, last) = (self.found()?, self.before(1)?);
        let relation = self.keyword.is_some_and(Keyword::compares);
        let ends = last.is_operand() || last.is(")") || last.is("]") || last.is(">") && !relation;
        let begins = found.is_operand() || found.is("(") || found.is("<") && !relation;
        let opens = self.keyword.is_some() && self.at == 1;
        if !ends || !begins || opens {
            return None;
        }
        let words = self.tokens.get(1..).unwrap_or(&[]);
        if self.keyword == Some(Keyword::System)
            && words
                .iter()
                .all(|t| t.is_operand() && t.kind != TokenKind::Text)
        {
            let (first, end) = (words.first()?, words.last()?);
            let all = self.phrase(1, self.tokens.len());
            return Some(syntax_errors::several_words(self.span(first, end), &all));
        }
        let applied = self
            .before(2)
            .filter(|t| is_function(t) && last.kind == TokenKind::Name);
        let first = match applied {
            Some(f) => format!("{}({})", f.text, last.text),
            None if last.kind == TokenKind::Symbol => "…".to_string() + last.text,
            None => last.text.to_string(),
        };
        let second = match found.kind {
            TokenKind::Symbol => format!("{}…", found.text),
            _ => found.text.to_string(),
        };
        Some(syntax_errors::missing_operator(
            (last.span(self.file), found.span(self.file)),
            (&first, &second),
            self.is_listed(),
        ))
    }

    /// Whether the place is between brackets that hold a list.
    fn is_listed(&self) -> bool {
        let mut open: Vec<bool> = Vec::new();
        for (i, token) in self.tokens.iter().enumerate().take(self.at) {
            let called = i.checked_sub(1).and_then(|i| self.get(i));
            match token.text {
                "<" => open.push(true),
                "(" => open.push(called.is_some_and(|t| t.kind == TokenKind::Name)),
                ">" | ")" => drop(open.pop()),
                _ => {}
            }
        }
        open.last() == Some(&true)
    }

    fn generic(&self, rule: Rule, error: &Error<Rule>) -> Diagnostic {
        let expected = expected_words(error);
        let diagnostic = match (self.found(), self.before(1)) {
            (Some(found), _) => {
                syntax_errors::unexpected(found.span(self.file), found.text, &expected)
            }
            (None, Some(last)) => syntax_errors::ends_early(last.span(self.file), &expected),
            (None, None) => syntax_errors::ends_early(Span::new(self.file, 0, 0), &expected),
        };
        completed(self, rule, diagnostic, example(rule))
    }
}

fn is_function(token: &Token) -> bool {
    token.kind == TokenKind::Name && Func::named(token.text).is_some()
}

fn example(rule: Rule) -> &'static str {
    match rule {
        Rule::version => "sidc 1",
        Rule::system => "system pendulum",
        Rule::declare => "state x, y : order 2, noise 0.01",
        Rule::unknown => "unknown k in 0.1..10, unit \"1/s\"",
        Rule::constant => "let g = 9.81",
        Rule::function => "let sat(v) = tanh(v/vs)",
        Rule::constrain => "constrain coef(dx, x) < 0",
        Rule::per_run => "coef(dx, x) : per run",
        Rule::symmetry => "symmetry x, y -> -(x, y)",
        Rule::reset => "when y < 0 : dy -> -0.8*dy",
        Rule::limit => "limit degree 4",
        Rule::prefer => "prefer degree",
        Rule::step => "step 0.01",
        Rule::source => "x = \"Column\" * 1e-3",
        Rule::constrain_family => "constrain coef(dx[i], x[i]) < 0, i = 1..10",
        Rule::per_run_family => "coef(dx[i], x[i]) : per run, i = 1..10",
        Rule::family => "dx[i] ~ <x[i-1], x[i]>, i = 1..10",
        Rule::equation => "dx ~ poly(x, y; 3)",
        _ => "",
    }
}

fn expected_words(error: &Error<Rule>) -> String {
    let ErrorVariant::ParsingError { positives, .. } = &error.variant else {
        return "something else".to_string();
    };
    let mut seen = BTreeSet::new();
    let words = positives.iter().filter_map(|r| word(*r));
    let mut words: Vec<&str> = words.filter(|w| seen.insert(*w)).collect();
    if words.contains(&"an expression") {
        words.retain(|w| !["a name", "a number"].contains(w));
    }
    match words.as_slice() {
        [] => "an expression".to_string(),
        [one] => (*one).to_string(),
        [many @ .., last] => format!("{} or {last}", many.join(", ")),
    }
}

fn word(rule: Rule) -> Option<&'static str> {
    Some(match rule {
        Rule::word | Rule::name => "a name",
        Rule::names => "names",
        Rule::image | Rule::flipped => "`-(…)`",
        Rule::number => "a number",
        Rule::text
        | Rule::list
        | Rule::group
        | Rule::reference
        | Rule::expr
        | Rule::item
        | Rule::items
        | Rule::negate => "an expression",
        Rule::add | Rule::subtract | Rule::multiply | Rule::divide => "an operator",
        Rule::exponent => "an exponent",
        Rule::relates => "`~` or `=`",
        Rule::relation => "a relation",
        Rule::attribute => "an attribute",
        Rule::numbers => "a number",
        Rule::EOI => "the end of the statement",
        _ => return None,
    })
}
