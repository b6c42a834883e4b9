//! The initial state of a run in discrete time: the samples from which the equations follow the first noisy readings best.
//!
//! In: readings of every component, samples before the run that the equations look back to. Out: both by least squares. The weight of
//! readings follows from the declared noise, or else from the errors of predictions one sample ahead. Readings that the equations meet stay
//! as they are.

use crate::simulate::initial_state::candidates::{self, Candidates};
use crate::simulate::initial_state::least_squares::{
    Readings, fit_initial_state, rms_residual, shortest,
};
use crate::simulate::integrate::continuous_time::LegSetup;
use crate::simulate::record_simulation::RecordSimulation;
use crate::simulate::run::{LegStart, Origin, Start};
use crate::simulate::scores::goodness_of_fit::deviation;
use crate::simulate::thresholds::{BUDGET, INITIAL_STATE};
use sidc_data::{MEDIAN_OF_ABS_NORMAL, median};
use sidc_lang::term::Signal;
use sidc_progress::Observer;

impl RecordSimulation<'_> {
    /// The start of a leg at the row `begin` of the record, which is row `from` of the candidates.
    pub(super) fn sampled_start(
        &self,
        leg: &LegSetup,
        candidates: &Candidates,
        (begin, from): (usize, usize),
        observer: &mut dyn Observer,
    ) -> LegStart {
        let raw = candidates::at_row(&candidates.raw, from);
        let read = raw.iter().all(|s| s.origin == Origin::Measured);
        let sigma = match read {
            true => self.sample_noise(leg, begin, observer),
            false => None,
        };
        let past = self.past(begin);
        let (Some(sigma), Some(past)) = (sigma, past) else {
            return LegStart::as_read(raw);
        };
        let width = raw.len();
        let mut x: Vec<f64> = raw.iter().map(|s| s.value).collect();
        let mut free: Vec<(usize, f64)> = self.sizes.iter().copied().enumerate().collect();
        let mut before = Vec::new();
        for (signal, samples) in &past {
            let place = raw.iter().position(|s| s.signal == *signal).unwrap_or(0);
            for sample in samples {
                before.push((x.len(), *sample, sigma[place]));
                free.push((x.len(), self.sizes[place]));
                x.push(*sample);
            }
        }
        let column = |(place, s): (usize, &Start)| {
            let values = self.record.column(s.signal)?.get(begin..)?;
            Some((place, values.to_vec(), *sigma.get(place)?))
        };
        let mut readings = Readings {
            channels: raw.iter().enumerate().filter_map(column).collect(),
            before,
            rows: leg.time.len(),
        };
        let mut trial = |x: &[f64], rows: usize| {
            let short = LegSetup {
                time: leg.time.get(..rows)?,
                ..*leg
            };
            let start = (x.get(..width)?, &moved(&past, x.get(width..)?)[..]);
            let path = self.path(&short, start, begin, BUDGET.trial_evaluations, observer);
            path.fault.is_none().then_some(path.rows)
        };
        let left = rms_residual(&readings, &x, &mut trial);
        if left.is_some_and(|left| left <= INITIAL_STATE.as_read) {
            return LegStart::as_read(raw);
        }
        // One-step prediction errors contain the noise of two samples, so that of one reading is overestimated; the residuals of a fit to a
        // few rows correct it.
        let whole = std::mem::replace(&mut readings.rows, 2 * shortest(free.len()));
        readings.rows = readings.rows.min(whole);
        if let Some(first) = fit_initial_state(&readings, &x, &free, &mut trial) {
            let left = rms_residual(&readings, &first.start, &mut trial);
            readings.scale_noise(left.map_or(1.0, |left| left.clamp(INITIAL_STATE.as_read, 1.0)));
        }
        readings.rows = whole;
        let Some(found) = fit_initial_state(&readings, &x, &free, &mut trial) else {
            return LegStart::as_read(raw);
        };
        let fitted = raw.into_iter().zip(found.start.iter().zip(&found.error));
        LegStart {
            state: fitted
                .map(|(s, (value, error))| Start {
                    value: *value,
                    error: Some(*error),
                    origin: Origin::Fitted,
                    ..s
                })
                .collect(),
            settled: found.rows,
            past: moved(&past, found.start.get(width..).unwrap_or(&[])),
        }
    }

    /// Standard deviations of the noise of each component's readings; `None` if the equations lead from each reading to the next without
    /// error.
    fn sample_noise(
        &self,
        leg: &LegSetup,
        begin: usize,
        observer: &mut dyn Observer,
    ) -> Option<Vec<f64>> {
        let state = &self.system.form.state;
        let columns: Option<Vec<&[f64]>> = state.iter().map(|s| self.record.column(*s)).collect();
        let columns = columns?;
        let mut off: Vec<Vec<f64>> = vec![Vec::new(); state.len()];
        for k in 0..leg.time.len().min(INITIAL_STATE.search_rows) {
            let Some(time) = leg.time.get(k..k + 2) else {
                break;
            };
            let reading = |row: usize| -> Option<Vec<f64>> {
                let value = |c: &&[f64]| c.get(row).copied().filter(|v| v.is_finite());
                columns.iter().map(value).collect()
            };
            let (Some(x), Some(next)) = (reading(begin + k), reading(begin + k + 1)) else {
                continue;
            };
            let short = LegSetup { time, ..*leg };
            let budget = BUDGET.trial_evaluations;
            let path = self.path(&short, (&x, &[]), begin + k, budget, observer);
            let Some(reached) = path.rows.row(1) else {
                continue;
            };
            for (off, (reached, next)) in off.iter_mut().zip(reached.iter().zip(&next)) {
                off.push((reached - next).abs());
            }
        }
        let spreads = columns.iter().map(|c| deviation(c));
        let mut noisy = false;
        let each = state.iter().zip(&columns).zip(&mut off).zip(spreads);
        let sigma = each.map(|(((signal, column), off), spread)| {
            let declared = self.model.noise(*signal);
            let declared = declared.map(|noise| noise.rms(column.iter()));
            let sigma = declared.unwrap_or(median(off).unwrap_or(0.0) / MEDIAN_OF_ABS_NORMAL);
            noisy |= sigma > INITIAL_STATE.clean * spread;
            sigma
                .max(INITIAL_STATE.clean * spread)
                .max(f64::MIN_POSITIVE)
        });
        let sigma: Vec<f64> = sigma.collect();
        noisy.then_some(sigma)
    }

    /// The samples of states before a row that the equations look back to, latest last; `None` if one was not read.
    fn past(&self, begin: usize) -> Option<Vec<(Signal, Vec<f64>)>> {
        let form = &self.system.form;
        let mut out = Vec::new();
        for signal in &form.state {
            let back = form.history.iter().filter(|s| s.var == signal.var);
            let Some(back) = back.map(|s| s.shift.unsigned_abs() as usize).max() else {
                continue;
            };
            let samples = self.record.column(*signal)?;
            let samples = samples.get(begin.checked_sub(back)?..begin)?;
            if samples.iter().any(|v| !v.is_finite()) {
                return None;
            }
            out.push((*signal, samples.to_vec()));
        }
        Some(out)
    }
}

/// The same samples with other values.
fn moved(past: &[(Signal, Vec<f64>)], values: &[f64]) -> Vec<(Signal, Vec<f64>)> {
    let mut values = values.iter().copied();
    past.iter()
        .map(|(s, old)| (*s, values.by_ref().take(old.len()).collect()))
        .collect()
}
