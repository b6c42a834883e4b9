//! Libraries of candidate terms: the set expressions of a model, expanded for one equation.
//!
//! In: a [`LibExpr`] with names resolved, and the equation's target. Out: a [`Library`] of distinct terms, or diagnostics. Sets stay
//! products of short lists from the expression to the library, so sizes are known by arithmetic before anything is made, and what
//! `symmetry` and `limit` statements exclude is never made at all. Knows nothing of data.

mod count;
mod dependence;
mod errors;
mod expand;
mod generators;
mod graded;
mod index;
mod known;
mod layout;
mod list;
mod monomials;
mod product;
mod rule;
mod set;
mod size;
mod terms;
#[cfg(test)]
mod tests;

use crate::lang::diagnostic::Diagnostic;
use crate::lang::model::{LibExpr, Model, NumberArg};
use crate::lang::source::Span;
use crate::term::{Expr, Signal, Term};

pub use generators::GENERATORS;
pub use known::known_terms;
pub use rule::restrictions;
pub use size::{readable, readable_bytes};
pub use terms::{Block, Library};

/// Most terms of one list: of factors that share atoms, or of a generator that does not factor.
pub const MAX_LIST: u128 = 200_000;

/// Most products that a set may fall into.
const MAX_PRODUCTS: usize = 10_000;

/// Bytes that one library may take, if nothing else is said: 4 GB.
pub const MEMORY: u64 = 4_000_000_000;

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
    /// True if its atoms are angles, which have no unit.
    fn of_angles(&self) -> bool {
        false
    }
    /// How many terms `atoms` atoms give, by arithmetic alone; also checks the numbers.
    fn count(&self, atoms: usize, numbers: &[NumberArg]) -> Result<u128, Misuse>;
    /// For a generator of monomials: with which exponents. Its terms are then kept as products of the powers of each atom, and
    /// there may be millions; all others are listed.
    fn exponents(&self, _numbers: &[NumberArg]) -> Result<Option<Exponents>, Misuse> {
        Ok(None)
    }
    /// The terms, one by one; called only after [`Generator::count`] found the numbers good and few enough terms.
    fn expand(&self, atoms: &[Expr], numbers: &[NumberArg]) -> Result<Vec<Term>, Misuse>;
}

/// The exponents of monomials: each atom's from 0 to `each`, their sum within `total`, ends included.
#[derive(Clone, Copy, Debug)]
pub struct Exponents {
    pub each: u32,
    pub total: (u32, u32),
}

impl Exponents {
    /// Every exponent up to a cap, independently.
    pub fn each(cap: u32) -> Exponents {
        Exponents {
            each: cap,
            total: (0, u32::MAX),
        }
    }

    fn is_bounded(self) -> bool {
        self.total.1 != u32::MAX
    }
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

/// Expands the library of one equation; the libraries of all equations take `memory` bytes at most, with equal shares.
///
/// The bare target never becomes a column, and generators drop it from their atoms; both are said in a note. Terms that the model's
/// symmetries and degree limit exclude are left out, and counted in a note.
/// Errors: a library that does not fit (with the numbers, before anything is made), misused generators, a `-` that removes
/// nothing, the target itself hidden in the library by an identity.
pub fn expand(
    model: &Model,
    target: Signal,
    written: &LibExpr,
    memory: u64,
) -> (Library, Vec<Diagnostic>) {
    let mut pass = expand::Expansion::new(model, target, memory);
    let library = pass.library(written).and_then(|set| {
        let rule = rule::Rule::of(model, target);
        let library = pass.lay_out(written, &set, &rule)?;
        let found = dependence::check(model, target, written, &set, &rule);
        pass.diagnostics.extend(found);
        Some(library)
    });
    (library.unwrap_or_default(), pass.diagnostics)
}
