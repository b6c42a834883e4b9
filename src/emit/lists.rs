//! Lists in brackets, for languages that write them as `[a, b]`: rows, matrices, calls of a solver.
//!
//! In: nodes and signals of a body. Out: text. Never writes a statement.

use super::infix::{Infix, Syntax};
use crate::term::Signal;

/// Longest list that stays on one line.
pub(super) const SHORT: usize = 80;

pub(super) fn list(all: &[String]) -> String {
    format!("[{}]", all.join(", "))
}

/// Names to unpack a list into, `_` where nobody asks.
pub(super) fn wanted<S: Syntax>(infix: &Infix<S>, all: &[Option<Signal>]) -> String {
    let name = |s: &Option<Signal>| s.map_or_else(|| "_".to_string(), |s| infix.signal(s));
    list(&all.iter().map(name).collect::<Vec<_>>())
}

/// `solver(mass, right)`; matrices that do not fit on a line have a line a row.
pub(super) fn solver_call<S: Syntax>(
    solver: &str,
    infix: &Infix<S>,
    (mass, right): (&[Vec<usize>], &[Vec<usize>]),
    indent: &str,
) -> String {
    let rows = |rows: &[Vec<usize>]| -> Vec<String> {
        rows.iter().map(|row| list(&infix.texts(row))).collect()
    };
    let (mass, right) = (rows(mass), rows(right));
    let (short_mass, short_right) = (list(&mass), list(&right));
    if short_mass.len() + short_right.len() < SHORT {
        return format!("{solver}({short_mass}, {short_right})");
    }
    let matrix = |rows: &[String], short: &str| match short.len() < SHORT {
        true => format!("{indent}    {short},\n"),
        false => {
            let line = |row: &String| format!("{indent}        {row},\n");
            let lines: String = rows.iter().map(line).collect();
            format!("{indent}    [\n{lines}{indent}    ],\n")
        }
    };
    format!(
        "{solver}(\n{}{}{indent})",
        matrix(&mass, &short_mass),
        matrix(&right, &short_right)
    )
}
