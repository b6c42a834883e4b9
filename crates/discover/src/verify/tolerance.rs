//! Comparison of a figure with its limit.

/// False also for NaN: such a figure shows nothing.
pub(super) fn within(figure: f64, limit: f64) -> bool {
    figure <= limit
}
