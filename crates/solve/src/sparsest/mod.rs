//! The fewest columns that fit within ε, proved by branch and bound over cuts.
//!
//! In: a [`Problem`], supports to begin with, limits. Out: a support of fewest columns with a lower bound on their number, and the
//! other supports of that size. Never sees names, never judges whether fewer terms are better ones.
//!
//! Every λ with yᵀλ > ε‖λ‖ that is orthogonal to the columns of a set U proves that U alone does not fit: each fit has a column
//! outside U. The columns outside are a *cut*. Disjoint cuts bound the size of a support from below; a cut of one column is a
//! column that every fit has; where as many disjoint cuts as free places are known, all columns outside them are dismissed at once.
//! The search branches on the smallest cut (cocircuits: Jokar & Pfetsch 2008, SIAM J. Sci. Comput. 31; hitting sets: Moreno-Centeno
//! & Karp 2013, Oper. Res. 61). Sizes are tried from the smallest on, so that every level that was completed is a true bound.

mod columns;
mod cuts;
mod dual_basis;
mod leaves;
mod node;
mod pairs;
mod search;
mod start;
#[cfg(test)]
mod tests;

pub use search::{SparsestLimits, fits, prove_sparsest};

/// The sparsest fit, as far as it is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Sparsest {
    /// The support of fewest columns that was found to fit within ε, rising; `None` where none was found.
    pub support: Option<Vec<usize>>,
    /// No fit within ε has fewer columns than this, under the assumption.
    pub lower: usize,
    /// The assumption: |a_j|‖φ_j‖ of no term exceeds so many times ‖y‖. It is what makes nearly dependent columns decidable.
    pub largest_share: f64,
    /// Other supports of the same size that fit, in their order.
    pub others: Vec<Vec<usize>>,
    /// Whether `others` holds all of them, under the assumption.
    pub all_others: bool,
    /// Nodes of the search.
    pub nodes: usize,
    /// Why no search was made: a sentence for users.
    pub refused: Option<String>,
}

impl Sparsest {
    /// Whether no fit has fewer columns than `support`.
    pub fn proved(&self) -> bool {
        self.support.as_ref().is_some_and(|s| s.len() <= self.lower)
    }
}
