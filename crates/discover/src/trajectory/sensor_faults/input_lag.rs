//! A lag of an input in place of a delay: in a record, a slow response to a command looks much like a late one.
//!
//! In: a problem, a fit with a delay. Out: the time constant of the first-order lag under which the likelihood of the same terms is largest,
//! and whether the delay is as likely. Changes no answer.

use super::input_delay::{DelayedInputs, ends};
use super::time_shift::cut;
use crate::trajectory::likelihood::fit;
use crate::trajectory::model::{Exogenous, LinearizationPoint, Problem};
use crate::trajectory::search::{Found, last_criterion};
use crate::trajectory::thresholds::DELAYS;
use sidc_lang::model::Between;
use sidc_progress::Observer;

/// A first-order lag of inputs, w' = (u - w)/τ, that explains as much as their delay.
#[derive(Clone, Debug, PartialEq)]
pub struct InputLag {
    /// The delay.
    pub late: DelayedInputs,
    /// τ, seconds.
    pub seconds: f64,
    /// What the criterion prefers the lag by; negative if it prefers the delay, by less than a term costs.
    pub gain: f64,
}

/// The lag, if the criterion does not prefer the delay by more than the price of a term. `found` is the answer with the delay, to the
/// problem `delayed`.
pub fn find_lag(
    problem: &Problem,
    late: &DelayedInputs,
    (delayed, found): (&Problem, &Found),
    observer: &mut dyn Observer,
) -> Option<InputLag> {
    let criterion = last_criterion(problem, found.inefficiency);
    let (front, back) = ends(late);
    let mut best = (f64::INFINITY, late.seconds);
    let mut start: Option<LinearizationPoint> = None;
    for part in DELAYS.lags {
        let seconds = part * late.seconds;
        let lagged = cut(&lagged(problem, late, seconds), front, back);
        let own = || found.best.point.on_instants(delayed, &lagged);
        let from = start.clone().unwrap_or_else(own);
        let Some(fit) = fit(&lagged, from, &criterion, f64::INFINITY, observer) else {
            continue;
        };
        if fit.value < best.0 {
            best = (fit.value, seconds);
            start = Some(fit.point);
        }
    }
    let gain = found.best.value - best.0;
    (gain > -found.penalty).then(|| InputLag {
        late: late.clone(),
        seconds: best.1,
        gain,
    })
}

/// The problem with the inputs behind a lag, from rest at their first values.
fn lagged(problem: &Problem, late: &DelayedInputs, seconds: f64) -> Problem {
    let mut out = problem.clone();
    for record in &mut out.records {
        let signals = problem.system.exogenous.iter().zip(&mut record.exogenous);
        for (_, exogenous) in signals.filter(|(s, _)| late.inputs.contains(&s.var)) {
            *exogenous = Exogenous {
                values: behind_lag(&record.time, exogenous, seconds),
                between: Between::Linear,
            };
        }
    }
    out
}

/// w at the samples: exact for what is held, and for straight lines by their mean over each step.
fn behind_lag(time: &[f64], u: &Exogenous, seconds: f64) -> Vec<f64> {
    let mut w = u.values.first().copied().unwrap_or(f64::NAN);
    let mut out = vec![w];
    for (times, values) in time.windows(2).zip(u.values.windows(2)) {
        let drives = match u.is_held() {
            true => values[0],
            false => 0.5 * (values[0] + values[1]),
        };
        w = drives + (w - drives) * (-(times[1] - times[0]) / seconds).exp();
        out.push(w);
    }
    out
}
