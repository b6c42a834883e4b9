//! One file, or one set of arrays, as numbers by column, with its text, so that messages can show any cell.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt::Display;
use std::sync::Arc;

use sidc_lang::source::{Sources, Span};

use super::cell::{self, Fault};
use super::excerpt::{excerpt, line_at, slice};
use super::lines::Line;
use super::log::Log;
use super::rows::{FirstFew, Rows};
use super::words::Words;

/// R rows of C columns, and what they were made of, so that messages can show any cell.
#[derive(Clone, Debug)]
pub struct Table {
    pub name: String,
    pub(super) headers: Vec<String>,
    pub(super) rows: Rows,
    pub(super) origin: Origin,
}

/// What the numbers of a table were made of.
#[derive(Clone, Debug)]
pub(super) enum Origin {
    /// A file's text.
    Text {
        text: String,
        header: Line,
        separator: u8,
    },
    /// Arrays in memory; columns of texts by their place, and headers of columns that were not asked for.
    Arrays {
        words: BTreeMap<usize, Words>,
        unread: Vec<String>,
    },
    /// Signals of several rates, which are rows when they are asked for.
    Log(Arc<Log>),
}

/// What a table of so many rows and columns takes.
pub(super) fn table_bytes(text: &str, rows: usize, columns: usize) -> u64 {
    let numbers = (rows as u64).saturating_mul(8 * columns as u64 + 16);
    numbers.saturating_add(text.len() as u64)
}

impl Table {
    /// Memory, as [`super::Limits::table_bytes`] counts it.
    pub fn bytes(&self) -> u64 {
        let text = match &self.origin {
            Origin::Text { text, .. } => text,
            Origin::Arrays { .. } => "",
            Origin::Log(log) => return log.bytes(),
        };
        table_bytes(text, self.len(), self.headers.len())
    }

    /// Number of rows R.
    pub fn len(&self) -> usize {
        self.rows.lines.len()
    }

    pub fn is_empty(&self) -> bool {
        self.rows.lines.is_empty()
    }

    /// The headers, trimmed, in file order; some may be empty.
    pub fn headers(&self) -> &[String] {
        &self.headers
    }

    /// The headers, and those of the columns of a log that were not asked for.
    pub(crate) fn known_headers(&self) -> impl Iterator<Item = &String> {
        let unread = match &self.origin {
            Origin::Arrays { unread, .. } => unread.as_slice(),
            _ => &[],
        };
        self.headers.iter().chain(unread)
    }

    /// Index of the column with exactly this header.
    pub fn position(&self, header: &str) -> Option<usize> {
        self.headers
            .iter()
            .position(|h| h == header && !h.is_empty())
    }

    /// R values; NaN where a cell is missing or no number.
    pub fn values(&self, column: usize) -> &[f64] {
        self.rows.columns.get(column).map_or(&[], |c| c.as_slice())
    }

    /// The cell as written, trimmed.
    pub fn cell(&self, row: usize, column: usize) -> Cow<'_, str> {
        match self.locate(row, column) {
            (_, Cow::Borrowed(line), range) => Cow::Borrowed(slice(line, range)),
            (_, Cow::Owned(line), range) => Cow::Owned(slice(&line, range).to_string()),
        }
    }

    /// Line of a row in the file, from 1; of a row of arrays, its number from 1.
    pub fn line_number(&self, row: usize) -> usize {
        self.rows.lines.get(row).map_or(0, |l| l.number)
    }

    /// A row as messages name it: its number, and its line in a file of text.
    pub(crate) fn place(&self, row: usize) -> String {
        match &self.origin {
            Origin::Text { .. } => format!("row {} (line {})", row + 1, self.line_number(row)),
            _ => format!("row {}", row + 1),
        }
    }

    /// Adds a row's line to the sources and points at one cell of it.
    pub fn cell_span(&self, sources: &mut Sources, row: usize, column: usize) -> Span {
        let (number, line, range) = self.locate(row, column);
        excerpt(&self.name, sources, number, &line, range)
    }

    /// Adds the header line to the sources and points at one header.
    pub fn header_span(&self, sources: &mut Sources, column: usize) -> Span {
        let (number, line, range) = match &self.origin {
            Origin::Text {
                text,
                header,
                separator,
            } => {
                let line = line_at(text, *header);
                let range = cell_range(line, *separator, column);
                (header.number, Cow::Borrowed(line), range)
            }
            _ => {
                let (line, range) = line_of_values(self.headers.iter(), column);
                (0, Cow::Owned(line), range)
            }
        };
        excerpt(&self.name, sources, number, &line, range)
    }

    /// The cells of a column that are no numbers, with their rows.
    pub(super) fn faults(&self, column: usize) -> Option<&FirstFew<(usize, Fault)>> {
        self.rows.faults.get(column)
    }

    /// Whether any cell of a column is no number.
    pub(crate) fn is_faulty(&self, column: usize) -> bool {
        self.faults(column).is_some_and(|f| f.count > 0)
    }

    /// A number as it would stand in a file.
    fn number_text(&self, row: usize, column: usize) -> String {
        let faults = self.faults(column).map_or(&[][..], |f| f.first.as_slice());
        match faults.iter().any(|(at, _)| *at == row) {
            true => "inf".into(),
            false => self
                .values(column)
                .get(row)
                .map_or(String::new(), f64::to_string),
        }
    }

    /// Number and text of a row's line, and where a cell stands in it.
    fn locate(&self, row: usize, column: usize) -> (usize, Cow<'_, str>, (usize, usize)) {
        let at = self.rows.lines.get(row).copied().unwrap_or_default();
        match &self.origin {
            Origin::Text {
                text, separator, ..
            } => {
                let line = line_at(text, at);
                let range = cell_range(line, *separator, column);
                (at.number, Cow::Borrowed(line), range)
            }
            other => {
                let words = match other {
                    Origin::Arrays { words, .. } => Some(words),
                    _ => None,
                };
                let cell = |column: usize| match words.and_then(|words| words.get(&column)) {
                    Some(words) => words.get(row).to_string(),
                    None => self.number_text(row, column),
                };
                let cells = (0..self.headers.len()).map(cell);
                let (line, range) = line_of_values(cells, column);
                (at.number, Cow::Owned(line), range)
            }
        }
    }
}

/// Where a cell stands in its line.
fn cell_range(line: &str, separator: u8, column: usize) -> (usize, usize) {
    let mut ranges = Vec::new();
    // An open quote was refused when the file was read.
    let _ = cell::split(line, separator, &mut ranges);
    ranges.get(column).copied().unwrap_or((0, line.len()))
}

/// Values side by side as messages show them, and the place of one of them.
fn line_of_values(
    values: impl Iterator<Item = impl Display>,
    column: usize,
) -> (String, (usize, usize)) {
    let (mut text, mut range) = (String::new(), (0, 0));
    for (place, value) in values.enumerate() {
        if place > 0 {
            text.push_str(", ");
        }
        let start = text.len();
        text.push_str(&value.to_string());
        if place == column {
            range = (start, text.len());
        }
    }
    (text, range)
}
