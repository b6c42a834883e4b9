//! Steps of damped least squares.
//!
//! In: normal equations. Out: a step. Iterates nothing.

use nalgebra::{DMatrix, DVector};

/// The step of Levenberg and Marquardt, (N + damping · diag N) step = right; N is n × n, right of length n. Unknowns that move nothing stay. `None`
/// where N is not finite, or nothing moves anything.
pub fn damped_step(
    normal: &DMatrix<f64>,
    right: &DVector<f64>,
    damping: f64,
) -> Option<DVector<f64>> {
    let mut normal = normal.clone();
    let largest = normal.diagonal().amax();
    if largest.is_nan() || largest <= 0.0 {
        return None;
    }
    for i in 0..normal.nrows() {
        normal[(i, i)] += damping * normal[(i, i)] + f64::EPSILON * largest;
    }
    normal.cholesky().map(|c| c.solve(right))
}
