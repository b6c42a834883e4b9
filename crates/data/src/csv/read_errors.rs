//! What is wrong with a file, and the remedy: the constructors of the reader's diagnostics.
//!
//! In: places and texts. Out: diagnostics. Decides nothing but which of several messages fits.

use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::source::{Sources, Span};

use super::cell::Fault;
use super::excerpt::{excerpt, line_at};
use super::limits::{Limits, MAX_FINDINGS_SHOWN};
use super::lines::Line;
use super::rows::{RowFault, Rows, Shape};
use super::table::Table;

/// Diagnostics of faulty lines: the first few in full, then how many more.
pub(super) fn rows(
    name: &str,
    rows: &Rows,
    shape: Shape,
    text: &str,
    sources: &mut Sources,
) -> Vec<Diagnostic> {
    let mut place = |line: Line, from: usize| {
        let text = line_at(text, line);
        let span = excerpt(name, sources, line.number, text, (from, text.len()));
        (span, text)
    };
    let wrong = rows.wrong.first.iter().map(|(line, why)| {
        let d = match *why {
            RowFault::Open(at) => open_quote(place(*line, at).0),
            RowFault::Ragged(cells) => {
                let (span, text) = place(*line, 0);
                ragged_row(span, cells, shape.width, shape.separator, text)
            }
        };
        (line.number, d)
    });
    let mut out: Vec<(usize, Diagnostic)> = wrong.collect();
    let mut count = rows.wrong.count;
    if let (Some(line), true) = (rows.lines.first(), rows.first_is_of_words()) {
        let (span, text) = place(*line, 0);
        let d = unknown_separator(span, text).unwrap_or_else(|| units_row(span));
        out.push((line.number, d));
        out.sort_by_key(|(number, _)| *number);
        out.truncate(MAX_FINDINGS_SHOWN);
        count += 1;
    }
    let more = count - out.len();
    let mut out: Vec<Diagnostic> = out.into_iter().map(|(_, d)| d).collect();
    count_rest(&mut out, more, "row");
    out
}

/// Diagnostics of faulty cells in the given columns: the first few in full, then how many more.
pub fn bad_cells(table: &Table, columns: &[usize], sources: &mut Sources) -> Vec<Diagnostic> {
    let faults = |c: &usize| table.faults(*c);
    let total: usize = columns.iter().filter_map(faults).map(|f| f.count).sum();
    let mut places: Vec<(usize, usize, Fault)> = columns
        .iter()
        .flat_map(|c| {
            let first = faults(c).map_or(&[][..], |f| f.first.as_slice());
            first.iter().map(move |(row, fault)| (*row, *c, *fault))
        })
        .collect();
    places.sort_by_key(|(row, column, _)| (*row, *column));
    let mut out: Vec<Diagnostic> = Vec::new();
    let mut seen_systematic = Vec::new();
    for (row, column, fault) in places {
        // One decimal comma or date stands for all of its kind.
        if fault != Fault::Text && fault != Fault::OutOfRange {
            if seen_systematic.contains(&fault) {
                continue;
            }
            seen_systematic.push(fault);
        }
        out.push(bad_cell(table, row, column, fault, sources));
        if out.len() == MAX_FINDINGS_SHOWN {
            break;
        }
    }
    let more = total.saturating_sub(out.len());
    count_rest(&mut out, more, "cell");
    out
}

fn count_rest(shown: &mut [Diagnostic], more: usize, what: &str) {
    if let (Some(last), true) = (shown.last_mut(), more > 0) {
        let s = if more == 1 { "" } else { "s" };
        last.notes.push(format!("and {more} more {what}{s}"));
    }
}

fn bad_cell(
    table: &Table,
    row: usize,
    column: usize,
    fault: Fault,
    sources: &mut Sources,
) -> Diagnostic {
    let text: String = table.cell(row, column).chars().take(40).collect();
    let header = table.headers().get(column).map_or("", |h| h.as_str());
    let place = format!("{}, {}, column \"{header}\"", table.name, table.place(row));
    let span = table.cell_span(sources, row, column);
    let words = text.split_whitespace().count();
    match fault {
        Fault::OutOfRange => Diagnostic::error(
            "cell-out-of-range",
            format!("{place}: `{text}` is not a finite number"),
        )
        .at(span, "beyond ±1.8e308")
        .help("leave the cell empty if the value is missing"),
        Fault::DecimalComma => Diagnostic::error(
            "decimal-comma",
            format!("{place}: `{text}` has a comma"),
        )
        .at(span, "of decimals, or of thousands?")
        .help(
            "separate columns by semicolons or tabs, where a comma is one of decimals if no cell of the column has a point; or export with decimal points",
        ),
        Fault::Date => {
            Diagnostic::error("date-stamp", format!("{place}: `{text}` is a date in no order that is known"))
                .at(span, "day or month first?")
                .help(
                    "write `2026-11-25T12:30:01.5` or seconds since the start of the record, or leave the column out and give `step` in the data block",
                )
        }
        Fault::Text if words > 1 && text.split_whitespace().all(|w| w.parse::<f64>().is_ok()) => {
            Diagnostic::error("bad-cell", format!("{place}: `{text}` is {words} numbers"))
                .at(span, "one number a cell")
                .help("separate columns by commas, semicolons or tabs, not by spaces")
        }
        Fault::Text => {
            Diagnostic::error("bad-cell", format!("{place}: `{text}` is not a number"))
                .at(span, "expected a number")
                .help("correct the cell, or leave it empty if the value is missing")
        }
    }
}

