//! Suggests how to complete a statement that does not match its rule.
//!
//! In: where the statement fails, and its error. Out: the error with a help and, if possible, a fix. Names come from the statement itself.

use std::collections::BTreeSet;

use crate::diagnostic::{Diagnostic, Edit};
use crate::parse::failure_point::FailurePoint;
use crate::parse::grammar::Rule;
use crate::parse::token::TokenKind;
use crate::source::Span;

/// Largest number of tokens in a statement that can be deleted without loss.
pub const MAX_STUB_TOKENS: usize = 4;

pub fn completed(s: &FailurePoint, rule: Rule, d: Diagnostic, example: &str) -> Diagnostic {
    let ours = dangling_operator(s)
        .or_else(|| doubled_relation(s))
        .or_else(|| of_rule(s, rule));
    match ours {
        Some((help, changes)) => {
            let d = d.help(help);
            changes.into_iter().fold(d, |d, (at, new)| d.fix(at, new))
        }
        None if example.is_empty() => d,
        None if s.tokens.len() <= MAX_STUB_TOKENS => d
            .help(format!(
                "the form is `{example}`: complete it, or delete the line"
            ))
            .edit(Edit::RemoveLine(s.whole())),
        None => d.help(format!("the form is `{example}`")),
    }
}

/// A help, and the changes that follow it.
type Completion = (String, Vec<(Span, String)>);

/// `dx ~ poly(x; 2) +`
fn dangling_operator(s: &FailurePoint) -> Option<Completion> {
    let (None, Some(last), Some(before)) = (s.found(), s.before(1), s.before(2)) else {
        return None;
    };
    if !["+", "-", "*", "/", "^"].contains(&last.text) {
        return None;
    }
    let help = format!("write what follows the `{}`, or leave it out", last.text);
    let at = Span::new(s.file, before.end, last.end);
    Some((help, vec![(at, String::new())]))
}

/// `dx ~ ~ x`
fn doubled_relation(s: &FailurePoint) -> Option<Completion> {
    let (found, before) = (s.found()?, s.before(1)?);
    let relates = |text: &str| ["~", "="].contains(&text);
    if !relates(found.text) || !relates(before.text) {
        return None;
    }
    let help = format!("write one `{}`", before.text);
    let at = Span::new(s.file, before.end, found.end);
    Some((help, vec![(at, String::new())]))
}

fn of_rule(s: &FailurePoint, rule: Rule) -> Option<Completion> {
    match rule {
        Rule::symmetry => {
            let line = symmetry_line(s)?;
            Some((format!("write `{line}`"), vec![(s.whole(), line)]))
        }
        Rule::constrain => constrained(s),
        Rule::equation => sought(s),
        Rule::declare => equation_below(s),
        Rule::function => named_argument(s),
        Rule::system => {
            let found = s.found().filter(|t| t.kind == TokenKind::Number)?;
            let ours = format!("s{}", found.text);
            let help = format!("a name begins with a letter: `system {ours}`");
            Some((help, vec![(found.span(s.file), ours)]))
        }
        Rule::limit => {
            let found = s.found().filter(|t| t.kind == TokenKind::Number)?;
            let ours = format!("degree {}", found.text);
            let help = format!("write `limit {ours}`");
            Some((help, vec![(found.span(s.file), ours)]))
        }
        Rule::prefer if s.found().is_none() => {
            let end = s.whole().after();
            let words = [" degree", " plain"].map(|w| (end, w.to_string()));
            Some((
                "write `prefer degree` or `prefer plain`".into(),
                words.into(),
            ))
        }
        _ => None,
    }
}

/// A symmetry rewritten with the names in it: `symmetry x, y -> -(x, y)`.
pub fn symmetry_line(s: &FailurePoint) -> Option<String> {
    let words = s.tokens.get(1..)?;
    let signs = [",", "-", "->", "=", "(", ")"];
    let (mut names, mut seen) = (Vec::new(), BTreeSet::new());
    for token in words {
        match token.kind {
            TokenKind::Name if !seen.insert(token.text) => {}
            TokenKind::Name => names.push(token.text),
            _ if signs.contains(&token.text) => {}
            _ => return None,
        }
    }
    let names = names.join(", ");
    (!names.is_empty()).then(|| format!("symmetry {names} -> -({names})"))
}

/// `constrain coef(dx, x)`
fn constrained(s: &FailurePoint) -> Option<Completion> {
    let related = s
        .tokens
        .iter()
        .any(|t| ["<", ">", "<=", ">=", "="].contains(&t.text));
    if s.found().is_some() || related || !s.before(1)?.is(")") {
        return None;
    }
    let line = s.phrase(0, s.tokens.len());
    let help = format!("write `{line} < 0`");
    Some((help, vec![(s.whole().after(), " < 0".to_string())]))
}

/// `dx ~`
fn sought(s: &FailurePoint) -> Option<Completion> {
    let target = s.before(2).filter(|t| t.kind == TokenKind::Name)?;
    if s.found().is_some() || !s.before(1)?.is("~") {
        return None;
    }
    let ours = format!("poly({}; 3)", base_name(target.text));
    let help = format!("write what may explain it: `{} {ours}`", s.phrase(0, s.at));
    Some((help, vec![(s.whole().after(), format!(" {ours}"))]))
}

/// `state x` and a line `~ poly(x; 2)` that continues it.
fn equation_below(s: &FailurePoint) -> Option<Completion> {
    let found = s.found().filter(|t| t.is("~") || t.is("="))?;
    let called = |i: usize| s.get(i + 1).is_some_and(|t| t.is("("));
    let right = (s.at + 1)..s.tokens.len();
    let mut names =
        right.filter(|i| s.get(*i).is_some_and(|t| t.kind == TokenKind::Name) && !called(*i));
    let target = format!("d{}", base_name(s.get(names.next()?)?.text));
    let help = format!(
        "an equation begins with its target: `{target} {} …`",
        found.text
    );
    Some((
        help,
        vec![(found.span(s.file).before(), format!("{target} "))],
    ))
}

/// `let f() = 3`, `let f(2) = 3`
fn named_argument(s: &FailurePoint) -> Option<Completion> {
    let (found, before) = (s.found()?, s.before(1)?);
    let name = s.get(1)?.text;
    let (at, ours, form) = match (found.text, found.kind) {
        (")", _) if before.is("(") => (s.span(before, found), "", format!("let {name} = …")),
        (_, TokenKind::Number) => (found.span(s.file), "a", format!("let {name}(a) = …")),
        _ => return None,
    };
    Some((
        format!("the form is `{form}`"),
        vec![(at, ours.to_string())],
    ))
}

/// The `x` of `ddx`, `x'` or `x`.
fn base_name(name: &str) -> &str {
    let name = name.trim_end_matches('\'');
    let base = name.trim_start_matches('d');
    if base.is_empty() { name } else { base }
}
