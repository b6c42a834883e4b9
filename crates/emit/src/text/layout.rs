//! Layout of sums: one line where it fits, else a line for each term.

use sidc_lang::number::{significant, with_error};
use sidc_lang::term::{Language, Precedence, Term, write_term};
use sidc_system::discovery::{Discovery, FoundTerm};

/// Widest line of a sum, in characters.
pub(crate) const LINE_WIDTH: usize = 100;
/// Widest line of words, in characters.
pub const TEXT_WIDTH: usize = 118;
/// Most significant digits of a coefficient.
const DIGITS: usize = 6;

/// A left side and its terms; a newline ends every line.
pub(crate) fn sum_lines(left: &str, terms: &[(bool, String)]) -> String {
    let line = format!("{left}{}\n", one_line_sum(terms));
    if terms.is_empty() || line.chars().count() <= LINE_WIDTH {
        return line;
    }
    let indent = " ".repeat(left.chars().count());
    terms
        .iter()
        .enumerate()
        .map(|(i, (negative, text))| {
            let start = if i == 0 { left } else { &indent };
            let sign = if *negative { '-' } else { '+' };
            format!("{start}{sign} {text}\n")
        })
        .collect()
}

/// `a + b - c`; 0 if there is none.
pub(crate) fn one_line_sum(terms: &[(bool, String)]) -> String {
    let parts = terms.iter().enumerate().map(|(i, t)| first_or_next(i, t));
    match terms.is_empty() {
        true => "0".into(),
        false => parts.collect::<Vec<String>>().join(" "),
    }
}

fn first_or_next(i: usize, (negative, text): &(bool, String)) -> String {
    match (i, negative) {
        (0, false) => text.clone(),
        (0, true) => format!("-{text}"),
        (_, false) => format!("+ {text}"),
        (_, true) => format!("- {text}"),
    }
}

/// Sign, and `1.29032*F`. A coefficient that rounds to 1 is omitted; a constant is its number.
pub(crate) fn signed_term(d: &Discovery, coefficient: f64, term: &Term) -> (bool, String) {
    with_size(d, coefficient, significant(coefficient.abs(), DIGITS), term)
}

/// The same with the standard error in the last digits of the coefficient: `1.2903(12)*F`.
pub(crate) fn signed_term_with_error(d: &Discovery, t: &FoundTerm) -> (bool, String) {
    let error = t.standard_error.unwrap_or(0.0);
    let size = with_error(t.coefficient.abs(), error, DIGITS);
    with_size(d, t.coefficient, size, &t.term)
}

fn with_size(d: &Discovery, coefficient: f64, size: String, term: &Term) -> (bool, String) {
    let (text, binds) = write_term(&Language(d), term);
    let text = match (term.is_one(), size.as_str()) {
        (true, _) => size,
        (_, "1") if binds >= Precedence::Product => text,
        _ if binds < Precedence::Product => format!("{size}*({text})"),
        _ => format!("{size}*{text}"),
    };
    (coefficient < 0.0, text)
}

/// Text broken between words, `first` before its first line and `next` before the others. A word that is too long stands alone.
pub fn wrapped(text: &str, width: usize, first: &str, next: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let mut line = String::from(first);
    let mut words = 0;
    for word in text.split_whitespace() {
        let room = usize::from(words > 0) + word.chars().count();
        if words > 0 && line.chars().count() + room > width {
            lines.push(std::mem::replace(&mut line, next.into()));
            words = 0;
        }
        if words > 0 {
            line.push(' ');
        }
        line.push_str(word);
        words += 1;
    }
    lines.push(line);
    lines
}

/// The width of each column of a table, in characters.
pub(crate) fn column_widths<'a>(rows: impl IntoIterator<Item = &'a [String]>) -> Vec<usize> {
    let mut widths = Vec::new();
    for row in rows {
        widths.resize(row.len().max(widths.len()), 0);
        for (width, cell) in widths.iter_mut().zip(row) {
            *width = cell.chars().count().max(*width);
        }
    }
    widths
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_stay_within_the_width() {
        let text = "word ".repeat(60);
        let lines = wrapped(&text, 50, "a: ", "   ");
        assert!(lines.len() > 2 && lines.iter().all(|l| l.chars().count() <= 50));
        assert_eq!(wrapped("one", 50, "  ", "    "), ["  one"]);
        assert_eq!(wrapped("one overlong", 5, "", "  "), ["one", "  overlong"]);
    }
}
