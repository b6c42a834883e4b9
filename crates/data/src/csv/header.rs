//! The first line of a table: the separator of its cells, and the names of the columns.
//!
//! In: the lines of a text, from the first on. Out: a [`Header`], or why there is none.

use std::collections::BTreeMap;

use super::cell::{self, Cell, Fault};
use super::excerpt::{MAX_EXCERPT_BYTES, excerpt, slice};
use super::limits::Limits;
use super::limits::MAX_FINDINGS_SHOWN;
use super::lines::{Line, Lines};
use super::read_errors;
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::source::{Sources, Span};

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
        return Err(vec![read_errors::empty_file(name)]);
    };
    let mut place = |range| excerpt(name, sources, line.number, text, range);
    if is_json(text) {
        return Err(vec![read_errors::json(place((0, text.len())))]);
    }
    let comment = lines.comment();
    let separator = separator(text, lines.clone().next().map(|(_, l)| l));
    let cells = cell::count(text, separator) + 1;
    if cells > limits.columns {
        let d = read_errors::too_many_columns(name, cells, limits.columns);
        return Err(vec![d]);
    }
    let mut ranges = Vec::new();
    if let Err(at) = cell::split(text, separator, &mut ranges) {
        return Err(vec![read_errors::open_quote(place((at, text.len())))]);
    }
    let names = ranges.iter().map(|r| slice(text, *r).replace("\"\"", "\""));
    let names: Vec<String> = names.collect();
    if are_numbers(&names) {
        let span = place((0, text.len()));
        let comment = comment.map(|c: &str| c.trim_start_matches(['#', ' ']).to_string());
        return Err(vec![read_errors::no_header(span, names.len(), comment)]);
    }
    let repeated = repeated(&names).into_iter().take(MAX_FINDINGS_SHOWN);
    let found = repeated.filter_map(|(first, again)| {
        let name = names.get(again)?;
        let (start, end) = *ranges.get(again)?;
        let first = place(*ranges.get(first)?);
        // Both in one excerpt, unless the line is too long to be shown whole.
        let again = match text.len() <= MAX_EXCERPT_BYTES {
            true => Span::new(first.file, start, end),
            false => place((start, end)),
        };
        Some(read_errors::duplicate_header(name, first, again))
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

/// `{` or `[` where names should be: a JSON document, perhaps one of our results.
fn is_json(text: &str) -> bool {
    let opened = text.trim_start().strip_prefix(['{', '[']);
    let inside = opened.map(str::trim_start);
    inside.is_some_and(|t| t.is_empty() || t.starts_with(['"', '{', '[', '}', ']']))
}

/// The separator that cuts the header and the row below it into equally many cells; else the most frequent one.
fn separator(header: &str, row: Option<&str>) -> u8 {
    let found: Vec<(u8, usize)> = [b'\t', b';', b',']
        .into_iter()
        .map(|s| (s, cell::count(header, s)))
        .filter(|(_, n)| *n > 0)
        .collect();
    let agrees = |s: u8, n: usize| row.is_some_and(|r| cell::count(r, s) == n);
    let best = found.iter().find(|&&(s, n)| agrees(s, n));
    let most = || found.iter().rev().max_by_key(|(_, n)| *n);
    best.or_else(most).map_or(b',', |(s, _)| *s)
}

/// A line of numbers names nothing.
fn are_numbers(names: &[String]) -> bool {
    let cells = || names.iter().map(|n| cell::parse(n));
    cells().any(|c| matches!(c, Cell::Number(_))) && !cells().any(|c| c == Cell::Bad(Fault::Text))
}

/// Columns with the name of an earlier one: the first of that name, and the repeated one.
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
