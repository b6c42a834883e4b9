//! Rows that an equation misses by far more than their own error, though their small weight hides it from the residual.
//!
//! In: residuals, weights, samples. Out: how many rows are missed and the worst. Near an impact, a switch or an outlier a derivative
//! is known to be estimated badly, so its rows hardly count, and an equation that is wrong only there leaves a tiny weighted residual.
//! Never changes weights.

use crate::doubts::thresholds::BADLY_FITTED_ROWS;
use crate::row_weights::Weights;
use sidc_data::Samples;
use sidc_data::median;

/// The rows missed, and the worst of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BadlyFittedRows {
    pub rows: usize,
    /// Time of the row missed by most errors.
    pub time: f64,
    /// Its residual, in its own estimated errors.
    pub errors: f64,
    /// The longest time without a missed row, from a row to another.
    pub between: (f64, f64),
}

/// `left`: unweighted residuals by row. `size`: root mean square of the weighted target. `None` if no row is missed, or no error is
/// estimated.
pub(crate) fn badly_fitted_rows(
    left: &[f64],
    weights: &Weights,
    samples: &Samples,
    size: f64,
) -> Option<BadlyFittedRows> {
    let all = left.iter().zip(&samples.time).enumerate();
    let missed = all.filter_map(|(row, (left, time))| {
        let error = weights.error(row);
        let far = error > 0.0
            && left.abs() > BADLY_FITTED_ROWS.certain * error
            && left.abs() > BADLY_FITTED_ROWS.large * size;
        far.then(|| (*time, left.abs() / error))
    });
    let missed: Vec<(f64, f64)> = missed.collect();
    // The first of equals.
    let worst = missed.iter().min_by(|a, b| b.1.total_cmp(&a.1));
    worst.map(|(time, errors)| BadlyFittedRows {
        rows: missed.len(),
        time: *time,
        errors: *errors,
        between: longest_stretch(&missed, &samples.time),
    })
}

/// The longest time between rows of which none is missed.
fn longest_stretch(missed: &[(f64, f64)], times: &[f64]) -> (f64, f64) {
    let missed: Vec<f64> = missed.iter().map(|(time, _)| *time).collect();
    let mut times = times.to_vec();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let stretches = times.split(|t| missed.contains(t));
    let ends = stretches.filter_map(|s| Some((*s.first()?, *s.last()?)));
    let longer = |a: &(f64, f64), b: &(f64, f64)| (b.1 - b.0).total_cmp(&(a.1 - a.0));
    // The first of equals.
    ends.min_by(longer).unwrap_or_default()
}

/// The median residual of a row over its own estimated error; 0 if no error is estimated.
pub(crate) fn median_miss(left: &[f64], weights: &Weights) -> f64 {
    let misses = left.iter().enumerate().filter_map(|(row, left)| {
        let error = weights.error(row);
        (error > 0.0).then(|| left.abs() / error)
    });
    median(&mut misses.collect::<Vec<f64>>()).unwrap_or(0.0)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn samples(rows: usize) -> Samples {
        Samples {
            trajectory: vec![0; rows],
            time: (0..rows).map(|k| k as f64).collect(),
            columns: Vec::new(),
        }
    }

    fn weights(error: &[f64]) -> Weights {
        Weights {
            median_error: 0.1,
            row: error.iter().map(|e| 0.1 / e).collect(),
            ..Weights::known(error.len(), 0.1)
        }
    }

    #[test]
    fn rows_far_beyond_their_own_error_are_counted_and_the_worst_is_named() {
        let left = [0.01, 3.0, -80.0, 20.0, 0.4, 6.0];
        let error = weights(&[0.1, 0.2, 2.0, 1.9, 0.01, 1.0]);
        let found = badly_fitted_rows(&left, &error, &samples(6), 2.0).unwrap();
        // Row 4 is far beyond its error, but misses less than half of the target; row 5 may be its error.
        assert_eq!(found.rows, 3);
        assert_eq!(found.between, (4.0, 5.0));
        assert_eq!(found.time, 2.0);
        assert!((found.errors - 40.0).abs() < 1e-9);
        assert_eq!(
            badly_fitted_rows(&left, &error, &samples(6), 1e3).map(|s| s.rows),
            None
        );
    }

    #[test]
    fn measured_targets_have_no_errors_of_their_own() {
        let exact = Weights {
            median_error: 0.0,
            ..Weights::known(2, 1.0)
        };
        assert_eq!(
            badly_fitted_rows(&[5.0, 9.0], &exact, &samples(2), 1.0),
            None
        );
    }
}
