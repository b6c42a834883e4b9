//! The `.sid` language: text → ast → checked model, with diagnostics that carry places.
//!
//! [`compile`] is the whole flow: `parse` builds the statements, `check` resolves names into a [`model::Model`]. `library` expands
//! its sets of candidate terms, `term` holds the expressions themselves, `units` their units, `render` shows what went wrong.
//! Knows nothing of data, numerical methods or solvers; opens no file.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod added_state;
pub mod ast;
mod check;
pub mod diagnostic;
mod fixes;
mod format;
pub mod includes;
pub mod library;
pub mod model;
pub mod number;
pub mod parse;
pub mod render;
mod reset;
pub mod sensor_noise;
pub mod source;
pub mod term;
mod thresholds;
pub mod units;
mod unknown_constant;
pub mod words;

pub use check::{GeneratorSignature, Vocabulary, check};
pub use format::format;
pub use parse::parse;
pub use render::render;

pub use thresholds::tables as thresholds;

use diagnostic::Diagnostic;
use model::Model;
use source::{FileId, Sources, Span};

/// Parses and checks one model, with the included files that [`includes::load`] has read. The model is `None` exactly if a diagnostic is an
/// error. Diagnostics are sorted by severity, then place.
pub fn compile(
    id: FileId,
    sources: &Sources,
    vocabulary: &Vocabulary,
) -> (Option<Model>, Vec<Diagnostic>) {
    let (file, mut found) = includes::parse_all(id, sources);
    let (model, more) = check(&file, vocabulary);
    found.extend(more);
    fixes::complete(&mut found, &file);
    found.sort_by_key(|d| (d.severity, place(d, id)));
    let failed = found.iter().any(Diagnostic::is_error);
    (model.filter(|_| !failed), found)
}

/// The first primary place of a diagnostic, in bytes, with those in the model's own text first; the beginning of the text if it has none.
fn place(d: &Diagnostic, own: FileId) -> (Option<FileId>, usize) {
    let primary = d.labels.iter().filter(|l| l.primary);
    let place = |s: Span| ((s.file != own).then_some(s.file), s.start);
    primary.map(|l| place(l.span)).min().unwrap_or_default()
}
