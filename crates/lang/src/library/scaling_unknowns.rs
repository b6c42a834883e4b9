//! Unknown constants that only scale a term: its coefficient would be sought twice.
//!
//! In: a model, the library of an equation. Out: an error for each such constant.

use crate::diagnostic::Diagnostic;
use crate::library::Library;
use crate::model::Model;
use crate::term::{Atom, Language, Signal, Term};

/// At most one for each constant.
pub fn scaling_unknowns(model: &Model, library: &Library) -> Vec<Diagnostic> {
    let one = |signal: Signal| {
        let scales = |t: &&Term| t.factors().any(|(a, _)| *a == Atom::Signal(signal));
        let blocks = library.blocks().iter();
        let mut terms = blocks.flat_map(|b| b.left.iter().chain(&b.right));
        let term = terms.find(scales)?;
        let rest = term.part(|a| *a != Atom::Signal(signal));
        let language = Language(model);
        let name = model.var(signal.var).map_or("", |v| v.name.as_str());
        let d = Diagnostic::error(
            "unknown-scales",
            format!("{name} only scales the term {}", language.term(term)),
        );
        let d = match model.var(signal.var).and_then(|v| v.span) {
            Some(span) => d.at(span, "declared here"),
            None => d,
        };
        let help = format!(
            "the coefficient of every term is sought anyway: write {} for {}",
            language.term(&rest),
            language.term(term)
        );
        Some(d.help(help))
    };
    let signals = model.unknowns.iter().map(|u| Signal::new(u.var));
    signals.filter_map(one).collect()
}
