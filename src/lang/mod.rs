//! The `.sid` language: text → ast → checked model, with diagnostics that carry places.
//!
//! Knows nothing of data, numbers or solvers.

pub mod ast;
mod check;
pub mod diagnostic;
mod excerpt;
mod format;
pub mod model;
pub mod parse;
pub mod render;
pub mod source;

pub use check::{GeneratorSignature, Vocabulary, check};
pub use format::format;
pub use parse::parse;
pub use render::render;

use diagnostic::Diagnostic;
use model::Model;
use source::{FileId, Sources};

/// Parses and checks one model. It is `None` only if there are errors.
pub fn compile(
    id: FileId,
    sources: &Sources,
    vocabulary: &Vocabulary,
) -> (Option<Model>, Vec<Diagnostic>) {
    let text = sources.get(id).map_or("", |s| s.text.as_str());
    let (file, mut found) = parse(id, text);
    let (model, more) = check(&file, vocabulary);
    found.extend(more);
    found.sort_by_key(|d| (d.severity, place(d)));
    let failed = found.iter().any(Diagnostic::is_error);
    (model.filter(|_| !failed), found)
}

/// Where a finding stands in its text.
fn place(d: &Diagnostic) -> usize {
    let primary = d.labels.iter().filter(|l| l.primary);
    primary.map(|l| l.span.start).min().unwrap_or(0)
}
