//! Pricing: the columns of largest correlation with a dual point, selected while correlations are computed.
//!
//! In: correlations in any order. Out: the largest, and how many exceed a bound. Only the answer is kept in memory.

use std::cmp::Ordering;

use crate::simd::wide;

/// Columns compared at once, without branches.
const LANES: usize = 8;
/// Slightly below one, by more than the rounding of a product and a quotient.
const BELOW: f64 = 1.0 - 1e-14;

/// Columns whose correlation with λ exceeds a bound.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Priced {
    /// (column, φ_jᵀλ/‖φ_j‖ with its sign), largest magnitude first, equal ones by column.
    pub columns: Vec<(usize, f64)>,
    /// How many exceed the bound in all.
    pub count: usize,
}

impl Priced {
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
    /// Magnitudes below this are counted, not kept.
    threshold: f64,
    count: usize,
    kept: Vec<(usize, f64)>,
}

impl PricingCollector {
    /// For the `most` largest magnitudes that exceed `bound`.
    pub fn new(most: usize, bound: f64) -> PricingCollector {
        PricingCollector {
            most,
            bound,
            threshold: bound,
            count: 0,
            kept: Vec::new(),
        }
    }

    /// Takes one column's correlation. NaN exceeds no bound.
    #[inline]
    pub fn offer(&mut self, column: usize, correlation: f64) {
        let size = correlation.abs();
        if size > self.bound {
            self.count += 1;
            if size >= self.threshold && self.most > 0 {
                self.keep(column, correlation);
            }
        }
    }

    /// Takes consecutive columns: φ_jᵀλ from column `first` on, and ‖φ_j‖. Columns of length zero are skipped.
    pub fn offer_all(&mut self, first: usize, products: &[f64], norms: &[f64]) {
        let (groups, few) = products.as_chunks::<LANES>();
        let (group_norms, few_norms) = norms.as_chunks::<LANES>();
        let columns = (first..).step_by(LANES);
        wide(|| {
            for (column, (products, norms)) in columns.zip(groups.iter().zip(group_norms)) {
                if self.is_near(products, norms) {
                    self.offer_group(column, products, norms);
                }
            }
        });
        let columns = first + groups.len() * LANES..;
        for (column, (product, norm)) in columns.zip(few.iter().zip(few_norms)) {
            self.offer(column, quotient(*product, *norm));
        }
    }

    /// Whether a column may exceed the bound. Most groups exceed none; they are compared without a division.
    #[inline(always)]
    fn is_near(&self, products: &[f64; LANES], norms: &[f64; LANES]) -> bool {
        let least = self.bound.max(0.0) * BELOW;
        let near = |k: usize| products[k].abs() >= least * norms[k];
        let near: [bool; LANES] = std::array::from_fn(near);
        near.iter().fold(false, |any, n| any | n)
    }

    /// Correlations of a group. Those below the threshold are only counted.
    #[inline(always)]
    fn offer_group(&mut self, first: usize, products: &[f64; LANES], norms: &[f64; LANES]) {
        // Divide first, then select: no branch.
        let quotients: [f64; LANES] = std::array::from_fn(|k| products[k] / norms[k]);
        let chosen = |k| {
            if norms[k] > 0.0 {
                quotients[k]
            } else {
                f64::NAN
            }
        };
        let correlations: [f64; LANES] = std::array::from_fn(chosen);
        let sizes = correlations.map(f64::abs);
        let kept: usize = sizes
            .iter()
            .map(|s| usize::from(*s >= self.threshold))
            .sum();
        if self.most == 0 || kept == 0 {
            let over = sizes.iter().map(|s| usize::from(*s > self.bound));
            self.count += over.sum::<usize>();
            return;
        }
        for (column, correlation) in (first..).zip(correlations) {
            self.offer(column, correlation);
        }
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
        self.count += other.count;
        for (column, correlation) in other.kept {
            self.keep(column, correlation);
        }
    }

    pub fn finish(mut self) -> Priced {
        self.kept.sort_unstable_by(by_magnitude);
        self.kept.truncate(self.most);
        Priced {
            columns: self.kept,
            count: self.count,
        }
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

/// φ_jᵀλ/‖φ_j‖; NaN, which exceeds no bound, for a column of length zero.
#[inline]
fn quotient(product: f64, norm: f64) -> f64 {
    if norm > 0.0 { product / norm } else { f64::NAN }
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
        assert_eq!(
            forwards.count,
            values.iter().filter(|v| v.abs() > 10.0).count()
        );
    }

    #[test]
    fn many_at_once_are_the_same_as_one_by_one() {
        let products: Vec<f64> = (0..1003).map(|i| f64::from(i * 37 % 101 - 50)).collect();
        let norms: Vec<f64> = (0..1003).map(|i| f64::from(i % 5)).collect();
        for (most, bound) in [(0, 3.0), (7, 10.0), (9, 0.0), (2000, 1.0), (3, -1.0)] {
            let (mut a, mut b) = (
                PricingCollector::new(most, bound),
                PricingCollector::new(most, bound),
            );
            for (j, (p, n)) in products.iter().zip(&norms).enumerate() {
                if *n > 0.0 {
                    a.offer(j, p / n);
                }
            }
            b.offer_all(0, &products[..501], &norms[..501]);
            b.offer_all(501, &products[501..], &norms[501..]);
            assert_eq!(a.finish(), b.finish());
        }
    }

    #[test]
    fn zero_and_nan_exceed_no_bound() {
        let mut c = PricingCollector::new(0, 0.0);
        c.offer(0, f64::NAN);
        c.offer(1, 0.0);
        c.offer(2, 3.0);
        let found = c.finish();
        assert!(found.columns.is_empty() && found.count == 1);
    }
}
