//! How far the found equations can be trusted to run: on the data that they were found from, and on data held out.
//!
//! In: a discovery, datasets. Out: a [`Validation`] for the result, and the [`Ranking`] of candidate models by it. Never finds
//! equations, never prints.

mod ranking;

use serde::{Deserialize, Serialize};

use crate::data::{Dataset, Trajectory};
use crate::discover::{Discovery, Reason};
use crate::lang::model::Model;
use crate::simulate::{self, Options, Run, Source};
use crate::term::SignalNames;

pub use ranking::{FOLLOWED, Merit, Ranking, rank};

/// An exact run: JSON knows no infinity.
const EXACT: f64 = -400.0;

/// Free runs from the measured start of each record, or piece of one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Validation {
    pub runs: Vec<FreeRun>,
}

/// One stretch of a record, simulated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FreeRun {
    pub record: String,
    /// First and last time, seconds; sample numbers in discrete time.
    pub from: f64,
    pub to: f64,
    /// True if equations were not found from it.
    pub held_out: bool,
    pub scores: Vec<Figures>,
    /// Why it ended early.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub ended: Option<Reason>,
}

/// How one signal follows its measurement; what the figures mean is said at [`simulate::Score`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    pub signal: String,
    pub rows: usize,
    pub mse: f64,
    pub mae: f64,
    pub error_to_signal: f64,
    pub fit: f64,
    pub r_squared: f64,
    /// Seconds; absent if it follows to the end.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub follows: Option<f64>,
}

/// Runs the equations on the data used and on those held out; `None` where nothing was held out.
///
/// `go_on` false ends it: what was run by then stands.
pub fn validate(
    (d, model): (&Discovery, &Model),
    (used, held): (&Dataset, &Dataset),
    go_on: &mut dyn FnMut() -> bool,
) -> Option<Validation> {
    if held.trajectories.is_empty() {
        return None;
    }
    let mut runs = run_all((d, model), used, false, go_on);
    runs.extend(run_all((d, model), held, true, go_on));
    Some(Validation { runs })
}

/// The same on the data held out alone, every record cut into so many parts: each starts anew from what was measured.
pub fn restarted(
    (d, model): (&Discovery, &Model),
    held: &Dataset,
    parts: usize,
    go_on: &mut dyn FnMut() -> bool,
) -> Validation {
    let cut = |t: &Trajectory| -> Vec<Trajectory> {
        let at = |k: usize| k * t.len() / parts.max(1);
        (0..parts).map(|k| t.part(at(k)..at(k + 1))).collect()
    };
    let pieces = Dataset {
        trajectories: held.trajectories.iter().flat_map(cut).collect(),
        inputs: held.inputs.clone(),
    };
    Validation {
        runs: run_all((d, model), &pieces, true, go_on),
    }
}

fn run_all(
    (d, model): (&Discovery, &Model),
    dataset: &Dataset,
    held_out: bool,
    go_on: &mut dyn FnMut() -> bool,
) -> Vec<FreeRun> {
    let source = Source {
        discovery: d,
        model,
        dataset,
    };
    let mut one = |record| simulate::simulate(&source, record, &Options::default(), go_on).ok();
    let all = (0..dataset.trajectories.len()).filter_map(&mut one);
    all.map(|run| free_run(d, &run, held_out)).collect()
}

impl Validation {
    /// Error to signal on the data held out, decibels: the mean over states of the errors' energy over the signal's, for the
    /// variables of these names. Infinite if a run ended early, or one of them was not run.
    pub fn error(&self, states: &[String]) -> f64 {
        let held = || self.runs.iter().filter(|r| r.held_out);
        if held().any(|r| r.ended.is_some()) {
            return f64::INFINITY;
        }
        let of = |name: &str| -> Option<f64> {
            let all = || held().flat_map(|r| &r.scores).filter(|s| s.signal == name);
            let error: f64 = all().map(|s| s.mse * s.rows as f64).sum();
            let signal: f64 = all().map(|s| s.mse * s.rows as f64 / ratio(s)).sum();
            (signal > 0.0).then(|| error / signal)
        };
        let ratios: Option<Vec<f64>> = states.iter().map(|s| of(s)).collect();
        match ratios.as_deref() {
            None | Some([]) => f64::INFINITY,
            Some(all) => decibels(all.iter().sum::<f64>() / all.len() as f64),
        }
    }
}

fn ratio(f: &Figures) -> f64 {
    10f64.powf(f.error_to_signal / 10.0)
}

fn decibels(ratio: f64) -> f64 {
    (10.0 * ratio.log10()).max(EXACT)
}

fn free_run(d: &Discovery, run: &Run, held_out: bool) -> FreeRun {
    let figures = run.scores.iter().map(|s| Figures {
        signal: d.name(s.signal),
        rows: s.rows,
        mse: s.mse,
        mae: s.mae,
        error_to_signal: s.error_to_signal.max(EXACT),
        fit: s.fit,
        r_squared: s.r_squared,
        follows: s.follows,
    });
    FreeRun {
        record: run.name.clone(),
        from: run.time.first().copied().unwrap_or(0.0),
        to: run.time.last().copied().unwrap_or(0.0),
        held_out,
        scores: figures.collect(),
        ended: run.fault().map(|f| {
            let text = format!("the run ended at t = {}", f.time);
            Reason::new(f.kind.code(), text)
        }),
    }
}
