//! Layout of sums: one line where it fits, else a line for each term.

use sidc_lang::number::significant;
use sidc_lang::term::{Language, Precedence, Term, write_term};
use sidc_system::discovery::Discovery;

/// Widest line, in characters.
pub(crate) const LINE_WIDTH: usize = 100;

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
    let size = significant(coefficient.abs(), 6);
    let (text, binds) = write_term(&Language(d), term);
    let text = match (term.is_one(), size.as_str()) {
        (true, _) => size,
        (_, "1") if binds >= Precedence::Product => text,
        _ if binds < Precedence::Product => format!("{size}*({text})"),
        _ => format!("{size}*{text}"),
    };
    (coefficient < 0.0, text)
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
