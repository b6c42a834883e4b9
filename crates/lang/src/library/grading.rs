//! Gradings: how much more than its column's length a term weighs in the 1-norm.
//!
//! In: a term. Out: its grade. The grade of a product is the product of its factors' grades.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::term::{Atom, Term};

/// A grading of the 1-norm: a term weighs κ^d times the length of its column, d its degree.
///
/// In coupled implicit systems a law plus multiples of the other laws holds as well, and can have a smaller 1-norm than the law.
/// Multiples have a higher degree, so a weight that grows with the degree takes that away.
#[derive(Clone, Debug, PartialEq)]
pub struct Grading {
    /// κ > 0; 1 is the plain norm.
    pub base: f64,
    /// How much of a degree each power of a factor counts; `None` counts 1 for all. A factor that is not listed counts 1.
    pub counts: Option<Arc<BTreeMap<Atom, f64>>>,
    /// A factor whose terms weigh [`Grading::DEAR`] times as much for each power: they come in only where nothing else fits.
    pub penalized: Option<Atom>,
}

impl Grading {
    /// The plain norm: a term weighs as much as its column is long.
    pub const PLAIN: Grading = Grading {
        base: 1.0,
        counts: None,
        penalized: None,
    };
    /// What a power of a dear factor weighs: more than coefficients of laws differ, and little enough to be computed with.
    pub const DEAR: f64 = 1e5;

    pub fn is_plain(&self) -> bool {
        self.base == 1.0
    }

    /// κ^d, times what dear factors weigh
    pub fn of(&self, term: &Term) -> f64 {
        let count = |atom: &Atom| {
            let counted = self.counts.as_ref().and_then(|c| c.get(atom));
            counted.copied().unwrap_or(1.0)
        };
        let degree = |(atom, power): (&Atom, f64)| count(atom) * power.abs();
        let dear = |(atom, power): (&Atom, f64)| match self.penalized.as_ref() == Some(atom) {
            true => power.abs(),
            false => 0.0,
        };
        let dear: f64 = term.factors().map(dear).sum();
        self.base.powf(term.factors().map(degree).sum()) * Grading::DEAR.powf(dear)
    }
}

impl Default for Grading {
    fn default() -> Grading {
        Grading::PLAIN
    }
}
