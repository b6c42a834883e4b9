//! Small helpers on series of values: selected rows, steps, ranges.

/// The values at the given rows; NaN where a row is beyond the end.
pub(crate) fn select(values: &[f64], rows: &[usize]) -> Vec<f64> {
    rows.iter()
        .map(|r| values.get(*r).copied().unwrap_or(f64::NAN))
        .collect()
}

/// Rows k at which `is(value before, value at k)` holds.
pub(crate) fn rows_of_steps(values: &[f64], is: impl Fn(f64, f64) -> bool) -> Vec<usize> {
    (1..values.len())
        .filter(|&k| is(values[k - 1], values[k]))
        .collect()
}

/// Least and largest finite value; ∞ and −∞ if there is none.
pub(crate) fn range(values: &[f64]) -> (f64, f64) {
    let finite = values.iter().filter(|x| x.is_finite());
    finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
        (a.min(*x), b.max(*x))
    })
}
