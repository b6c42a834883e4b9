//! One line of a file as an excerpt for messages, cut where it is long.
//!
//! In: a line's text and a range in it. Out: a [`Span`] into an excerpt added to the sources. Knows no tables.

use sidc_lang::source::{Sources, Span};

use super::lines::Line;

/// Longest line that is shown whole, bytes.
pub(super) const MAX_EXCERPT_BYTES: usize = 160;

/// Adds one line to the sources, cut to the neighbourhood of `range` if it is long.
pub(super) fn excerpt(
    name: &str,
    sources: &mut Sources,
    number: usize,
    line: &str,
    range: (usize, usize),
) -> Span {
    if line.len() <= MAX_EXCERPT_BYTES {
        let file = sources.add_excerpt(name, number, line);
        return Span::new(file, range.0, range.1);
    }
    let boundary = |mut at: usize| {
        while !line.is_char_boundary(at) {
            at -= 1;
        }
        at
    };
    let from = boundary(range.0.saturating_sub(MAX_EXCERPT_BYTES / 2));
    let to = boundary((from + MAX_EXCERPT_BYTES).min(line.len()));
    let before = if from > 0 { "…" } else { "" };
    let after = if to < line.len() { "…" } else { "" };
    let shown = slice(line, (from, to));
    let file = sources.add_excerpt(name, number, format!("{before}{shown}{after}"));
    let shift = |at: usize| at.clamp(from, to) - from + before.len();
    Span::new(file, shift(range.0), shift(range.1))
}

/// A line by its place in the text.
pub(super) fn line_at(text: &str, at: Line) -> &str {
    let rest = text.get(at.start..).unwrap_or("");
    rest.split(['\n', '\r']).next().unwrap_or("")
}

pub(super) fn slice(text: &str, range: (usize, usize)) -> &str {
    text.get(range.0..range.1).unwrap_or("")
}
