//! Motion that no term of a library explains, told from the noise of sensors.
//!
//! In: a library, rows with the measured target. Out: whether what all terms together leave is motion. Never changes an equation.
//!
//! Sensors whose columns were measured each for itself are wrong from sample to sample; a motion is nearly a parabola over a few of
//! them. The median of third differences is the noise then, whatever jumps an input makes.

use crate::dictionary::evaluate;
use crate::doubts::thresholds::DOUBTS;
use crate::identifiability::thresholds::UNEXPLAINED_MOTION;
use crate::scaled_design::OrthonormalBasis;
use crate::statistics::{norm, rms};
use sidc_data::{Origin, Samples, difference_noise};
use sidc_lang::library::Library;
use sidc_lang::term::Signal;

/// Whether all terms together leave a large part of the target unexplained, and that part is motion rather than noise. False where
/// this cannot be decided: estimated columns have correlated errors, and few rows are fitted by any terms.
pub fn leaves_motion(library: &Library, target: Signal, samples: &Samples) -> bool {
    let limits = &UNEXPLAINED_MOTION;
    let measured = |s: Signal| {
        let column = samples.column(s);
        column.is_some_and(|c| matches!(c.origin, Origin::Measured { .. }))
    };
    let n = library.len();
    if n > limits.max_terms || !measured(target) || !library.signals().into_iter().all(measured) {
        return false;
    }
    let rows: Vec<usize> = (0..samples.len().min(limits.max_rows)).collect();
    if rows.len() < limits.rows * n {
        return false;
    }
    let samples = samples.select(&rows);
    let Some(y) = samples.column(target).map(|c| &c.values) else {
        return false;
    };
    let columns: Vec<Vec<f64>> = (library.terms())
        .map(|(_, term)| evaluate(&term, &samples))
        .collect();
    if columns.iter().flatten().chain(y).any(|v| !v.is_finite()) {
        return false;
    }
    let left = OrthonormalBasis::of(columns.iter().map(|c| &c[..])).residual(y);
    let large = norm(&left) > DOUBTS.poor_fit * norm(y);
    let noise = noise(&left, &samples);
    large && noise > 0.0 && noise < limits.noise * rms(&left)
}

/// The white noise in a series, within trajectories.
fn noise(series: &[f64], samples: &Samples) -> f64 {
    let mut rest = series;
    let runs = samples.trajectory.chunk_by(|a, b| a == b);
    difference_noise(runs.map(|run| {
        let (own, others) = rest.split_at(run.len());
        rest = others;
        own
    }))
}
