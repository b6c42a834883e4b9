//! Numbers that decide how least squares go down.

use sidc_thresholds::Table;

sidc_thresholds::family! {
    /// Damping of least squares, of each unknown's own curvature.
    pub DAMPING: Damping {
        /// Of the first step.
        first: f64 = 1e-3, unit "of the curvature", source "Marquardt, J. SIAM 11 (1963) begins with 1e-2";
        /// Factor by which it falls after a step that leads down and rises after any other.
        factor: f64 = 10.0, unit "", source "Marquardt, J. SIAM 11 (1963)";
        /// The least: none.
        least: f64 = 1e-12, unit "of the curvature", source "a step is then that of Gauss and Newton to more digits than a fit has";
        /// Fall of the value that a step is expected to bring, at which it is not tried.
        rounding: f64 = 1e-16, unit "of the value", source "half a unit in the last place";
        /// The most: a step moves nothing.
        most: f64 = 1e6, unit "of the curvature", source "a step is a millionth of that of Gauss and Newton";
    }
}

/// All families of this module.
pub fn tables() -> Vec<Table> {
    vec![Damping::table()]
}
