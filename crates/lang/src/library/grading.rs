//! Gradings: the weight of a term in the 1-norm beyond the length of its column.
//!
//! In: a term. Out: its grade. The grade of a product is the product of its factors' grades.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::term::{Atom, Term};
use crate::thresholds::LIBRARY;

/// A grading of the 1-norm: a term weighs κ^d times the length of its column, d its degree.
///
/// In coupled implicit systems a law plus multiples of the other laws also holds, and can have a smaller 1-norm than the law. Multiples
/// have a higher degree, so a weight that grows with the degree prevents this.
#[derive(Clone, Debug, PartialEq)]
pub struct Grading {
    /// κ > 0; 1 is the plain norm.
    pub base: f64,
    /// How much each power of a factor adds to the degree: 1 for factors that are not listed, and for all with `None`.
    pub counts: Option<Arc<BTreeMap<Atom, f64>>>,
    /// Each power of this factor multiplies the weight by `LIBRARY.penalty`, so that its terms are selected only if nothing else fits.
    pub penalized: Option<Atom>,
}

impl Grading {
    /// The plain norm: the weight of a term is the length of its column.
    pub const PLAIN: Grading = Grading {
        base: 1.0,
        counts: None,
        penalized: None,
    };

    pub fn is_plain(&self) -> bool {
        self.base == 1.0
    }

    /// κ^d, times the weight of the penalized factor.
    pub fn of(&self, term: &Term) -> f64 {
        let count = |atom: &Atom| {
            let counted = self.counts.as_ref().and_then(|c| c.get(atom));
            counted.copied().unwrap_or(1.0)
        };
        let degree = |(atom, power): (&Atom, f64)| count(atom) * power.abs();
        let powers = |(atom, power): (&Atom, f64)| match self.penalized.as_ref() == Some(atom) {
            true => power.abs(),
            false => 0.0,
        };
        let powers: f64 = term.factors().map(powers).sum();
        self.base.powf(term.factors().map(degree).sum()) * LIBRARY.penalty.powf(powers)
    }
}

impl Default for Grading {
    fn default() -> Grading {
        Grading::PLAIN
    }
}
