//! How many rows of readings the state at a start is fitted to: as many as predict best on the data used.
//!
//! In: states along the data used, starts. Out: a number of rows. More rows take more noise off, and fewer ask less of equations that do
//! not quite hold. Never looks at data held out.

use super::horizon::{Predicted, row_ahead};
use super::state_estimation::StateEstimator;
use super::test_starts::TestStart;
use super::thresholds::STATE_FIT;
use sidc_data::median;
use sidc_progress::Observer;

/// What is predicted to choose by: records, starts, signals, how far ahead, and the step of the rows.
pub(super) struct Trial<'a> {
    pub estimators: &'a [StateEstimator<'a>],
    pub starts: &'a [TestStart],
    pub signals: &'a [Predicted],
    pub ahead: f64,
    pub step: f64,
    pub discrete: bool,
}

/// The number of rows before a start to which its state is fitted; 0 takes the reading itself.
pub(super) fn choose_rows(trial: &Trial, most: usize, observer: &mut dyn Observer) -> usize {
    let Some(first) = trial.estimators.first() else {
        return 0;
    };
    let read = first.is_read();
    if read && is_clean(trial, observer) {
        return 0;
    }
    let shortest = first.shortest();
    let lengths = (0..=STATE_FIT.doublings).map(|k| shortest << k);
    let lengths = lengths.take_while(|rows| *rows <= most.max(shortest));
    // In discrete time process noise is part of the state, which a reading shows and a fit to earlier rows does not; so the reading
    // itself is tried, too.
    let itself = (read && trial.discrete).then_some(0);
    let (mut best, mut least) = (itself.unwrap_or(shortest), f64::INFINITY);
    for rows in itself.into_iter().chain(lengths) {
        let score = score(trial, rows, observer);
        if score < least {
            (best, least) = (rows, score);
        } else if score > STATE_FIT.worse * least {
            break;
        }
    }
    best
}

/// Median over the starts of the mean square error, in spreads.
fn score(trial: &Trial, rows: usize, observer: &mut dyn Observer) -> f64 {
    median_score(trial, |s| {
        let estimator = trial.estimators.get(s.record)?;
        let Ok(x) = estimator.state(s.row, rows, observer) else {
            return Some(f64::INFINITY);
        };
        squares(trial, estimator, s, &x, trial.ahead, observer)
    })
}

/// Median over the starts that have a score; infinite if none has.
pub(super) fn median_score(trial: &Trial, of_start: impl FnMut(&TestStart) -> Option<f64>) -> f64 {
    let mut scores: Vec<f64> = trial.starts.iter().filter_map(of_start).collect();
    median(&mut scores).unwrap_or(f64::INFINITY)
}

/// True if the equations reach the next reading from the reading before it.
fn is_clean(trial: &Trial, observer: &mut dyn Observer) -> bool {
    let mut any = false;
    for s in trial.starts {
        let Some(estimator) = trial.estimators.get(s.record) else {
            continue;
        };
        let Some(x) = estimator.reading(s.row) else {
            continue;
        };
        let square = squares(trial, estimator, s, &x, trial.step, observer);
        if square.is_none_or(|square| square > STATE_FIT.clean.powi(2)) {
            return false;
        }
        any = true;
    }
    any
}

/// Mean over the signals of the squared error so far ahead, in spreads; infinite where the run ends before.
fn squares(
    trial: &Trial,
    estimator: &StateEstimator,
    start: &TestStart,
    x: &[f64],
    ahead: f64,
    observer: &mut dyn Observer,
) -> Option<f64> {
    let record = estimator.runs.record();
    let row = row_ahead(&record.time, start.row, ahead, trial.step)?;
    match estimator.reach(start.row..row, x, observer) {
        Some(reached) => mean_square(trial, estimator, row, &reached),
        None => Some(f64::INFINITY),
    }
}

/// Mean over the signals of the squared distance of a state from the readings at a row, in spreads.
pub(super) fn mean_square(
    trial: &Trial,
    estimator: &StateEstimator,
    row: usize,
    reached: &[f64],
) -> Option<f64> {
    let record = estimator.runs.record();
    let (mut sum, mut count) = (0.0, 0.0);
    for s in trial.signals {
        let reading = record.column(s.signal)?.get(row)?;
        if reading.is_finite() {
            sum += ((reached.get(s.place)? - reading) / s.spread).powi(2);
            count += 1.0;
        }
    }
    (count > 0.0).then(|| sum / count)
}
