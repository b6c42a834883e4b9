//! Φ as an operator: what a solver may ask of a library on data, however it is stored.

mod compile;
mod dense;

pub use compile::{BadValue, compile, evaluate};
pub use dense::Dense;

/// The matrix Φ (M rows, N columns) of a library on samples.
///
/// Columns are in model units, not normalised; [`Dictionary::norms`] gives their lengths. Entries are finite.
pub trait Dictionary: Sync {
    /// M
    fn rows(&self) -> usize;
    /// N
    fn cols(&self) -> usize;
    /// ‖φ_j‖₂ of every column; length N.
    fn norms(&self) -> &[f64];
    /// Writes column `j` into `out` (length M).
    fn column(&self, j: usize, out: &mut [f64]);
    /// All correlations at once, `out = Φᵀ λ`: `lambda` has length M, `out` length N.
    fn correlate(&self, lambda: &[f64], out: &mut [f64]);
}
