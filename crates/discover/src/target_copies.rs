//! Candidate terms that are the target itself in other words: `max(dx, -1000)`, `dx*exp(x)*exp(-x)`.
//!
//! In: candidates that contain the target, the rows. Out: those in proportion to the target on all rows. Such a term explains the
//! target by itself, whatever the law is, so it is no candidate. Never judges a term without the target in it.

use crate::dictionary::evaluate;
use crate::thresholds::TARGET_COPIES;
use sidc_data::Samples;
use sidc_lang::library::Library;
use sidc_lang::term::{Signal, Term};

/// A term in proportion to the target of its own equation.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetCopy {
    /// Place of the equation in the model.
    pub equation: usize,
    /// Slot of the term in the library.
    pub slot: usize,
    pub term: Term,
}

/// Sums over rows from which the angle between a column and the target follows.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Products {
    column: f64,
    target: f64,
    mixed: f64,
}

impl Products {
    pub fn add(&mut self, column: &[f64], target: &[f64]) {
        for (v, y) in column.iter().zip(target) {
            self.column += v * v;
            self.target += y * y;
            self.mixed += v * y;
        }
    }

    /// Whether the column is proportional to the target: the sine of the angle between them is at most `part`, or rounding.
    pub fn parallel(&self, part: f64) -> bool {
        let both = self.column * self.target;
        let sine = 1.0 - self.mixed * self.mixed / both;
        both > 0.0 && sine <= part.max(TARGET_COPIES.rounding).powi(2)
    }
}

/// The copies of the target in the library of one equation. Libraries too large to be looked through have none.
pub fn copies_in_samples(
    equation: usize,
    target: Signal,
    library: &Library,
    samples: &Samples,
) -> Vec<TargetCopy> {
    let far = library.len() > TARGET_COPIES.max_terms || !library.signals().contains(&target);
    let Some(y) = samples.column(target).filter(|_| !far) else {
        return Vec::new();
    };
    let copy = |(slot, term): (usize, Term)| {
        if !term.mentions(target) {
            return None;
        }
        let mut sums = Products::default();
        sums.add(&evaluate(&term, samples), &y.values);
        sums.parallel(0.0).then_some(TargetCopy {
            equation,
            slot,
            term,
        })
    };
    library.terms().filter_map(copy).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_in_proportion_is_parallel() {
        let y = [1.0, -2.0, 3.0, 0.5];
        let mut same = Products::default();
        same.add(&y.map(|y| -7.0 * y), &y);
        assert!(same.parallel(0.0));
        let mut near = Products::default();
        near.add(&[1.001, -2.0, 3.0, 0.5], &y);
        assert!(!near.parallel(0.0) && near.parallel(0.01));
        let mut zero = Products::default();
        zero.add(&[0.0; 4], &y);
        assert!(!zero.parallel(0.5));
    }
}
