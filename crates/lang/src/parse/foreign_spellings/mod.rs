//! Spellings of Python, MATLAB, Julia, Stan, Modelica and C, each with the line to copy.
//!
//! In: signs, statements or calls that the language does not have. Out: what the user meant, in this language. Parses nothing, and never
//! changes a text.

pub(crate) mod functions;
pub(super) mod punctuation;
pub(super) mod signs;
pub(super) mod statements;

use crate::diagnostic::Diagnostic;
use crate::source::Span;

/// `theirs` stands at a place where this language writes `ours`.
pub(crate) fn foreign(at: Span, theirs: &str, ours: &str) -> Diagnostic {
    foreign_because(at, theirs, &format!("write `{ours}`"))
        .help(format!("replace `{theirs}` by `{ours}`"))
        .fix(at, ours)
}

/// A foreign spelling, with the text of its label.
fn foreign_because(at: Span, theirs: &str, why: &str) -> Diagnostic {
    let message = format!("`{theirs}` belongs to another language");
    Diagnostic::error("foreign-spelling", message).at(at, why)
}
