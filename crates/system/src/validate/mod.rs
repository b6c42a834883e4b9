//! Validation by free runs, on the data used and on data held out.
//!
//! In: a discovery, datasets. Out: a [`Validation`] for the result, doubts of equations whose runs go astray, and the
//! [`Ranking`] of candidate models. Never finds equations, prints nothing.

mod free_run_doubts;
mod model_ranking;
mod sensitivity;
pub mod thresholds;

use serde::{Deserialize, Serialize};

use crate::discovery::{Discovery, Form, Notice};
use crate::simulate;
use crate::simulate::thresholds::SEGMENTS;
use crate::simulate::{EXACT, Figures, Options, Run, Source};
use sidc_data::{Dataset, Trajectory};
use sidc_lang::model::Model;
use sidc_lang::term::Signal;
use sidc_progress::Observer;

pub use free_run_doubts::{KStepErrors, doubt};
use sensitivity::is_sensitive;

pub use model_ranking::{Merit, Ranking, rank};

/// Free runs from the measured start of each record or part of one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Validation {
    pub runs: Vec<FreeRun>,
}

/// A free run along one stretch of a record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FreeRun {
    pub record: String,
    /// First and last time in seconds; in discrete time the numbers of samples.
    pub from: f64,
    pub to: f64,
    /// True if the equations were not found from this stretch.
    pub held_out: bool,
    /// True if runs whose starts differ by the error of the readings depart from each other: the run says nothing about the equations.
    #[serde(skip_serializing_if = "std::ops::Not::not", default)]
    pub sensitive: bool,
    pub scores: Vec<Figures>,
    /// Why the run ended early.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub ended: Option<Notice>,
}

/// Runs the equations on the data used and on those held out; `None` where nothing was held out.
///
/// `observer` hears the time reached in a run. Where it ends the run, what was simulated by then counts.
pub fn validate(
    (d, model): (&Discovery, &Model),
    (used, held): (&Dataset, &Dataset),
    observer: &mut dyn Observer,
) -> Option<Validation> {
    if held.trajectories.is_empty() {
        return None;
    }
    let exact = Options::default();
    let mut runs = run_all((d, model), (used, false), &exact, observer);
    runs.extend(run_all((d, model), (held, true), &exact, observer));
    Some(Validation { runs })
}

/// Runs the equations on the data used, to the accuracy of readings, as a check of free runs where nothing was held out. If the
/// readings are `clean`, runs start from them.
pub fn run_on_used(
    (d, model): (&Discovery, &Model),
    (used, clean): (&Dataset, bool),
    observer: &mut dyn Observer,
) -> Validation {
    let mut runs = Vec::new();
    if d.was_stopped() || !d.failed.is_empty() {
        return Validation { runs };
    }
    let state = Form::new(d).state;
    for record in &used.trajectories {
        let reading = |s: &Signal| {
            let first = record.column(*s)?.first().copied();
            Some((*s, first.filter(|v| v.is_finite())?))
        };
        let start: Option<Vec<(Signal, f64)>> = state.iter().map(reading).collect();
        let options = Options {
            // In discrete time a run starts behind the samples that the equations look back to.
            start: start.filter(|_| clean && !d.discrete).unwrap_or_default(),
            tolerance: SEGMENTS.tolerance,
            ..Options::default()
        };
        let alone = Dataset {
            trajectories: vec![record.clone()],
            inputs: used.inputs.clone(),
            ..Dataset::default()
        };
        runs.extend(run_all((d, model), (&alone, false), &options, observer));
    }
    Validation { runs }
}

/// As [`validate`] on the data held out alone, with every record cut into parts of about equal length that start afresh.
pub fn in_parts(
    (d, model): (&Discovery, &Model),
    held: &Dataset,
    parts: usize,
    observer: &mut dyn Observer,
) -> Validation {
    let cut = |t: &Trajectory| -> Vec<Trajectory> {
        let at = |k: usize| k * t.len() / parts.max(1);
        (0..parts).map(|k| t.part(at(k)..at(k + 1))).collect()
    };
    let pieces = Dataset {
        trajectories: held.trajectories.iter().flat_map(cut).collect(),
        inputs: held.inputs.clone(),
        rate_faults: held.rate_faults.clone(),
        unread: held.unread.clone(),
    };
    Validation {
        runs: run_all((d, model), (&pieces, true), &Options::default(), observer),
    }
}

fn run_all(
    (d, model): (&Discovery, &Model),
    (dataset, held_out): (&Dataset, bool),
    options: &Options,
    observer: &mut dyn Observer,
) -> Vec<FreeRun> {
    let source = Source {
        discovery: d,
        model,
        dataset,
    };
    let mut one = |record| {
        let run = simulate::simulate(&source, record, options, observer).ok()?;
        let mut entry = free_run(d, &run, held_out);
        entry.sensitive = is_sensitive(&source, (record, &run), observer);
        Some(entry)
    };
    (0..dataset.trajectories.len())
        .filter_map(&mut one)
        .collect()
}

impl Validation {
    /// Error to signal on the data held out in decibels: the mean over these states of the error's energy over the
    /// signal's. Infinite if a run ended early or a state was not simulated.
    pub fn error(&self, states: &[String]) -> f64 {
        let held = || self.runs.iter().filter(|r| r.held_out);
        if held().any(|r| r.ended.is_some()) {
            return f64::INFINITY;
        }
        let of = |name: &str| -> Option<f64> {
            let all = || held().flat_map(|r| &r.scores).filter(|s| s.signal == name);
            let figures: Option<Vec<(f64, f64)>> = all().map(energies).collect();
            let figures = figures?;
            let error: f64 = figures.iter().map(|(error, _)| error).sum();
            let signal: f64 = figures.iter().map(|(_, signal)| signal).sum();
            (signal > 0.0).then(|| error / signal)
        };
        let ratios: Option<Vec<f64>> = states.iter().map(|s| of(s)).collect();
        match ratios.as_deref() {
            None | Some([]) => f64::INFINITY,
            Some(all) => {
                let mean = all.iter().sum::<f64>() / all.len() as f64;
                (10.0 * mean.log10()).max(EXACT)
            }
        }
    }
}

/// Energy of a run's error, and of its signal.
fn energies(f: &Figures) -> Option<(f64, f64)> {
    let error = f.mean_squared_error? * f.rows as f64;
    let ratio = 10f64.powf(f.error_to_signal_db? / 10.0);
    // The signal's energy is unknown in an exact run, and any positive number will do.
    Some((error, if error > 0.0 { error / ratio } else { 1.0 }))
}

fn free_run(d: &Discovery, run: &Run, held_out: bool) -> FreeRun {
    FreeRun {
        record: run.name.clone(),
        from: run.time.first().copied().unwrap_or(0.0),
        to: run.time.last().copied().unwrap_or(0.0),
        held_out,
        sensitive: false,
        scores: run.scores.iter().map(|s| Figures::of(d, s)).collect(),
        ended: run.fault().map(|f| {
            let text = format!("{} at t = {}", f.text(d), f.time);
            Notice::new(f.kind.code(), text)
        }),
    }
}
