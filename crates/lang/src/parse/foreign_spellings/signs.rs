//! Signs: `**`, `//`, `/* */`, `.*`, `:=`, `<-`, `'text'`, `|x|`, `\theta`, `np.`, `[m]`, `in [0, 1]`.
//!
//! In: the text from a sign on, and the tokens before it on its line. Out: how far the sign reaches, and its error.

use super::{foreign, foreign_because};
use crate::ast::KEYWORDS;
use crate::diagnostic::Diagnostic;
use crate::parse::token::{Token, TokenKind};
use crate::source::{FileId, Span};
use crate::thresholds::MESSAGES;

/// A sign of another language.
pub struct ForeignSign {
    /// Bytes that it takes.
    pub len: usize,
    /// Whether it is a comment, which leaves its statement intact.
    pub comment: bool,
    pub error: Diagnostic,
}

impl ForeignSign {
    /// A sign that makes its statement unreadable.
    fn new(len: usize, error: Diagnostic) -> ForeignSign {
        ForeignSign {
            len,
            comment: false,
            error,
        }
    }
}

/// Signs that have one spelling here.
const PAIRS: [(&str, &str); 5] = [
    ("**", "^"),
    (".^", "^"),
    (".*", "*"),
    ("./", "/"),
    (":=", "="),
];

/// Modules that functions come from in other languages.
const MODULES: [&str; 14] = [
    "np", "numpy", "math", "Math", "jnp", "jax", "torch", "tf", "sp", "sympy", "sym", "ca",
    "casadi", "std",
];

/// The place of a sign: its file, its first byte, the text from there on, and the tokens before it on its line.
pub struct Place<'a, 't> {
    pub file: FileId,
    pub start: usize,
    pub rest: &'t str,
    pub line: &'a [Token<'t>],
    /// Whether a `*/` follows.
    pub comment_ends: bool,
}

impl<'t> Place<'_, 't> {
    fn span(&self, len: usize) -> Span {
        Span::new(self.file, self.start, self.start + len)
    }

    /// A sign of `len` bytes that is written `ours` in this language.
    fn spelt(&self, len: usize, ours: &str) -> ForeignSign {
        ForeignSign::new(len, foreign(self.span(len), &self.rest[..len], ours))
    }

    fn last(&self) -> Option<&Token<'t>> {
        self.line.last()
    }

    /// The text after the first character up to a sign on the same line; `None` if it is long.
    fn closed_by(&self, sign: char) -> Option<&'t str> {
        let inner = self.rest.get(1..)?;
        let mut near = inner.char_indices().take(MESSAGES.index);
        let end = near.find(|(_, c)| *c == sign || *c == '\n')?;
        (end.1 == sign).then(|| &inner[..end.0])
    }

    /// Whether only names and commas come before on the line.
    fn follows_names(&self) -> bool {
        let plain = |t: &Token| t.kind == TokenKind::Name || t.is(",");
        !self.line.is_empty() && self.line.len() < MESSAGES.index && self.line.iter().all(plain)
    }
}

/// The sign of another language that begins at a place.
pub fn sign(place: &Place) -> Option<ForeignSign> {
    let rest = place.rest;
    if let Some((theirs, ours)) = PAIRS.iter().find(|(theirs, _)| rest.starts_with(theirs)) {
        return Some(place.spelt(theirs.len(), ours));
    }
    match rest.chars().next()? {
        '/' if rest.starts_with("//") => Some(line_comment(place)),
        '/' if rest.starts_with("/*") => Some(block_comment(place)),
        '<' if rest.starts_with("<-") && place.follows_names() => Some(place.spelt(2, "~")),
        '\'' => {
            let inner = place.closed_by('\'')?;
            Some(place.spelt(inner.len() + 2, &format!("\"{inner}\"")))
        }
        '|' => {
            let inner = place.closed_by('|').filter(|t| !t.trim().is_empty())?;
            Some(place.spelt(inner.len() + 2, &format!("abs({inner})")))
        }
        '\\' => latex_name(place),
        '.' => module(place),
        '[' => bracket(place),
        _ => None,
    }
}

fn line_comment(place: &Place) -> ForeignSign {
    let len = place.rest.find('\n').unwrap_or(place.rest.len());
    let marks = place.rest.len() - place.rest.trim_start_matches('/').len();
    ForeignSign {
        len,
        comment: true,
        error: foreign(place.span(marks), "//", "#"),
    }
}

/// `/* … */`, which may span lines; one that is never closed ends with its line.
fn block_comment(place: &Place) -> ForeignSign {
    let rest = place.rest;
    let line = rest.find('\n').unwrap_or(rest.len());
    let inner = rest.get(2..).filter(|_| place.comment_ends);
    let len = inner.and_then(|r| r.find("*/")).map_or(line, |at| at + 4);
    let inner = rest[..len].trim_start_matches("/*").trim_end_matches("*/");
    let lines = inner
        .lines()
        .map(|l| l.trim().trim_start_matches('*').trim_start());
    let lines: Vec<String> = lines
        .filter(|l| !l.is_empty())
        .map(|l| format!("# {l}"))
        .collect();
    let at = place.span(len);
    let code_follows = rest
        .get(len..)
        .and_then(|r| r.lines().next())
        .is_some_and(|r| !r.trim().is_empty());
    let end = if code_follows { "\n" } else { "" };
    ForeignSign {
        len,
        comment: true,
        error: foreign_because(
            Span::new(at.file, at.start, at.start + 2),
            "/*",
            "a comment begins with `#` and ends with its line",
        )
        .help("begin each line of it with `#`")
        .fix(at, lines.join("\n") + end),
    }
}

