//! Bytes → the text of a table.
//!
//! In: a reader and limits. Out: the whole text in UTF-8 without its byte order mark. Stops reading as soon as a file turns out
//! to be too large, to be binary or to have too long a line.

use std::io::Read;

use super::limits::Limits;
use super::read_errors;
use sidc_lang::diagnostic::Diagnostic;

/// Bytes read and checked at once.
const READ_BYTES: u64 = 1 << 16;
const BYTE_ORDER_MARK: char = '\u{feff}';

/// The whole input as text.
pub(super) fn decode(
    name: &str,
    mut reader: impl Read,
    limits: &Limits,
) -> Result<String, Diagnostic> {
    let mut bytes = Vec::new();
    let mut line = Line::default();
    loop {
        let before = bytes.len();
        let piece = reader.by_ref().take(READ_BYTES).read_to_end(&mut bytes);
        piece.map_err(|e| read_errors::unreadable(name, &e))?;
        let new = bytes.get(before..).unwrap_or_default();
        if new.is_empty() {
            break;
        }
        if let Some(d) = too_large(name, bytes.len() as u64, limits) {
            return Err(d);
        }
        let binary = match before {
            0 => read_errors::not_text(name, new),
            _ => read_errors::nul(name, before, new),
        };
        if let Some(d) = binary {
            return Err(d);
        }
        if let Some(number) = line.longer_than(limits.line_bytes, new) {
            return Err(read_errors::line_too_long(name, number, limits.line_bytes));
        }
    }
    utf8(name, bytes)
}

/// The error of a file of `bytes` bytes that exceeds a limit; called before the file is read.
pub fn too_large(name: &str, bytes: u64, limits: &Limits) -> Option<Diagnostic> {
    if bytes > limits.file_bytes {
        return Some(read_errors::file_too_large(name, limits.file_bytes));
    }
    let all = bytes.saturating_add(limits.taken);
    (all > limits.table_bytes).then(|| read_errors::text_too_large(name, limits))
}

fn utf8(name: &str, bytes: Vec<u8>) -> Result<String, Diagnostic> {
    let mut text = String::from_utf8(bytes)
        .map_err(|e| read_errors::not_utf8(name, e.as_bytes(), e.utf8_error().valid_up_to()))?;
    // Concatenated files may have several marks.
    let marks = text.len() - text.trim_start_matches(BYTE_ORDER_MARK).len();
    text.drain(..marks);
    Ok(text)
}

/// The current line: its number, from 0, and its length so far.
#[derive(Default)]
struct Line {
    number: usize,
    length: u64,
}

impl Line {
    /// Number, from 1, of the first line that the new bytes make longer than the limit.
    fn longer_than(&mut self, limit: u64, new: &[u8]) -> Option<usize> {
        if self.length + new.len() as u64 <= limit {
            let ends = |b: &u8| matches!(b, b'\n' | b'\r');
            self.number += new.iter().filter(|b| **b == b'\n').count();
            self.length = match new.iter().rposition(ends) {
                Some(end) => (new.len() - end - 1) as u64,
                None => self.length + new.len() as u64,
            };
            return None;
        }
        for part in new.split_inclusive(|b| matches!(b, b'\n' | b'\r')) {
            self.length += part.len() as u64;
            if self.length > limit {
                return Some(self.number + 1);
            }
            if part.ends_with(b"\n") {
                self.number += 1;
            }
            if part.ends_with(b"\n") || part.ends_with(b"\r") {
                self.length = 0;
            }
        }
        None
    }
}
