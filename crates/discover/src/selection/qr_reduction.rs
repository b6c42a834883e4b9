//! A least-squares problem reduced by QR to as many rows as columns.
//!
//! In: a problem [A | y]. Out: an equivalent one, and the part of ‖y‖² that no column reaches.

use nalgebra::DMatrix;
use sidc_solve::linalg::Qr;

/// The last column of the problem is y. The squared norm is that of y off the span of the other columns, 0 if nothing was reduced.
pub(crate) fn qr_reduction(problem: DMatrix<f64>) -> (DMatrix<f64>, f64) {
    let n = problem.ncols() - 1;
    if problem.nrows() <= n + 1 {
        return (problem, 0.0);
    }
    let r = Qr::new(problem).r;
    let outside = r[(n, n)].powi(2);
    (r.remove_row(n), outside)
}
