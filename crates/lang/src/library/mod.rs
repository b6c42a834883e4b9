//! Libraries of candidate terms: the set expressions of a model, expanded for one equation.
//!
//! In: a [`LibExpr`] with names resolved, and the equation's target. Out: a [`Library`] of distinct terms, or diagnostics. Sets stay
//! products of short lists from the expression to the library. So sizes are known by arithmetic before anything is made, and what
//! `symmetry` and `limit` statements exclude is never made. Knows nothing of data.

mod block;
mod block_layout;
mod candidates;
mod expansion;
mod generators;
mod grading;
mod library_errors;
mod pythagorean_identity;
mod readable;
mod scaling_unknowns;
mod sets;
mod slot_index;
mod summary;
#[cfg(test)]
mod tests;

use crate::diagnostic::Diagnostic;
use crate::model::{LibExpr, Model};
use crate::term::{Expr, Signal, Term};
use scaling_unknowns::scaling_unknowns;

pub use crate::thresholds::MEMORY;
pub use block::Block;
pub use candidates::Library;
pub use generators::generator::{Exponents, Generator, Misuse};
pub use generators::{GENERATORS, generator};
pub use grading::Grading;
pub use readable::{readable, readable_bytes};
pub use sets::selection_rule::restrictions;
pub use summary::{size, storage};

/// Expands the library of one equation. The libraries of all equations share `memory` bytes equally.
///
/// The target itself never becomes a candidate, and generators drop it from their atoms; notes say so. Terms that the model's
/// symmetries and degree limit exclude are left out; a note counts them.
///
/// The diagnostics hold errors for a library that does not fit (found by arithmetic), a misused generator, a `-` that removes
/// nothing, and a target that is hidden in its library by an identity. The library is then empty.
pub fn expand(
    model: &Model,
    target: Signal,
    written: &LibExpr,
    memory: u64,
) -> (Library, Vec<Diagnostic>) {
    let mut pass = expansion::Expansion::new(model, target, memory);
    let library = pass.library(written).and_then(|set| {
        let rule = sets::selection_rule::SelectionRule::of(model, target);
        let library = pass.lay_out(written, &set, &rule)?;
        let found = pythagorean_identity::check(model, target, written, &set, &rule);
        pass.diagnostics.extend(found);
        pass.diagnostics.extend(scaling_unknowns(model, &library));
        let required = pass.required_slots(written, &library)?;
        Some(library.requiring(required))
    });
    (library.unwrap_or_default(), pass.diagnostics)
}

/// The weighted terms of `known(…)` parts, added up: fixed (coefficient, term) pairs.
pub fn known_terms<'a>(parts: impl IntoIterator<Item = &'a Expr>) -> Vec<(f64, Term)> {
    let sum: Expr = parts.into_iter().cloned().sum();
    sum.terms().map(|(w, t)| (w, t.clone())).collect()
}
