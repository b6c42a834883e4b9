//! Equations + data → verdict: the last stage. Are the equations the law, how far ahead do they predict, do they run freely?
//!
//! In: a program, the data used and held out, the [`Discovery`]. Out: predictions, free runs, the doubts that follow, the verdict. Never changes a term or a
//! coefficient.

use sidc_data::Dataset;
use sidc_progress::Observer;
use sidc_system::discovery::{Discovery, RunParameters};
use sidc_system::predict::{self, ErrorLimit, PredictionRequest};
use sidc_system::validate::{self, KStepErrors, Validation};
use sidc_system::verdict::Verdict;

use super::measure::Measured;
use super::program::Program;
use crate::options::Options;

/// What predictions and free runs say.
#[derive(Clone, Debug, Default)]
pub struct Judgement {
    /// Free runs on the data used and on the data held out; `None` if nothing was held out.
    pub validation: Option<Validation>,
    pub verdict: Verdict,
}

/// Predicts with the equations and runs them, on the rows held out, or on those used if none were held out.
pub fn judge(
    program: &Program,
    measured: &Measured,
    found: &mut Discovery,
    options: &Options,
    observer: &mut dyn Observer,
) -> Judgement {
    let request = &options.prediction;
    let used = found.followed(&measured.dataset);
    let used = &found.without_sensor_delays(&used).unwrap_or(used);
    let true_held = found.without_sensor_delays(&measured.held);
    let held = true_held.as_ref().unwrap_or(&measured.held);
    // Coefficients that differ between runs become parameters here.
    let by_run = RunParameters::of(found, &program.model);
    let with_values = |data: &Dataset| by_run.as_ref().map(|p| p.with_values(data));
    let (used_by_run, held_by_run) = (with_values(used), with_values(held));
    let (used, held) = (
        used_by_run.as_ref().unwrap_or(used),
        held_by_run.as_ref().unwrap_or(held),
    );
    let model = by_run.as_ref().map_or(&program.model, |p| &p.model);
    let equations = by_run
        .as_ref()
        .map_or_else(|| found.clone(), |p| p.discovery.clone());
    let equations = &equations;
    let mut prediction = predict::predict((equations, model), (used, held), request, observer);
    prediction.held_out = measured.held_out.clone();
    let data = (used, held);
    let validation = validate::validate((equations, model), data, observer);
    if let Some(runs) = &validation {
        let sensitive = runs.runs.iter().any(|r| r.sensitive);
        // Where free runs are too sensitive to compare, predictions over the same horizon on both parts are compared.
        let same = PredictionRequest {
            horizon: Some(prediction.horizon),
            good: Vec::new(),
        };
        let nothing = Dataset::default();
        let on_used = (sensitive && prediction.unavailable.is_none())
            .then(|| predict::predict((equations, model), (used, &nothing), &same, observer));
        let k_step = on_used.as_ref().map(|used| KStepErrors {
            used,
            held_out: &prediction,
        });
        validate::doubt(runs, k_step, found);
    }
    let verdict = match &validation {
        Some(runs) => Verdict::of(found, prediction, runs),
        None => {
            // If no state had to be fitted, the readings are free of noise.
            let clean = prediction.unavailable.is_none() && prediction.fitted_rows == 0;
            let runs = validate::run_on_used((equations, model), (used, clean), observer);
            Verdict::of(found, prediction, &runs)
        }
    };
    Judgement {
        validation,
        verdict,
    }
}

/// Checks for limits of signals that no equation predicts.
///
/// # Errors
/// The unknown name, and the names that are predicted.
pub fn check_limits(program: &Program, options: &Options) -> Result<(), (String, Vec<String>)> {
    let known = predict::predictable(&program.model);
    let unknown = options
        .prediction
        .good
        .iter()
        .find_map(|limit| match limit {
            ErrorLimit::Signal(name, _) if !known.contains(name) => Some(name.clone()),
            _ => None,
        });
    match unknown {
        Some(name) => Err((name, known)),
        None => Ok(()),
    }
}
