//! A delimited text as a table of numbers.
//!
//! In: a reader. Out: a [`Table`] with named columns, or every reason why it is none. Cells that are no numbers are kept
//! as faults: they matter only if a model uses their column. Never guesses at decimal commas, encodings or dates.

mod cells;
mod decode;
mod lines;
mod refusals;

use std::io::Read;

use crate::lang::diagnostic::Diagnostic;
use crate::lang::source::{Sources, Span};
use cells::{Cell, Fault};
pub use decode::too_large;
use lines::{Line, Lines};
pub use refusals::bad_cells;

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
    /// Largest table, bytes: its text, 8 per cell and 16 per row.
    pub table_bytes: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Limits {
            columns: 10_000,
            file_bytes: 2 << 30,
            line_bytes: 16 << 20,
            table_bytes: 4 << 30,
        }
    }
}

/// One file: R rows of C columns, and its text, so that messages can show any cell.
#[derive(Clone, Debug)]
pub struct Table {
    pub name: String,
    headers: Vec<String>,
    header: Line,
    /// C columns of R values; NaN where missing or faulty.
    columns: Vec<Vec<f64>>,
    rows: Vec<Line>,
    faults: Vec<Faults>,
    text: String,
    separator: u8,
}

/// The cells of one column that are no numbers.
#[derive(Clone, Debug, Default)]
struct Faults {
    count: usize,
    first: Vec<(usize, Fault)>,
}

/// Reads a comma, semicolon or tab separated table whose first line names the columns.
///
/// `#` lines and blank lines are skipped. Errors: `unreadable-file`, `not-text`, `utf-16`, `not-utf8`, `file-too-large`,
/// `line-too-long`, `table-too-large`, `too-many-columns`, `empty-file`, `no-header`, `no-rows`, `duplicate-header`, `units-row`, `open-quote`,
/// `ragged-row`. Time and memory linear in the text.
pub fn read(
    name: &str,
    reader: impl Read,
    limits: &Limits,
    sources: &mut Sources,
) -> Result<Table, Vec<Diagnostic>> {
    let text = decode::decode(name, reader, limits).map_err(|d| vec![d])?;
    let mut lines = Lines::of(&text);
    let Some((header, header_text)) = lines.next() else {
        return Err(vec![refusals::empty_file(name)]);
    };
    let comment = lines.comment();
    let separator = detect_separator(header_text, lines.clone().next().map(|(_, l)| l));
    let cells = cells::count(header_text, separator) + 1;
    if cells > limits.columns {
        return Err(vec![refusals::too_many_columns(
            name,
            cells,
            limits.columns,
        )]);
    }
    let mut ranges = Vec::new();
    let place = |sources: &mut Sources, line: Line, text: &str, range| {
        excerpt(name, sources, line.number, text, range)
    };
    if let Err(at) = cells::split(header_text, separator, &mut ranges) {
        let span = place(sources, header, header_text, (at, header_text.len()));
        return Err(vec![refusals::open_quote(span)]);
    }
    let width = ranges.len();
    let headers: Vec<String> = ranges
        .iter()
        .map(|&(a, b)| slice(header_text, (a, b)).replace("\"\"", "\""))
        .collect();
    let parsed: Vec<Cell> = headers.iter().map(|h| cells::parse(h)).collect();
    if parsed.iter().any(|c| matches!(c, Cell::Number(_)))
        && !parsed.iter().any(|c| matches!(c, Cell::Bad(Fault::Text)))
    {
        let span = place(sources, header, header_text, (0, header_text.len()));
        let comment = comment.map(|c: &str| c.trim_start_matches(['#', ' ']).to_string());
        return Err(vec![refusals::no_header(span, width, comment)]);
    }
    let repeated = repeated_headers(&headers);
    if !repeated.is_empty() {
        let found = repeated
            .into_iter()
            .take(SHOWN)
            .filter_map(|(first, again)| {
                let first = place(sources, header, header_text, *ranges.get(first)?);
                let (start, end) = *ranges.get(again)?;
                let name = headers.get(again)?;
                // Both labels in one excerpt, unless the line is too long to show whole.
                let again = if header_text.len() <= EXCERPT {
                    Span {
                        start,
                        end,
                        ..first
                    }
                } else {
                    place(sources, header, header_text, (start, end))
                };
                Some(refusals::duplicate_header(name, first, again))
            });
        return Err(found.collect());
    }

    let rows = lines.at_most();
    let numbers = (rows as u64).saturating_mul(8 * width as u64 + 16);
    let bytes = numbers.saturating_add(text.len() as u64);
    if bytes > limits.table_bytes {
        let d = refusals::table_too_large(name, rows, width, bytes, limits.table_bytes);
        return Err(vec![d]);
    }

    let mut table = Table {
        name: name.to_string(),
        columns: headers.iter().map(|_| Vec::with_capacity(rows)).collect(),
        faults: headers.iter().map(|_| Faults::default()).collect(),
        headers,
        header,
        rows: Vec::with_capacity(rows),
        text: String::new(),
        separator,
    };
    let mut errors = refusals::Capped::new();
    let mut full_rows = 0;
    for (line, line_text) in lines {
        // Places of cells are noted down: there is no memory for those of a row without end.
        if line_text.len() > limits.columns {
            let cells = cells::count(line_text, separator) + 1;
            if cells > limits.columns {
                errors.add(|| {
                    let span = place(sources, line, line_text, (0, line_text.len()));
                    refusals::ragged_row(span, cells, width, separator, line_text)
                });
                continue;
            }
        }
        if let Err(at) = cells::split(line_text, separator, &mut ranges) {
            errors.add(|| {
                refusals::open_quote(place(sources, line, line_text, (at, line_text.len())))
            });
            continue;
        }
        let surplus_is_empty = ranges.iter().skip(width).all(|(a, b)| a == b);
        if ranges.len() < width || !surplus_is_empty {
            errors.add(|| {
                let span = place(sources, line, line_text, (0, line_text.len()));
                refusals::ragged_row(span, ranges.len(), width, separator, line_text)
            });
            continue;
        }
        let row = table.rows.len();
        table.rows.push(line);
        for ((column, faults), range) in
            table.columns.iter_mut().zip(&mut table.faults).zip(&ranges)
        {
            column.push(match cells::parse(slice(line_text, *range)) {
                Cell::Number(x) => x,
                Cell::Missing => f64::NAN,
                Cell::Bad(fault) => {
                    faults.count += 1;
                    if faults.first.len() < SHOWN {
                        faults.first.push((row, fault));
                    }
                    f64::NAN
                }
            });
        }
        if ranges.iter().any(|(a, b)| a < b) {
            full_rows = table.rows.len();
        }
        if row == 0 && is_units_row(&table) {
            let span = place(sources, line, line_text, (0, line_text.len()));
            errors.add(|| {
                refusals::unknown_separator(span, line_text)
                    .unwrap_or_else(|| refusals::units_row(span))
            });
        }
    }
    // Spreadsheets leave lines of bare separators at the end.
    table.rows.truncate(full_rows);
    table.columns.iter_mut().for_each(|c| c.truncate(full_rows));
    if table.rows.is_empty() && errors.is_empty() {
        let span = place(sources, header, header_text, (0, header_text.len()));
        return Err(vec![refusals::no_rows(span)]);
    }
    errors.into_result()?;
    table.text = text;
    Ok(table)
}

