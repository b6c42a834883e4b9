//! The transitions of one step of one interval, as `state_transition` makes them for many.
//!
//! In: the Jacobian at the start, the middle and the end of a step. Out: the transitions to its end.

use nalgebra::DMatrix;

/// From the start, from the middle, from the end itself. Runge–Kutta on T' = J T; the second half by exp(J h/2) to third order, J the mean
/// of the middle and the end.
pub(super) fn transitions([j0, j1, j2]: [&DMatrix<f64>; 3], h: f64) -> [DMatrix<f64>; 3] {
    let unit = DMatrix::<f64>::identity(j0.nrows(), j0.nrows());
    let k2 = j1 * (&unit + j0 * (0.5 * h));
    let k3 = j1 * (&unit + &k2 * (0.5 * h));
    let k4 = j2 * (&unit + &k3 * h);
    let whole = &unit + (j0 + (k2 + k3) * 2.0 + k4) * (h / 6.0);
    let mean = (j1 + j2) * (0.25 * h);
    let square = &mean * &mean;
    let half = &unit + &mean + &square * 0.5 + &square * &mean / 6.0;
    [whole, half, unit]
}
