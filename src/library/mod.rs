//! Libraries of candidate terms: the set expressions of a model, expanded for one equation.
//!
//! In: a [`LibExpr`] with names resolved, and the equation's target. Out: a [`Library`] of distinct terms, simplest first, or
//! diagnostics. Sizes are known by arithmetic before anything is expanded. Knows nothing of data.

mod dependence;
mod errors;
mod expand;
mod generators;
mod known;
mod size;
mod terms;

use crate::lang::diagnostic::Diagnostic;
use crate::lang::model::{LibExpr, Model, NumberArg};
use crate::lang::source::Span;
use crate::term::{Expr, Signal, Term};

pub use generators::GENERATORS;
pub use known::known_terms;
pub use terms::{Block, Library};

/// Most terms of one library while Φ is stored whole.
pub const MAX_TERMS: u128 = 200_000;

/// A family of terms made from atoms and numbers: one file and one line in [`GENERATORS`].
pub trait Generator: Sync {
    fn name(&self) -> &'static str;
    /// How it is written, e.g. `poly(atoms; degree)`.
    fn usage(&self) -> &'static str;
    /// One line for listings.
    fn about(&self) -> &'static str;
    /// True if its terms exist only between samples of discrete time.
    fn discrete_only(&self) -> bool {
        false
    }
    /// How many terms `atoms` atoms give, by arithmetic alone; also checks the numbers.
    fn count(&self, atoms: usize, numbers: &[NumberArg]) -> Result<u128, Misuse>;
    /// The terms; called only after [`Generator::count`] found the numbers good and few enough terms.
    fn expand(&self, atoms: &[Expr], numbers: &[NumberArg]) -> Result<Vec<Term>, Misuse>;
}

/// A generator used wrongly: what is wrong, at a number if it is one number's fault, and how to write it.
#[derive(Clone, Debug)]
pub struct Misuse {
    pub message: String,
    pub at: Option<Span>,
    pub help: String,
}

/// Looks a generator up by name.
pub fn generator(name: &str) -> Option<&'static dyn Generator> {
    GENERATORS.iter().copied().find(|g| g.name() == name)
}

/// Expands the library of one equation.
///
/// The bare target never becomes a column, and generators drop it from their atoms; both are said in a note.
/// Errors: too many terms (with the count, before expansion), misused generators, a `-` that removes nothing, the target itself
/// hidden in the library by an identity.
pub fn expand(model: &Model, target: Signal, library: &LibExpr) -> (Library, Vec<Diagnostic>) {
    let mut pass = expand::Expansion::new(model, target);
    let terms = pass.library(library).unwrap_or_default();
    let library_found = Library::listed(terms);
    pass.diagnostics
        .extend(dependence::check(model, target, library, &library_found));
    (library_found, pass.diagnostics)
}
