//! Medians.
//!
//! In: numbers, instants. Out: the median; the upper one of two.

/// Median of |x|, x standard normal.
pub const MEDIAN_OF_ABS_NORMAL: f64 = 0.6745;

/// The median; the upper one of two. `None` without numbers. Reorders them.
pub fn median(values: &mut [f64]) -> Option<f64> {
    let middle = values.len() / 2;
    if values.is_empty() {
        return None;
    }
    Some(*values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// The median time between two rows of all records. `None` if none has two.
pub fn median_step<'a>(times: impl IntoIterator<Item = &'a [f64]>) -> Option<f64> {
    let steps = times.into_iter().flat_map(|t| t.windows(2));
    let mut steps: Vec<f64> = steps.map(|w| w[1] - w[0]).collect();
    median(&mut steps)
}

#[cfg(test)]
mod tests {
    use super::{median, median_step};

    #[test]
    fn the_median_is_in_the_middle() {
        assert_eq!(median(&mut []), None);
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&mut [4.0, 1.0, 3.0, 2.0]), Some(3.0));
        let times: [&[f64]; 3] = [&[0.0, 1.0, 5.0], &[2.0], &[0.0, 2.0]];
        assert_eq!(median_step(times), Some(2.0));
    }
}
