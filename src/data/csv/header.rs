//! The first line of a table: what separates its cells, and the names of the columns.
//!
//! In: the lines of a text, from the first on. Out: a [`Header`], or why there is none.

use std::collections::BTreeMap;

use super::cells::{self, Cell, Fault};
use super::lines::{Line, Lines};
use super::{EXCERPT, Limits, SHOWN, excerpt, refusals, slice};
use crate::lang::diagnostic::Diagnostic;
use crate::lang::source::{Sources, Span};

pub(super) struct Header<'a> {
    pub line: Line,
    pub text: &'a str,
    pub separator: u8,
    /// Trimmed, in file order; some may be empty.
    pub names: Vec<String>,
}

/// Takes the header off the lines.
pub(super) fn read<'a>(
    name: &str,
    lines: &mut Lines<'a>,
    limits: &Limits,
    sources: &mut Sources,
) -> Result<Header<'a>, Vec<Diagnostic>> {
    let Some((line, text)) = lines.next() else {
        return Err(vec![refusals::empty_file(name)]);
    };
    let mut place = |range| excerpt(name, sources, line.number, text, range);
    if is_json(text) {
        return Err(vec![refusals::json(place((0, text.len())))]);
    }
    let comment = lines.comment();
    let separator = separator(text, lines.clone().next().map(|(_, l)| l));
    let cells = cells::count(text, separator) + 1;
    if cells > limits.columns {
        let d = refusals::too_many_columns(name, cells, limits.columns);
        return Err(vec![d]);
    }
    let mut ranges = Vec::new();
    if let Err(at) = cells::split(text, separator, &mut ranges) {
        return Err(vec![refusals::open_quote(place((at, text.len())))]);
    }
    let names = ranges.iter().map(|r| slice(text, *r).replace("\"\"", "\""));
    let names: Vec<String> = names.collect();
    if are_numbers(&names) {
        let span = place((0, text.len()));
        let comment = comment.map(|c: &str| c.trim_start_matches(['#', ' ']).to_string());
        return Err(vec![refusals::no_header(span, names.len(), comment)]);
    }
    let repeated = repeated(&names).into_iter().take(SHOWN);
    let found = repeated.filter_map(|(first, again)| {
        let name = names.get(again)?;
        let (start, end) = *ranges.get(again)?;
        let first = place(*ranges.get(first)?);
        // Both in one excerpt, unless the line is too long to show whole.
        let again = match text.len() <= EXCERPT {
            true => Span::new(first.file, start, end),
            false => place((start, end)),
        };
        Some(refusals::duplicate_header(name, first, again))
    });
    let found: Vec<Diagnostic> = found.collect();
    if !found.is_empty() {
        return Err(found);
    }
    Ok(Header {
        line,
        text,
        separator,
        names,
    })
}

/// `{` or `[` where names should be: a document of values, perhaps one of ours.
fn is_json(text: &str) -> bool {
    let opened = text.trim_start().strip_prefix(['{', '[']);
    let inside = opened.map(str::trim_start);
    inside.is_some_and(|t| t.is_empty() || t.starts_with(['"', '{', '[', '}', ']']))
}

/// The separator that cuts the header and the row below it into equally many cells; else the most frequent one.
fn separator(header: &str, row: Option<&str>) -> u8 {
    let found: Vec<(u8, usize)> = [b'\t', b';', b',']
        .into_iter()
        .map(|s| (s, cells::count(header, s)))
        .filter(|(_, n)| *n > 0)
        .collect();
    let agrees = |s: u8, n: usize| row.is_some_and(|r| cells::count(r, s) == n);
    let best = found.iter().find(|&&(s, n)| agrees(s, n));
    let most = || found.iter().rev().max_by_key(|(_, n)| *n);
    best.or_else(most).map_or(b',', |(s, _)| *s)
}

/// A line of numbers names nothing.
fn are_numbers(names: &[String]) -> bool {
    let cells = || names.iter().map(|n| cells::parse(n));
    cells().any(|c| matches!(c, Cell::Number(_))) && !cells().any(|c| c == Cell::Bad(Fault::Text))
}

/// Columns that have a name already seen, behind the first of that name.
fn repeated(names: &[String]) -> Vec<(usize, usize)> {
    let mut seen = BTreeMap::new();
    let mut repeated = Vec::new();
    for (i, name) in names.iter().enumerate().filter(|(_, n)| !n.is_empty()) {
        match seen.get(name) {
            Some(first) => repeated.push((*first, i)),
            None => {
                seen.insert(name, i);
            }
        }
    }
    repeated
}
