//! Sets of terms as unions of products of short lists, and their algebra.
//!
//! In: terms. Out: sets that know their size and their members by arithmetic and look-ups on the factors. Lists are multiplied
//! out only where they share atoms. Layers, each on those before: lists, products, graded products, the selection rule of an
//! equation, inclusion and exclusion, unions, monomials.

pub(crate) mod combinatorics;
pub(crate) mod degree_bounded;
pub(crate) mod inclusion_exclusion;
pub(crate) mod monomials;
pub(crate) mod product;
pub(crate) mod selection_rule;
pub(crate) mod term_list;
pub(crate) mod term_set;