/// `\theta`
fn latex_name(place: &Place) -> Option<ForeignSign> {
    let name = place.rest.get(1..)?;
    let end = name
        .find(|c: char| !c.is_ascii_alphabetic())
        .unwrap_or(name.len());
    let name = name.get(..end).filter(|n| !n.is_empty())?;
    Some(place.spelt(1 + name.len(), name))
}

/// `np.sin`: the name before belongs to the sign.
fn module(place: &Place) -> Option<ForeignSign> {
    let before = place
        .last()
        .filter(|t| t.end == place.start && MODULES.contains(&t.text))?;
    let name = place.rest.get(1..)?.chars().next()?;
    let at = Span::new(place.file, before.start, place.start + 1);
    let theirs = format!("{}.", before.text);
    name.is_alphabetic().then(|| {
        let error = foreign_because(at, &theirs, "functions stand for themselves")
            .help(format!("leave out `{theirs}`"))
            .fix(at, "");
        ForeignSign::new(1, error)
    })
}

/// `[x, y]`, `x[k-1]`, `state x [m]` and `in [0, 1]`.
fn bracket(place: &Place) -> Option<ForeignSign> {
    let last = place.last()?;
    // The bound keeps the lexer linear.
    if place.line.len() > MESSAGES.index {
        return None;
    }
    let inside = place.closed_by(']').filter(|t| !t.contains('['))?;
    let (inner, len) = (inside.trim(), inside.len() + 2);
    if let Some((at, ours)) = sample(place, last, inner, len) {
        let theirs = format!("{}{}", last.text, &place.rest[..len]);
        return Some(ForeignSign::new(len, foreign(at, &theirs, &ours)));
    }
    if last.kind == TokenKind::Symbol && inner.contains(',') {
        return Some(match last.is("(") {
            true => place.spelt(len, inner),
            false => place.spelt(len, &format!("<{inner}>")),
        });
    }
    if last.text == "in" {
        let (from, to) = inner
            .split_once([',', ':'])
            .or_else(|| inner.split_once(".."))?;
        let ours = format!("{} .. {}", from.trim(), to.trim_start_matches('.').trim());
        return Some(place.spelt(len, &ours));
    }
    range_of_names(place, last, inner, len).or_else(|| unit(place, last, inner, len))
}

/// `state x[1..10]`
fn range_of_names(place: &Place, name: &Token, inner: &str, len: usize) -> Option<ForeignSign> {
    let digits = |t: &str| !t.is_empty() && t.chars().all(|c| c.is_ascii_digit());
    let (from, to) = inner.split_once("..").or_else(|| inner.split_once(':'))?;
    let (from, to) = (from.trim(), to.trim());
    if name.kind != TokenKind::Name || name.end != place.start || !digits(from) || !digits(to) {
        return None;
    }
    let theirs = format!("{}{}", name.text, &place.rest[..len]);
    let ours = format!("{0}{from}..{0}{to}", name.text);
    let at = Span::new(place.file, name.start, place.start + len);
    Some(ForeignSign::new(len, foreign(at, &theirs, &ours)))
}

/// `state x [m]`, `state y : order 2 [rad]`
fn unit(place: &Place, last: &Token, inner: &str, len: usize) -> Option<ForeignSign> {
    let first = place.line.first()?;
    let declares = ["state", "input", "output", "param", "unknown"].contains(&first.text);
    let is_unit = !inner.is_empty()
        && !inner.starts_with(|c: char| c.is_ascii_digit() && c != '1')
        && !inner.contains([',', '"', '=']);
    // `x[3]` is an index.
    let apart = last.end < place.start || inner.contains('/');
    if !declares || !is_unit || !apart || KEYWORDS.iter().any(|(word, _)| *word == last.text) {
        return None;
    }
    let more = place.line.iter().any(|t| t.is(":")) || first.text == "unknown";
    let attribute = format!("{} unit \"{inner}\"", if more { "," } else { ":" });
    let space = if more { "" } else { " " };
    let whole = Span::new(place.file, last.end, place.start + len);
    let (at, theirs) = (place.span(len), &place.rest[..len]);
    let d =
        foreign_because(at, theirs, "a unit is an attribute").help(format!("write `{attribute}`"));
    let after = &place.rest[len..];
    let error = match after.trim_start_matches([' ', '\t']).strip_prefix(':') {
        // `state x [m] : order 2`
        Some(rest) => {
            let end = place.start + place.rest.len() - rest.len();
            let whole = Span::new(place.file, last.end, end);
            d.fix(whole, format!(" {attribute},"))
        }
        None => d.fix(whole, format!("{space}{attribute}")),
    };
    Some(ForeignSign::new(len, error))
}

/// `x[k]`, `x[k+1]`, `x[n-2]`: the place with the name, and the spelling in this language.
fn sample(place: &Place, name: &Token, inner: &str, len: usize) -> Option<(Span, String)> {
    let beside = name.kind == TokenKind::Name && name.end == place.start;
    let at = Span::new(place.file, name.start, place.start + len);
    let shift = inner
        .strip_prefix(['k', 'n', 't', 'i'])
        .filter(|_| beside)?;
    let shift = shift.replace(' ', "");
    let ours = match shift.strip_prefix('-') {
        None if shift.is_empty() => name.text.to_owned(),
        None if shift == "+1" => format!("next({})", name.text),
        Some(samples) if samples.parse::<u32>().is_ok() => format!("lag({}, {samples})", name.text),
        _ => return None,
    };
    Some((at, ours))
}

/// Whether a character may begin a foreign sign: a quick test that most fail.
pub fn may_begin(c: char) -> bool {
    matches!(c, '*' | '.' | ':' | '/' | '<' | '\'' | '|' | '\\' | '[')
}
