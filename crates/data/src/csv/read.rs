//! Bytes → [`Table`]: the order of the steps, and the check of memory between header and rows.

use std::io::Read;

use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::source::Sources;

use super::excerpt::excerpt;
use super::limits::Limits;
use super::lines::Lines;
use super::rows::{self, Shape};
use super::table::{Origin, Table, table_bytes};
use super::{decode, header, read_errors};

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
    let max_rows = lines.at_most();
    let bytes = table_bytes(&text, max_rows, width);
    if bytes.saturating_add(limits.taken) > limits.table_bytes {
        let d = read_errors::table_too_large(name, (max_rows, width), bytes, limits);
        return Err(vec![d]);
    }
    let shape = Shape {
        separator,
        width,
        limit: limits.columns,
    };
    let rows = rows::read(lines, max_rows, shape);
    let wrong = read_errors::rows(name, &rows, shape, &text, sources);
    if !wrong.is_empty() {
        return Err(wrong);
    }
    if rows.lines.is_empty() {
        let whole = (0, header.text.len());
        let span = excerpt(name, sources, header.line.number, header.text, whole);
        return Err(vec![read_errors::no_rows(span)]);
    }
    let (headers, header) = (header.names, header.line);
    Ok(Table {
        name: name.to_string(),
        headers,
        rows,
        origin: Origin::Text {
            text,
            header,
            separator,
        },
    })
}
