//! Φ as an operator: what a solver may ask of a library on data, however it is stored.

mod dense;
mod factored;
mod strongest;
pub mod sums;

pub use dense::Dense;
pub use factored::{Block, Factored, NotFinite};
pub use strongest::{Collector, Strongest};
/// The matrix Φ (M rows, N columns) of a library on samples.
///
/// Columns are in model units, not normalised; [`Dictionary::norms`] gives their lengths. Entries are finite. A column of
/// length zero is never an answer: it may be a column of zeros, or a place that the library leaves empty.
pub trait Dictionary: Sync {
    /// M
    fn rows(&self) -> usize;
    /// N, empty places included.
    fn cols(&self) -> usize;
    /// ‖φ_j‖₂ of every column; length N.
    fn norms(&self) -> &[f64];
    /// Writes column `j` into `out` (length M).
    fn column(&self, j: usize, out: &mut [f64]);
    /// Prices every column with λ (length M) in one pass: those with |φ_jᵀλ|/‖φ_j‖ > `least`, counted, and the `most` largest.
    fn strongest(&self, lambda: &[f64], most: usize, least: f64) -> Strongest;
}
