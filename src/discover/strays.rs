//! Rows that an equation misses by far more than they can be wrong, though their small weight hides it from the residual.
//!
//! Around an impact, a switch or an outlier a derivative is estimated badly, and is known to be: such rows hardly count in a fit.
//! An equation that is right between them leaves a tiny weighted residual and is silent about what happens there.

use super::weights::Weights;
use crate::data::Samples;

/// Part of the target's size that is no small matter.
const LARGE: f64 = 0.5;
/// Multiple of a row's estimated error that errors of that estimate do not explain.
const SURE: f64 = 10.0;

/// The rows missed, and the worst of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Strays {
    pub rows: usize,
    /// Time of the row missed by most errors.
    pub time: f64,
    /// Its residual, in its own estimated errors.
    pub errors: f64,
}

/// In: residuals by row without weights; the root mean square of the weighted target. `None` if no row strays, or none is estimated.
pub(super) fn strays(
    left: &[f64],
    weights: &Weights,
    samples: &Samples,
    size: f64,
) -> Option<Strays> {
    let all = left.iter().zip(&samples.time).enumerate();
    let missed = all.filter_map(|(row, (left, time))| {
        let error = weights.error(row);
        let far = error > 0.0 && left.abs() > SURE * error && left.abs() > LARGE * size;
        far.then(|| (*time, left.abs() / error))
    });
    let missed: Vec<(f64, f64)> = missed.collect();
    // The first of equals.
    let worst = missed.iter().min_by(|a, b| b.1.total_cmp(&a.1));
    worst.map(|(time, errors)| Strays {
        rows: missed.len(),
        time: *time,
        errors: *errors,
    })
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
            usual: 0.1,
            row: error.iter().map(|e| 0.1 / e).collect(),
            ..Weights::known(error.len(), 0.1)
        }
    }

    #[test]
    fn rows_far_beyond_their_own_error_are_counted_and_the_worst_is_named() {
        let left = [0.01, 3.0, -80.0, 20.0, 0.4, 6.0];
        let error = weights(&[0.1, 0.2, 2.0, 1.9, 0.01, 1.0]);
        let found = strays(&left, &error, &samples(6), 2.0).unwrap();
        // Row 4 is far beyond its error, but misses less than half of the target; row 5 may be its error.
        assert_eq!(found.rows, 3);
        assert_eq!(found.time, 2.0);
        assert!((found.errors - 40.0).abs() < 1e-9);
        assert_eq!(
            strays(&left, &error, &samples(6), 1e3).map(|s| s.rows),
            None
        );
    }

    #[test]
    fn measured_targets_have_no_errors_of_their_own() {
        let exact = Weights {
            usual: 0.0,
            ..Weights::known(2, 1.0)
        };
        assert_eq!(strays(&[5.0, 9.0], &exact, &samples(2), 1.0), None);
    }
}
