//! The fewest columns that fit within ε, proved by branch and bound over cuts.
//!
//! In: a [`Problem`], supports to begin with, limits. Out: a support of fewest columns with a lower bound on their number, and the
//! other supports of that size. Never sees names; never judges whether fewer terms are better.
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
mod sparsest_fit;
mod start;
#[cfg(test)]
mod tests;

pub use search::{SparsestLimits, fits, prove_sparsest};
pub use sparsest_fit::Sparsest;
