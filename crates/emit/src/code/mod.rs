//! Targets that are programs: Rust, C, Python, MATLAB, and SymPy expressions.
//!
//! In: a discovery. Out: source text. [`program`] decides what is computed and when, [`infix`] writes expressions,
//! [`printer`] writes statements; the file of a language holds what is particular to it.

mod bracket_lists;
pub(crate) mod c;
pub(crate) mod identifiers;
mod infix;
pub(crate) mod matlab;
mod printer;
mod program;
pub(crate) mod python;
pub(crate) mod rust;
pub(crate) mod sympy;

/// The helpers whose condition holds.
fn chosen(all: &[(bool, &str)]) -> String {
    let used = all.iter().filter(|(used, _)| *used);
    used.map(|(_, text)| *text).collect()
}
