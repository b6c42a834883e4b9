//! Times that are whole counts of a unit.

/// Whole counts of a unit in seconds: times count from the first of them, spans stay as they are. `i64::MIN` stands for a missing value.
pub(crate) fn from_first(counts: Vec<i64>, unit: f64, from_first: bool) -> Vec<f64> {
    let known = |count: &i64| *count != i64::MIN;
    let zero = match from_first {
        true => counts.iter().copied().find(known).unwrap_or(0),
        false => 0,
    };
    let seconds = |count: i64| match known(&count) {
        true => scaled(count.saturating_sub(zero) as f64, unit),
        false => f64::NAN,
    };
    counts.into_iter().map(seconds).collect()
}

/// A count of units in seconds. Small units divide, because 1e9 is exact in binary and 1e-9 is not.
pub(crate) fn scaled(count: f64, unit: f64) -> f64 {
    match unit < 1.0 {
        true => count / (1.0 / unit).round(),
        false => count * unit,
    }
}
