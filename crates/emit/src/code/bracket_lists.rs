//! Lists in brackets, `[a, b]`: rows, matrices, arguments of solvers.
//!
//! In: nodes and signals of a body. Out: text of expressions, never statements.

use crate::code::infix::{Infix, Syntax};
use sidc_lang::term::Signal;

/// Longest list on one line, in characters.
pub(crate) const LINE_WIDTH: usize = 80;

pub(crate) fn list(all: &[String]) -> String {
    format!("[{}]", all.join(", "))
}

/// Names to unpack a list into; `_` for values that nothing uses.
pub(crate) fn unpacked_names<S: Syntax>(infix: &Infix<S>, all: &[Option<Signal>]) -> String {
    let name = |s: &Option<Signal>| s.map_or_else(|| "_".to_string(), |s| infix.signal(s));
    list(&all.iter().map(name).collect::<Vec<_>>())
}

/// `solver(mass, right)`. Matrices that do not fit on a line get one line for each row.
pub(crate) fn solver_call<S: Syntax>(
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
    if short_mass.len() + short_right.len() < LINE_WIDTH {
        return format!("{solver}({short_mass}, {short_right})");
    }
    let matrix = |rows: &[String], short: &str| match short.len() < LINE_WIDTH {
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
