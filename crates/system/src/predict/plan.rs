//! How many starts are run, and how far: work linear in the data.
//!
//! In: rows of the horizon, of the fit of a state and of the data. Out: numbers of starts, horizons of the curve.

use super::thresholds::{BAND, PREDICTION, STATE_FIT};
use crate::simulate::SegmentRuns;

/// How many starts there are, and how far the curve goes.
pub(super) struct Plan {
    pub starts: usize,
    /// Those of bands, on data used and as many on data held out.
    pub band_starts: usize,
    /// Horizons of the curve over the one asked for.
    pub multiples: Vec<f64>,
}

impl Plan {
    pub fn new(rows: usize, fitted: usize, used: &[SegmentRuns], longest: usize) -> Plan {
        let all: usize = used.iter().map(|r| r.record().len()).sum();
        let budget = PREDICTION.rows + PREDICTION.rows_a_row * all;
        let components = used.first().map_or(1, |r| r.state().len());
        // Half of the Gauss–Newton steps are mostly enough.
        let fit = fitted * (components + 1) * STATE_FIT.steps / 2;
        let affordable = (budget / PREDICTION.fewest_starts).saturating_sub(3 * fit);
        let shortest = -3_i32;
        let all = (0..PREDICTION.doublings as i32).map(|k| f64::powi(2.0, k + shortest));
        let exists = |m: &f64| m * rows as f64 >= 1.0;
        let ends = |m: &f64| {
            let ahead = (m * rows as f64) as usize;
            *m <= 1.0 || (ahead <= affordable && 2 * ahead <= longest)
        };
        let multiples: Vec<f64> = all.filter(exists).filter(ends).collect();
        let starts = budget / (fit + rows).max(1);
        Plan {
            starts: starts.clamp(PREDICTION.fewest_starts, PREDICTION.starts),
            band_starts: (BAND.work * starts).clamp(PREDICTION.fewest_starts, BAND.starts),
            multiples,
        }
    }
}
