//! From a dataset to the rows that equations are found from: every needed signal, measured or estimated.
//!
//! In: a model, its dataset, the signals needed, an observer. Out: [`Samples`], and where each signal comes from. Measured
//! derivatives are used as measured; others are estimated from the highest measured one below. Nothing crosses a gap.

use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::model::Model;
use sidc_lang::term::{Signal, SignalNames};
use sidc_progress::{Activity, Observer};

mod gathered_column;
mod sampling_diagnostics;
mod signal_estimates;
pub(crate) mod thresholds;

use crate::dataset::{Dataset, Samples};
use crate::derivatives::Stopped;
use crate::series::select;
use gathered_column::GatheredColumn;
pub use gathered_column::Provenance;
use sampling_diagnostics::{
    input_changes_often, no_samples, no_signal, noisy_derivative, rows_left_out,
};
use signal_estimates::{JumpCrossings, SignalEstimator, SignalValues};
use thresholds::SAMPLING;

/// All `needed` signals at common instants, diagnostics, and where each signal comes from (sorted by signal).
///
/// Rows at which a needed signal is unknown are left out. Where the observer ends the work there are no rows. Errors among the diagnostics: `no-signal`, `no-samples`.
pub fn samples(
    model: &Model,
    dataset: &Dataset,
    needed: &[Signal],
    observer: &mut dyn Observer,
) -> (Samples, Vec<Diagnostic>, Vec<Provenance>) {
    let mut needed = needed.to_vec();
    needed.sort();
    needed.dedup();
    let mut out = Vec::new();
    let mut columns: Vec<GatheredColumn> = needed.iter().map(|s| GatheredColumn::new(*s)).collect();
    let mut table = Samples::default();
    let (mut left_out, mut rows_read) = (0, 0);
    let mut crossings = JumpCrossings::default();
    for (index, trajectory) in dataset.trajectories.iter().enumerate() {
        let estimator = SignalEstimator::new(model, dataset, trajectory);
        let mut found: Vec<SignalValues> = Vec::with_capacity(needed.len());
        for signal in &needed {
            let preparing = Activity::Preparing {
                signal: &model.name(*signal),
            };
            let known = match observer.hear(preparing).is_continue() {
                true => estimator.signal(*signal, &mut crossings, observer),
                false => Err(Stopped),
            };
            match known {
                Ok(Some(known)) => found.push(known),
                Ok(None) => out.push(no_signal(model, trajectory, *signal)),
                Err(Stopped) => return Default::default(),
            }
        }
        if found.len() < needed.len() {
            continue;
        }
        let whole = |row: &usize| {
            found
                .iter()
                .all(|k| k.values.get(*row).is_some_and(|x| x.is_finite()))
        };
        let rows: Vec<usize> = (0..trajectory.len()).filter(whole).collect();
        rows_read += trajectory.len();
        left_out += trajectory.len() - rows.len();
        table.trajectory.extend(rows.iter().map(|_| index as u32));
        table.time.extend(select(&trajectory.time, &rows));
        for (column, known) in columns.iter_mut().zip(found) {
            column.extend(known, &rows);
        }
    }
    if out.is_empty() && table.is_empty() {
        out.push(no_samples(rows_read));
    } else if left_out > 0 && out.is_empty() {
        // In discrete time every trajectory loses rows at its ends to shifts, which is not mentioned.
        let shifts: usize = needed
            .iter()
            .map(|s| s.shift.unsigned_abs() as usize)
            .max()
            .unwrap_or(0);
        if !model.discrete || left_out > 2 * shifts * dataset.trajectories.len() {
            out.push(rows_left_out(left_out, rows_read, model.discrete));
        }
    }
    if crossings.crossed as f64 > SAMPLING.often * crossings.rows as f64 {
        out.push(input_changes_often(crossings));
    }
    let report: Vec<Provenance> = columns.iter().map(GatheredColumn::provenance).collect();
    for p in &report {
        if let Some(error) = p.error.filter(|e| *e > SAMPLING.noisy_derivative * p.rms) {
            out.push(noisy_derivative(model, p, error));
        }
    }
    let noisy = |c: GatheredColumn| {
        let noise = model.noise(c.signal);
        c.into_column(noise)
    };
    table.columns = columns.into_iter().map(noisy).collect();
    (table, out, report)
}
