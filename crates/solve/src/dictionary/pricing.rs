//! Pricing: the columns of largest correlation with a dual point, selected while correlations are computed.
//!
//! In: correlations in any order. Out: the largest of those that exceed a bound. Only the answer is kept in memory.

use std::cmp::Ordering;

/// The columns of largest correlation with λ, of those where it exceeds a bound.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Priced {
    /// (column, φ_jᵀλ/‖φ_j‖ with its sign), largest magnitude first, equal ones by column.
    pub columns: Vec<(usize, f64)>,
}

impl Priced {
    /// Whether no column exceeds the bound.
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// The largest magnitude, or zero.
    pub fn largest(&self) -> f64 {
        self.columns.first().map_or(0.0, |(_, c)| c.abs())
    }
}

/// Collects a [`Priced`]; the order of correlations does not matter.
#[derive(Clone, Debug)]
pub struct PricingCollector {
    most: usize,
    bound: f64,
    /// Magnitudes below this are not among the largest.
    threshold: f64,
    kept: Vec<(usize, f64)>,
}

impl PricingCollector {
    /// For the `most` largest magnitudes that exceed `bound`; `most` is 1 or more.
    pub fn new(most: usize, bound: f64) -> PricingCollector {
        PricingCollector {
            most: most.max(1),
            bound,
            threshold: bound,
            kept: Vec::new(),
        }
    }

    /// Takes one column's correlation. NaN exceeds no bound.
    #[inline]
    pub fn offer(&mut self, column: usize, correlation: f64) {
        let size = correlation.abs();
        if size > self.bound && size >= self.threshold {
            self.keep(column, correlation);
        }
    }

    /// What a magnitude must reach to be kept; it grows.
    pub(super) fn threshold(&self) -> f64 {
        self.threshold
    }

    /// Merges collectors with the same bounds.
    pub fn finish_all(collectors: impl IntoIterator<Item = PricingCollector>) -> Priced {
        let together = collectors.into_iter().reduce(|mut all, next| {
            all.absorb(next);
            all
        });
        together.map_or_else(Priced::default, PricingCollector::finish)
    }

    /// Adds what another collector with the same bounds has taken.
    pub fn absorb(&mut self, other: PricingCollector) {
        for (column, correlation) in other.kept {
            self.keep(column, correlation);
        }
    }

    pub fn finish(mut self) -> Priced {
        self.kept.sort_unstable_by(by_magnitude);
        self.kept.truncate(self.most);
        Priced { columns: self.kept }
    }

    fn keep(&mut self, column: usize, correlation: f64) {
        self.kept.push((column, correlation));
        if self.kept.len() >= 2 * self.most + 64 {
            self.kept
                .select_nth_unstable_by(self.most - 1, by_magnitude);
            self.kept.truncate(self.most);
            self.threshold = self.kept.last().map_or(self.threshold, |(_, c)| c.abs());
        }
    }
}

fn by_magnitude(a: &(usize, f64), b: &(usize, f64)) -> Ordering {
    b.1.abs().total_cmp(&a.1.abs()).then_with(|| a.0.cmp(&b.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_come_first_whatever_the_order() {
        let values: Vec<f64> = (0..1000).map(|i| f64::from(i * 37 % 101 - 50)).collect();
        let collect = |order: &mut dyn Iterator<Item = usize>| {
            let (mut a, mut b) = (
                PricingCollector::new(7, 10.0),
                PricingCollector::new(7, 10.0),
            );
            for j in order {
                if j % 3 == 0 { &mut a } else { &mut b }.offer(j, values[j]);
            }
            a.absorb(b);
            a.finish()
        };
        let forwards = collect(&mut (0..1000));
        assert_eq!(forwards, collect(&mut (0..1000).rev()));
        assert_eq!(forwards.columns.len(), 7);
        assert!(forwards.columns.iter().all(|(_, c)| c.abs() == 50.0));
        assert!(forwards.columns.is_sorted_by(|a, b| a.0 < b.0));
    }

    #[test]
    fn zero_and_nan_exceed_no_bound() {
        let mut c = PricingCollector::new(2, 0.0);
        c.offer(0, f64::NAN);
        c.offer(1, 0.0);
        c.offer(2, 3.0);
        assert_eq!(c.finish().columns, [(2, 3.0)]);
    }
}
