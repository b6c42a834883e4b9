//! Φ as an operator: what a solver may ask of a library on data, however it is stored.

use super::grades::Grades;
use super::pricing::{Priced, PricingCollector};
use crate::linalg::scaled_dot;

/// The matrix Φ (M rows, N columns) of a library on samples.
///
/// Columns are in model units, not normalised. Entries are finite. A column of length zero is never an answer: it may be a column
/// of zeros, or a place that the library leaves empty.
pub trait Dictionary: Sync {
    /// M
    fn rows(&self) -> usize;
    /// N, empty places included.
    fn cols(&self) -> usize;
    /// ‖φ_j‖₂ of column `j`, in up to 2 M operations; zero past the last column.
    fn norm(&self, j: usize) -> f64;
    /// Whether all norms are numbers.
    fn is_finite(&self) -> bool;
    /// w_j, the weight of column `j` in the 1-norm: ‖φ_j‖, and more where columns are [`super::Graded`]. Zero past the last column.
    fn weight(&self, j: usize) -> f64 {
        self.norm(j)
    }
    /// Writes column `j` into `out` (length M).
    fn column(&self, j: usize, out: &mut [f64]);
    /// Prices every column with λ (length M) in one pass: the `most` largest |φ_jᵀλ|/w_j of those above `bound`. `most` is 1 or more.
    fn price(&self, lambda: &[f64], most: usize, bound: f64) -> Priced;
    /// The same under grades: w_j = g_j ‖φ_j‖.
    fn price_graded(&self, grades: &Grades, lambda: &[f64], most: usize, bound: f64) -> Priced {
        let mut found = PricingCollector::new(most, bound);
        let mut column = vec![0.0; self.rows()];
        for j in 0..self.cols() {
            let length = self.norm(j);
            self.column(j, &mut column);
            if length > 0.0 {
                found.offer(j, scaled_dot(&column, length, lambda) / grades.of(j));
            }
        }
        found.finish()
    }
}
