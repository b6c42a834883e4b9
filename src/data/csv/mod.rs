//! A delimited text as a table of numbers.
//!
//! In: a reader. Out: a [`Table`] with named columns, or every reason why it is none. Cells that are no numbers are kept
//! as faults: they matter only if a model uses their column. Never guesses at decimal commas, encodings or dates.

mod cells;
mod decode;
mod header;
mod lines;
mod refusals;
mod rows;

use std::io::Read;

use crate::lang::diagnostic::Diagnostic;
use crate::lang::source::{Sources, Span};
pub use decode::too_large;
use lines::{Line, Lines};
pub use refusals::bad_cells;
pub(crate) use refusals::plain;
use rows::{Rows, Shape};

/// How many findings of one kind are shown in full.
pub(super) const SHOWN: usize = 5;

/// What a file may ask for; checked before the memory is taken.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    pub columns: usize,
    /// Largest file, bytes.
    pub file_bytes: u64,
    /// Longest line, bytes.
    pub line_bytes: u64,
    /// All tables, bytes: of each its text, 8 per cell and 16 per row.
    pub table_bytes: u64,
    /// What of them the tables read before have taken.
    pub taken: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Limits {
            columns: 10_000,
            file_bytes: 2 << 30,
            line_bytes: 16 << 20,
            table_bytes: 4 << 30,
            taken: 0,
        }
    }
}

/// One file: R rows of C columns, and its text, so that messages can show any cell.
#[derive(Clone, Debug)]
pub struct Table {
    pub name: String,
    headers: Vec<String>,
    header: Line,
    rows: Rows,
    text: String,
    separator: u8,
}

/// Reads a comma, semicolon or tab separated table whose first line names the columns.
///
/// `#` lines and blank lines are skipped. Errors: `unreadable-file`, `not-text`, `utf-16`, `not-utf8`, `file-too-large`,
/// `line-too-long`, `table-too-large`, `too-many-columns`, `empty-file`, `not-a-table`, `no-header`, `no-rows`, `duplicate-header`, `units-row`, `open-quote`,
/// `ragged-row`. Time and memory linear in the text.
pub fn read(
    name: &str,
    reader: impl Read,
    limits: &Limits,
    sources: &mut Sources,
) -> Result<Table, Vec<Diagnostic>> {
    let text = decode::decode(name, reader, limits).map_err(|d| vec![d])?;
    let mut lines = Lines::of(&text);
    let header = header::read(name, &mut lines, limits, sources)?;
    let (width, separator) = (header.names.len(), header.separator);
    let most = lines.at_most();
    let bytes = bytes(&text, most, width);
    if bytes.saturating_add(limits.taken) > limits.table_bytes {
        let d = refusals::table_too_large(name, (most, width), bytes, limits);
        return Err(vec![d]);
    }
    let shape = Shape {
        separator,
        width,
        limit: limits.columns,
    };
    let rows = rows::read(lines, most, shape);
    let wrong = refusals::rows(name, &rows, shape, &text, sources);
    if !wrong.is_empty() {
        return Err(wrong);
    }
    if rows.lines.is_empty() {
        let whole = (0, header.text.len());
        let span = excerpt(name, sources, header.line.number, header.text, whole);
        return Err(vec![refusals::no_rows(span)]);
    }
    Ok(Table {
        name: name.to_string(),
        header: header.line,
        headers: header.names,
        rows,
        separator,
        text,
    })
}

/// What a table of so many rows and columns takes.
fn bytes(text: &str, rows: usize, columns: usize) -> u64 {
    let numbers = (rows as u64).saturating_mul(8 * columns as u64 + 16);
    numbers.saturating_add(text.len() as u64)
}

impl Table {
    /// Memory, as [`Limits::table_bytes`] counts it.
    pub fn bytes(&self) -> u64 {
        bytes(&self.text, self.len(), self.headers.len())
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
    pub fn cell(&self, row: usize, column: usize) -> &str {
        let (_, line, range) = self.locate(row, column);
        slice(line, range)
    }

    /// Line of a row in the file, from 1.
    pub fn line_number(&self, row: usize) -> usize {
        self.rows.lines.get(row).map_or(0, |l| l.number)
    }

    /// Adds a row's line to the sources and points at one cell of it.
    pub fn cell_span(&self, sources: &mut Sources, row: usize, column: usize) -> Span {
        let (number, line, range) = self.locate(row, column);
        excerpt(&self.name, sources, number, line, range)
    }

    /// Adds the header line to the sources and points at one header.
    pub fn header_span(&self, sources: &mut Sources, column: usize) -> Span {
        let line = self.line(self.header);
        let range = self.range(line, column);
        excerpt(&self.name, sources, self.header.number, line, range)
    }

    fn locate(&self, row: usize, column: usize) -> (usize, &str, (usize, usize)) {
        let at = self.rows.lines.get(row).copied().unwrap_or_default();
        let line = self.line(at);
        (at.number, line, self.range(line, column))
    }

    fn line(&self, at: Line) -> &str {
        line_at(&self.text, at)
    }

    fn range(&self, line: &str, column: usize) -> (usize, usize) {
        let mut ranges = Vec::new();
        // An open quote was refused when the file was read.
        let _ = cells::split(line, self.separator, &mut ranges);
        ranges.get(column).copied().unwrap_or((0, line.len()))
    }
}

/// Longest line shown whole, bytes.
const EXCERPT: usize = 160;

/// Adds one line to the sources, cut to the neighbourhood of `range` if it is long.
fn excerpt(
    name: &str,
    sources: &mut Sources,
    number: usize,
    line: &str,
    range: (usize, usize),
) -> Span {
    if line.len() <= EXCERPT {
        let file = sources.add_excerpt(name, number, line);
        return Span::new(file, range.0, range.1);
    }
    let boundary = |mut at: usize| {
        while !line.is_char_boundary(at) {
            at -= 1;
        }
        at
    };
    let from = boundary(range.0.saturating_sub(EXCERPT / 2));
    let to = boundary((from + EXCERPT).min(line.len()));
    let before = if from > 0 { "…" } else { "" };
    let after = if to < line.len() { "…" } else { "" };
    let shown = slice(line, (from, to));
    let file = sources.add_excerpt(name, number, format!("{before}{shown}{after}"));
    let shift = |at: usize| at.clamp(from, to) - from + before.len();
    Span::new(file, shift(range.0), shift(range.1))
}

/// A line by its place in the text.
fn line_at(text: &str, at: Line) -> &str {
    let rest = text.get(at.start..).unwrap_or("");
    rest.split(['\n', '\r']).next().unwrap_or("")
}

fn slice(text: &str, range: (usize, usize)) -> &str {
    text.get(range.0..range.1).unwrap_or("")
}