pub(super) fn unreadable(name: &str, e: &std::io::Error) -> Diagnostic {
    Diagnostic::error(
        "unreadable-file",
        format!("cannot read {name}: {}", io_error_text(e)),
    )
}

/// The text of an error of the system, without its number: "no such file or directory".
pub fn io_error_text(e: &std::io::Error) -> String {
    let text = e.to_string();
    match text.split_once(" (os error") {
        Some((words, _)) => words.to_lowercase(),
        None => text,
    }
}

pub(super) fn file_too_large(name: &str, limit: u64) -> Diagnostic {
    Diagnostic::error(
        "file-too-large",
        format!("{name} is larger than the limit of {}", size(limit)),
    )
    .help("keep fewer rows or columns, or split the file into several trajectories")
}

/// Remedy for a table that is too large.
const SMALLER: &str =
    "keep only the columns that the model uses, or fewer rows, or set a higher --memory-limit";

pub(super) fn text_too_large(name: &str, limits: &Limits) -> Diagnostic {
    let text = format!(
        "{name}: its text alone takes more than {}, the limit of tables",
        size(limits.table_bytes)
    );
    too_large(text, limits)
}

/// Adds how much of the limit the tables before take.
fn too_large(text: String, limits: &Limits) -> Diagnostic {
    let d = Diagnostic::error("table-too-large", text).help(SMALLER);
    match limits.taken {
        0 => d,
        taken => d.fact(format!("the tables before it take {}", size(taken))),
    }
}

pub(super) fn line_too_long(name: &str, number: usize, limit: u64) -> Diagnostic {
    Diagnostic::error(
        "line-too-long",
        format!(
            "{name}, line {number}: longer than the limit of {}",
            size(limit)
        ),
    )
    .help("a table has one line for each instant: check how it was exported")
}

pub(super) fn table_too_large(
    name: &str,
    (rows, columns): (usize, usize),
    bytes: u64,
    limits: &Limits,
) -> Diagnostic {
    let text = format!(
        "{name}: {rows} lines of {columns} columns would need {}, the limit is {}",
        size(bytes),
        size(limits.table_bytes)
    );
    too_large(text, limits)
}

/// So many bytes, in the unit that suits them.
pub fn size(bytes: u64) -> String {
    match bytes {
        b if b >= 1 << 30 => format!("{:.1} GiB", b as f64 / (1u64 << 30) as f64),
        b if b >= 1 << 20 => format!("{:.1} MiB", b as f64 / (1u64 << 20) as f64),
        b => format!("{b} bytes"),
    }
}

pub(super) fn too_many_columns(name: &str, columns: usize, limit: usize) -> Diagnostic {
    Diagnostic::error(
        "too-many-columns",
        format!("{name} has {columns} columns, the limit is {limit}"),
    )
    .help("keep only the columns that the model uses")
}

/// Encodings that are not read; NUL bytes anywhere near the start.
pub(super) fn not_text(name: &str, bytes: &[u8]) -> Option<Diagnostic> {
    let head = bytes.get(..bytes.len().min(1 << 16)).unwrap_or(bytes);
    let zeros = |from: usize| {
        head.iter()
            .skip(from)
            .step_by(2)
            .filter(|b| **b == 0)
            .count()
    };
    let (even, odd) = (zeros(0), zeros(1));
    if bytes.starts_with(b"\xff\xfe\0\0") || bytes.starts_with(b"\0\0\xfe\xff") {
        return Some(not_this_encoding("not-utf8", name, "UTF-32"));
    }
    let marked = bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff");
    if marked || even.max(odd) > head.len() / 4 && even.min(odd) < head.len() / 50 {
        return Some(not_this_encoding("utf-16", name, "UTF-16"));
    }
    nul(name, 0, bytes)
}

fn not_this_encoding(code: &'static str, name: &str, encoding: &str) -> Diagnostic {
    Diagnostic::error(code, format!("{name} is encoded in {encoding}"))
        .help(format!("iconv -f {encoding} -t UTF-8 {name} > utf8_{name}"))
}

