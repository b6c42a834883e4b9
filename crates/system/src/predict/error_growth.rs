//! Runs from all starts, and their errors at every horizon of the curve, beside no change and the linear model.
//!
//! In: states along the records, starts, signals, horizons. Out: errors of every start by horizon and signal. A run that ends early has
//! infinite errors from there on. Chooses nothing.

use std::collections::{BTreeMap, BTreeSet};

use super::horizon::{Predicted, row_ahead};
use super::linear_model::{Along, InputSums, LinearModel};
use super::state_estimation::{NoState, StateEstimator};
use super::test_starts::TestStart;
use super::thresholds::PREDICTION;
use crate::simulate::FaultKind;
use sidc_progress::{Activity, Observer};

/// What is run.
pub(super) struct Growth<'a> {
    pub estimators: &'a [StateEstimator<'a>],
    pub inputs: &'a [InputSums],
    pub starts: &'a [TestStart],
    pub signals: &'a [Predicted],
    /// Horizons in rising order, and which of them was asked for.
    pub ahead: &'a [f64],
    pub asked: usize,
    pub step: f64,
    pub fitted_rows: usize,
}

/// Absolute errors of one signal at one horizon.
#[derive(Clone, Debug, Default)]
pub(super) struct Errors {
    pub equations: Vec<f64>,
    pub no_change: Vec<f64>,
    pub linear: Vec<f64>,
}

/// Errors of all starts.
#[derive(Clone, Debug, Default)]
pub(super) struct GrowthErrors {
    /// By horizon, then by signal.
    pub errors: Vec<Vec<Errors>>,
    /// Starts that were run.
    pub starts: usize,
    /// Runs that ended before the horizon asked for, by reason.
    pub ended: BTreeMap<&'static str, usize>,
    /// True if the observer ended the work.
    pub stopped: bool,
}

impl Growth<'_> {
    /// Runs from every start.
    pub fn run(&self, linear: &mut LinearModel, observer: &mut dyn Observer) -> GrowthErrors {
        let empty = vec![vec![Errors::default(); self.signals.len()]; self.ahead.len()];
        let mut out = GrowthErrors {
            errors: empty,
            ..GrowthErrors::default()
        };
        // Beyond the horizon asked for, a third of the starts are enough to see how the error grows.
        let sparse = self.starts.len() / PREDICTION.fewest_starts.max(1);
        for (number, start) in self.starts.iter().enumerate() {
            let far = number % sparse.max(1) == 0;
            let time = self.estimators.get(start.record);
            let time = time.and_then(|e| e.runs.record().time.get(start.row));
            let time = time.copied().unwrap_or(0.0);
            if observer.hear(Activity::Running { time }).is_break() {
                out.stopped = true;
                break;
            }
            if let Some(fault) = self.one((start, far), linear, &mut out, observer) {
                *out.ended.entry(fault).or_default() += 1;
                out.stopped |= fault == FaultKind::Stopped.code();
            }
            if out.stopped {
                break;
            }
        }
        out
    }

    /// Runs from one start; why the run ended before the horizon asked for.
    fn one(
        &self,
        (start, far): (&TestStart, bool),
        linear: &mut LinearModel,
        out: &mut GrowthErrors,
        observer: &mut dyn Observer,
    ) -> Option<&'static str> {
        let estimator = self.estimators.get(start.record)?;
        let state = estimator.state(start.row, self.fitted_rows, observer);
        if state == Err(NoState::Unread) {
            return None;
        }
        out.starts += 1;
        let record = estimator.runs.record();
        let row = |ahead: &f64| row_ahead(&record.time, start.row, *ahead, self.step);
        let last_asked = if far {
            self.ahead.len()
        } else {
            self.asked + 1
        };
        let wanted = self.ahead.iter().take(last_asked).map(row);
        let rows: Vec<Option<usize>> = wanted.map(|r| r.filter(|k| *k < start.end)).collect();
        let ahead = start.row + 1..start.end;
        let reading = |row: &Option<usize>, s: &Predicted| s.reading(record, (*row)?, &ahead);
        let readings: Vec<Vec<Option<(usize, f64)>>> = rows
            .iter()
            .map(|row| self.signals.iter().map(|s| reading(row, s)).collect())
            .collect();
        let read = readings.iter().flatten().flatten().map(|(row, _)| *row);
        let reached: BTreeSet<usize> = rows.iter().flatten().copied().chain(read).collect();
        let last = reached.last().copied().unwrap_or(start.row);
        let run = state
            .as_ref()
            .map(|x| estimator.runs.run(start.row..last + 1, x, observer));
        let run = run.unwrap_or_default();
        let on = Along {
            estimator,
            inputs: self.inputs.get(start.record)?,
        };
        let behind: Vec<usize> = reached.iter().map(|k| k - start.row).collect();
        let rival_start = linear.start(on, start.row, state.as_ref().ok());
        let linear = rival_start
            .as_ref()
            .and_then(|x| linear.ahead(on, start.row, x, &behind));
        for (readings, errors) in readings.iter().zip(&mut out.errors) {
            let each = self.signals.iter().zip(readings).zip(errors);
            for ((s, reading), errors) in each {
                let Some((row, reading)) = *reading else {
                    continue;
                };
                let rival = behind.binary_search(&(row - start.row)).ok();
                let rival = rival.zip(linear.as_ref()).and_then(|(k, l)| l.get(k));
                let reached = run.states.get(row - start.row);
                let off = |x: Option<&Vec<f64>>| {
                    let error = x.and_then(|x| x.get(s.place)).map(|x| (x - reading).abs());
                    error.filter(|e| e.is_finite()).unwrap_or(f64::INFINITY)
                };
                errors.equations.push(off(reached));
                let first = record.column(s.signal).and_then(|c| c.get(start.row));
                let kept = first.copied().filter(|v| v.is_finite());
                let kept = kept.or_else(|| rival_start.as_ref()?.get(s.place).copied());
                let kept = kept.map_or(f64::INFINITY, |x| (x - reading).abs());
                errors.no_change.push(kept);
                if linear.is_some() {
                    errors.linear.push(off(rival));
                }
            }
        }
        let asked = rows.get(self.asked).copied().flatten()?;
        match (&state, run.fault) {
            (Err(_), _) => Some("no-state"),
            (_, Some(fault)) if run.states.len() <= asked - start.row => Some(fault.code()),
            _ => None,
        }
    }
}