impl Table {
    /// Number of rows R.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
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
        self.columns.get(column).map_or(&[], |c| c.as_slice())
    }

    /// The cell as written, trimmed.
    pub fn cell(&self, row: usize, column: usize) -> &str {
        let (_, line, range) = self.locate(row, column);
        slice(line, range)
    }

    /// Line of a row in the file, from 1.
    pub fn line_number(&self, row: usize) -> usize {
        self.rows.get(row).map_or(0, |l| l.number)
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
        let at = self.rows.get(row).copied().unwrap_or_default();
        let line = self.line(at);
        (at.number, line, self.range(line, column))
    }

    fn line(&self, at: Line) -> &str {
        let rest = self.text.get(at.start..).unwrap_or("");
        rest.split(['\n', '\r']).next().unwrap_or("")
    }

    fn range(&self, line: &str, column: usize) -> (usize, usize) {
        let mut ranges = Vec::new();
        // An open quote was refused when the file was read.
        let _ = cells::split(line, self.separator, &mut ranges);
        ranges.get(column).copied().unwrap_or((0, line.len()))
    }
}

/// The separator that cuts the header and the row below it into equally many cells; else the most frequent one.
fn detect_separator(header: &str, row: Option<&str>) -> u8 {
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

fn repeated_headers(headers: &[String]) -> Vec<(usize, usize)> {
    let mut seen = std::collections::BTreeMap::new();
    let mut repeated = Vec::new();
    for (i, h) in headers.iter().enumerate().filter(|(_, h)| !h.is_empty()) {
        match seen.get(h) {
            Some(first) => repeated.push((*first, i)),
            None => {
                seen.insert(h, i);
            }
        }
    }
    repeated
}

/// True if every cell of the first row that holds anything is text; a table of one text column may be what it is.
fn is_units_row(table: &Table) -> bool {
    let text = |f: &Faults| matches!(f.first.first(), Some((0, Fault::Text)));
    let bad = table.faults.iter().filter(|f| text(f)).count();
    let numbers = table
        .columns
        .iter()
        .filter(|c| c.iter().any(|x| x.is_finite()));
    bad > 0 && numbers.count() == 0 && table.faults.iter().all(|f| f.count == 0 || text(f))
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

fn slice(text: &str, range: (usize, usize)) -> &str {
    text.get(range.0..range.1).unwrap_or("")
}
