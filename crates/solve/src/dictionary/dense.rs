//! Φ stored whole, column after column.

use super::grades::Grades;
use super::operator::Dictionary;
use super::pricing::{Priced, PricingCollector};
use crate::linalg::{correlation, norm, norm_from_squares};
use crate::threads;
use crate::thresholds::PARALLELISM;

/// A column-major M × N matrix with its column norms.
#[derive(Clone, Debug)]
pub struct Dense {
    rows: usize,
    values: Vec<f64>,
    norms: Vec<f64>,
}

impl Dense {
    /// `values` holds the columns one after another; its length is a multiple of `rows`.
    pub fn new(rows: usize, values: Vec<f64>) -> Self {
        debug_assert!(rows > 0 && values.len().is_multiple_of(rows));
        let norms = values.chunks_exact(rows.max(1)).map(norm).collect();
        Dense {
            rows,
            values,
            norms,
        }
    }

    /// `values` as for [`Dense::new`], with the sum of squares of each column.
    pub fn filled(rows: usize, values: Vec<f64>, squares: &[f64]) -> Self {
        let columns = values.chunks_exact(rows.max(1));
        let norms = squares.iter().zip(columns);
        let norms = norms.map(|(squares, column)| norm_from_squares(*squares, column));
        let norms = norms.collect();
        Dense {
            rows,
            values,
            norms,
        }
    }

    /// Column-major values, M · N of them.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    pub(super) fn price_on(
        &self,
        threads: usize,
        grades: Option<&Grades>,
        lambda: &[f64],
        (most, bound): (usize, f64),
    ) -> Priced {
        let rows = self.rows.max(1);
        let group = (PARALLELISM.dense_task / rows).max(1);
        let groups = self.values.chunks(group * rows).enumerate();
        let collectors = threads::share(threads, groups, |tasks| {
            let mut found = PricingCollector::new(most, bound);
            for (i, values) in tasks {
                for (j, column) in (i * group..).zip(values.chunks_exact(rows)) {
                    let correlation = correlation::<8>(column, self.norms[j], lambda);
                    let grade = grades.map_or(1.0, |g| g.of(j));
                    found.offer(j, correlation / grade);
                }
            }
            found
        });
        PricingCollector::finish_all(collectors)
    }
}

impl Dictionary for Dense {
    fn rows(&self) -> usize {
        self.rows
    }

    fn cols(&self) -> usize {
        self.norms.len()
    }

    fn norm(&self, j: usize) -> f64 {
        self.norms.get(j).copied().unwrap_or(0.0)
    }

    fn is_finite(&self) -> bool {
        self.norms.iter().all(|n| n.is_finite())
    }

    fn column(&self, j: usize, out: &mut [f64]) {
        out.copy_from_slice(&self.values[j * self.rows..(j + 1) * self.rows]);
    }

    fn price(&self, lambda: &[f64], most: usize, bound: f64) -> Priced {
        let threads = threads::threads_for(self.values.len());
        self.price_on(threads, None, lambda, (most, bound))
    }

    fn price_graded(&self, grades: &Grades, lambda: &[f64], most: usize, bound: f64) -> Priced {
        let threads = threads::threads_for(self.values.len());
        self.price_on(threads, Some(grades), lambda, (most, bound))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_answer_does_not_depend_on_the_number_of_threads() {
        let values: Vec<f64> = (0..300_000).map(|i| f64::from(i % 101 - 50)).collect();
        let phi = Dense::new(30, values);
        let lambda: Vec<f64> = (0..30).map(|i| f64::from(i % 7 - 3)).collect();
        let one = phi.price_on(1, None, &lambda, (20, 0.5));
        assert!(one.columns.len() == 20);
        for threads in [2, 3, 8] {
            assert_eq!(one, phi.price_on(threads, None, &lambda, (20, 0.5)));
        }
    }
}
