//! Unknown constants that only scale a term, so that its coefficient would be estimated twice.
//!
//! In: a model, the library of an equation. Out: an error for each such constant.

use crate::diagnostic::Diagnostic;
use crate::library::Library;
use crate::model::{Model, RightSide, UnknownConstant};
use crate::term::{Atom, Language, Signal, Term};

/// At most one error for each constant.
pub fn scaling_unknowns(model: &Model, library: &Library) -> Vec<Diagnostic> {
    let one = |unknown: &UnknownConstant| {
        let signal = Signal::new(unknown.var);
        if unknown.per_run && is_identifiable_elsewhere(model, library, signal) {
            return None;
        }
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
        let by_run = format!(
            ", and say `coef(TARGET, {}) : per run`; or state the coefficient: known({})",
            language.term(&rest),
            language.term(term)
        );
        let by_run = if unknown.per_run {
            by_run
        } else {
            String::new()
        };
        Some(d.help(help + &by_run))
    };
    model.unknowns.iter().filter_map(one).collect()
}

/// Whether a constant occurs in a known part or inside a factor. If it differs from run to run, it is then more than a coefficient by run.
fn is_identifiable_elsewhere(model: &Model, library: &Library, signal: Signal) -> bool {
    let known = model.equations.iter().any(|e| match &e.right {
        RightSide::Known(e) => e.mentions(signal),
        RightSide::Search { known, .. } => known.iter().any(|(e, _)| e.mentions(signal)),
    });
    let inside = |t: &Term| {
        let mut atoms = t.factors().map(|(a, _)| a);
        atoms.any(|a| *a != Atom::Signal(signal) && Term::atom(a.clone()).mentions(signal))
    };
    known || library.factors().any(inside)
}
