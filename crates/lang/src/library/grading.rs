//! Gradings: how much more than its column's length a term weighs in the 1-norm.
//!
//! In: a term. Out: its grade κ^degree. The grade of a product is the product of its factors' grades.

use crate::term::Term;

/// A grading of the 1-norm: a term weighs κ^degree times the length of its column.
///
/// In coupled implicit systems a law plus multiples of the other laws holds as well, and can have a smaller 1-norm than the law.
/// Multiples have a higher degree, so a weight that grows with the degree takes that away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grading {
    /// κ > 0; 1 is the plain norm.
    pub base: f64,
}

impl Default for Grading {
    fn default() -> Grading {
        Grading::PLAIN
    }
}

impl Grading {
    /// The plain norm: a term weighs as much as its column is long.
    pub const PLAIN: Grading = Grading { base: 1.0 };

    pub fn is_plain(&self) -> bool {
        self.base == 1.0
    }

    /// κ^degree
    pub fn of(&self, term: &Term) -> f64 {
        self.base.powf(term.degree())
    }
}