/// A NUL byte in `bytes`, which follow `before` others.
pub(super) fn nul(name: &str, before: usize, bytes: &[u8]) -> Option<Diagnostic> {
    let at = before + bytes.iter().position(|b| *b == 0)?;
    Some(
        Diagnostic::error("not-text", format!("{name} is binary: byte {at} is NUL"))
            .help("export the data as CSV in UTF-8"),
    )
}

pub(super) fn not_utf8(name: &str, bytes: &[u8], at: usize) -> Diagnostic {
    let before = bytes.get(..at).unwrap_or(bytes);
    let line = 1 + before.iter().filter(|b| **b == b'\n').count();
    let byte = bytes.get(at).copied().unwrap_or(0);
    Diagnostic::error(
        "not-utf8",
        format!("{name}, line {line}: byte 0x{byte:02X} is not UTF-8"),
    )
    .help(format!("iconv -f LATIN1 -t UTF-8 {name} > utf8_{name}"))
}

pub(super) fn empty_file(name: &str) -> Diagnostic {
    Diagnostic::error("empty-file", format!("{name} holds no data"))
        .help("the first line names the columns, rows of numbers follow")
}

pub(super) fn no_rows(header: Span) -> Diagnostic {
    Diagnostic::error("no-rows", "the file has a header and no rows")
        .at(header, "nothing follows this line")
}

pub(super) fn no_header(first: Span, columns: usize, comment: Option<String>) -> Diagnostic {
    let d = Diagnostic::error("no-header", "the first row holds numbers, not column names")
        .at(first, format!("{columns} numbers"));
    match comment {
        Some(c) if !c.is_empty() => d
            .fact(format!("the line before it is a comment: # {c}"))
            .help(format!("if that is the header, take off its #: {c}")),
        _ => d.help("put a line with the columns' names first, such as: t,x"),
    }
}

pub(super) fn json(place: Span) -> Diagnostic {
    Diagnostic::error("not-a-table", "this is JSON, not a table")
        .at(place, "no names of columns")
        .help("equations are found in tables with a line of names; results go to `sidc simulate`, `report`, `export` or `linearize`")
}

pub(super) fn duplicate_header(name: &str, first: Span, again: Span) -> Diagnostic {
    Diagnostic::error(
        "duplicate-header",
        format!("two columns are named \"{name}\""),
    )
    .at(again, "second column of this name")
    .also(first, "first column of this name")
    .help("rename or delete one of them")
}

pub(super) fn units_row(row: Span) -> Diagnostic {
    Diagnostic::error(
        "units-row",
        "the first row below the header holds no number",
    )
    .at(row, "units?")
    .help("delete this line, or put a # in front of it")
}

/// The error of a row of several numbers in one cell, if spaces or bars separate them.
pub(super) fn unknown_separator(row: Span, text: &str) -> Option<Diagnostic> {
    let parted = |by: &dyn Fn(char) -> bool| {
        let cells: Vec<&str> = text.split(by).filter(|c| !c.trim().is_empty()).collect();
        cells.len() > 1 && cells.iter().all(|c| c.trim().parse::<f64>().is_ok())
    };
    let what = if parted(&char::is_whitespace) {
        "spaces"
    } else if parted(&|c| c == '|') {
        "`|`"
    } else {
        return None;
    };
    Some(
        Diagnostic::error(
            "unknown-separator",
            format!("{what} between the columns: a table has commas, semicolons or tabs"),
        )
        .at(row, "several numbers in one cell")
        .help(match what {
            "spaces" => "sed 's/^ *//; s/  */,/g' FILE, if no header contains a space",
            _ => "sed 's/|/,/g' FILE, if no cell contains a comma",
        }),
    )
}

pub(super) fn open_quote(at: Span) -> Diagnostic {
    Diagnostic::error("open-quote", "a quote is not closed on its line")
        .at(at, "opened here")
        .help("close it; a cell may not contain a line break")
}

pub(super) fn ragged_row(
    row: Span,
    cells: usize,
    columns: usize,
    separator: u8,
    text: &str,
) -> Diagnostic {
    let counted = format!("{cells} cell{}", if cells == 1 { "" } else { "s" });
    let d = Diagnostic::error(
        "ragged-row",
        format!("a row has {counted}, the header has {columns}"),
    )
    .at(row, counted);
    let whole = |t: &str| {
        let t = t.trim();
        !t.is_empty() && t.bytes().all(|b| b.is_ascii_digit() || b == b'-')
    };
    if separator == b',' && cells == 2 * columns && text.split(',').skip(1).all(whole) {
        return d
            .fact("are the commas decimal commas?")
            .help("export with decimal points, or with semicolons between the cells");
    }
    if cells < columns {
        return d.help("complete the row, leaving cells without a value empty, or delete it");
    }
    d.help("delete the surplus cells")
}
