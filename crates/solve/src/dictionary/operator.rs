//! Φ as an operator: what a solver may ask of a library on data, however it is stored.

use super::pricing::Priced;

/// The matrix Φ (M rows, N columns) of a library on samples.
///
/// Columns are in model units, not normalised. Entries are finite. A column of length zero is never an answer: it may be a column
/// of zeros, or a place that the library leaves empty.
pub trait Dictionary: Sync {
    /// M
    fn rows(&self) -> usize;
    /// N, empty places included.
    fn cols(&self) -> usize;
    /// ‖φ_j‖₂ of every column; length N.
    fn norms(&self) -> &[f64];
    /// Writes column `j` into `out` (length M).
    fn column(&self, j: usize, out: &mut [f64]);
    /// Prices every column with λ (length M) in one pass: counts those with |φ_jᵀλ|/‖φ_j‖ > `bound`, and returns the `most` largest.
    fn price(&self, lambda: &[f64], most: usize, bound: f64) -> Priced;
}
