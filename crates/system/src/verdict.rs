//! Three answers about a system: is it the law, how far ahead does it predict, does it run freely.
//!
//! In: a discovery with its doubts, a prediction, free runs. Out: a [`Verdict`] for the result, and back from doubts alone. Judges
//! nothing anew.

use serde::{Deserialize, Serialize};

use crate::discovery::{Discovery, Notice, Reason};
use crate::predict::{DataKind, Prediction};
use crate::validate::{FreeRun, Validation};
use sidc_lang::term::SignalNames;

/// The three answers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    pub law: LawVerdict,
    pub prediction: Prediction,
    pub run: RunVerdict,
}

/// Whether the equations are the law.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LawVerdict {
    /// No evidence is against them.
    Passes,
    /// Some equation is doubted.
    Doubted,
    /// Some equation was not found.
    #[default]
    Failed,
}

impl LawVerdict {
    pub fn of(d: &Discovery) -> LawVerdict {
        match (d.failed.is_empty(), d.passes()) {
            (false, _) => LawVerdict::Failed,
            (true, true) => LawVerdict::Passes,
            (true, false) => LawVerdict::Doubted,
        }
    }

    /// As in documents.
    pub fn as_str(self) -> &'static str {
        match self {
            LawVerdict::Passes => "passes",
            LawVerdict::Doubted => "doubted",
            LawVerdict::Failed => "failed",
        }
    }
}

/// How the equations run freely, from a start fitted to the first readings.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RunVerdict {
    pub status: RunStatus,
    pub on: DataKind,
    /// How long the runs are together, in seconds; in discrete time in samples.
    pub long: f64,
    /// The worst run of each signal.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub signals: Vec<SignalRun>,
    /// Why a run ended early.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub ended: Option<Notice>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RunStatus {
    /// Every signal is followed to the end.
    Follows,
    /// Some signal departs from its readings.
    Departs,
    /// It departs, and so do two runs whose starts differ by the error of the readings: the plant is unstable or chaotic, and a free run
    /// says nothing about the equations.
    Sensitive,
    /// A run ended early.
    Ended,
    /// Nothing was run.
    #[default]
    NotRun,
}

/// The worst run of one signal.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SignalRun {
    pub signal: String,
    /// Seconds until it departs from its readings; absent if it does not.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub follows: Option<f64>,
    /// Length of that run.
    pub long: f64,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub fit_percent: Option<f64>,
}

impl Verdict {
    pub fn of(d: &Discovery, prediction: Prediction, runs: &Validation) -> Verdict {
        Verdict {
            law: LawVerdict::of(d),
            prediction,
            run: RunVerdict::of(d, runs),
        }
    }
}

impl RunVerdict {
    /// The verdict of the runs on data held out, or on the data used where nothing was held out.
    fn of(d: &Discovery, all: &Validation) -> RunVerdict {
        let held = all.runs.iter().any(|r| r.held_out);
        let runs = || all.runs.iter().filter(|r| r.held_out == held);
        // Signals computed from the state at each instant are left out: they follow the readings as well as the state does.
        let targets: Vec<String> = d.equations.iter().map(|e| d.name(e.target)).collect();
        let mut signals: Vec<SignalRun> = Vec::new();
        for run in runs() {
            for one in signal_runs(run).filter(|s| !targets.contains(&s.signal)) {
                match signals.iter_mut().find(|s| s.signal == one.signal) {
                    None => signals.push(one),
                    Some(worst) if part(&one) < part(worst) => *worst = one,
                    Some(_) => {}
                }
            }
        }
        let ended = runs().find_map(|r| r.ended.clone());
        let departs = signals.iter().any(|s| s.follows.is_some());
        let status = match (&ended, departs) {
            _ if runs().next().is_none() => RunStatus::NotRun,
            (Some(_), _) | (None, true) if runs().any(|r| r.sensitive) => RunStatus::Sensitive,
            (Some(_), _) => RunStatus::Ended,
            (None, true) => RunStatus::Departs,
            (None, false) => RunStatus::Follows,
        };
        RunVerdict {
            status,
            on: if held {
                DataKind::HeldOut
            } else {
                DataKind::Used
            },
            long: runs().map(|r| r.to - r.from).sum(),
            signals,
            ended,
        }
    }
}

fn signal_runs(run: &FreeRun) -> impl Iterator<Item = SignalRun> {
    run.scores.iter().map(|s| SignalRun {
        signal: s.signal.clone(),
        follows: s.follows_seconds,
        long: run.to - run.from,
        fit_percent: s.fit_percent,
    })
}

/// Part of its run that a signal is followed.
fn part(s: &SignalRun) -> f64 {
    s.follows.map_or(1.0, |f| f / s.long.max(f64::MIN_POSITIVE))
}

/// Every reason of a discovery with the name of its target, failed equations first.
pub fn reasons(d: &Discovery) -> Vec<(String, &Reason)> {
    let failed = d.failed.iter().map(|f| (f.target, &f.reasons));
    let doubted = d.equations.iter().map(|e| (e.target, &e.reasons));
    let all = failed.chain(doubted);
    all.flat_map(|(target, reasons)| reasons.iter().map(move |r| (d.name(target), r)))
        .collect()
}
