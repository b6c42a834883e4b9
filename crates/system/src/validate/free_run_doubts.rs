//! Doubts from free runs.
//!
//! In: runs on the data used and on data held out. Out: reasons on the equations whose variable leaves the data. Chaos
//! is no reason: where a run does not follow the data used to their end either, only a run that leaves the measured
//! range counts.

use crate::discovery::{Discovery, Reason, ReasonCode};
use crate::predict::{Prediction, SignalPrediction};
use crate::simulate::Figures;
use crate::validate::thresholds::FREE_RUNS;
use crate::validate::{FreeRun, Validation};
use sidc_lang::number::rounded;
use sidc_lang::term::{Signal, SignalNames};

/// Predictions over the same horizon, for plants whose free runs say nothing.
#[derive(Clone, Copy, Debug)]
pub struct KStepErrors<'a> {
    pub used: &'a Prediction,
    pub held_out: &'a Prediction,
}

/// Adds to every equation that was found what the runs of its variable say against it. Where small changes of the start grow, the
/// predictions speak in place of the runs.
pub fn doubt<'a>(runs: &'a Validation, predictions: Option<KStepErrors<'a>>, d: &mut Discovery) {
    d.doubt_each(|d, equation| {
        let target = equation.target;
        let unit = d.time_unit();
        (0..target.der.max(1)).find_map(|der| {
            let name = d.name(Signal::derivative(target.var, der));
            let unit = unit.clone();
            let runs = Runs { runs, name, unit };
            let ahead = || predictions.and_then(|p| runs.predicted(p));
            runs.carried().or_else(|| runs.left()).or_else(ahead)
        })
    });
}

/// The runs of one signal.
struct Runs<'a> {
    runs: &'a Validation,
    name: String,
    /// The unit of time in messages.
    unit: String,
}

impl<'a> Runs<'a> {
    fn of(&self, held_out: bool) -> impl Iterator<Item = (&'a FreeRun, &'a Figures)> {
        let all = self.runs.runs.iter();
        let these = all.filter(move |r| r.held_out == held_out && !r.sensitive);
        let scores = these.flat_map(|r| r.scores.iter().map(move |s| (r, s)));
        scores.filter(|(_, s)| s.signal == self.name)
    }

    fn carried(&self) -> Option<Reason> {
        let whole = |(run, score): &(&FreeRun, &Figures)| {
            run.ended.is_none() && score.follows_seconds.is_none()
        };
        let longest = self.of(false).map(|(r, _)| r.to - r.from);
        let longest = longest.fold(0.0, f64::max);
        // Without runs that follow the data used to their end there is nothing to compare with.
        if longest == 0.0 || !self.of(false).all(|used| whole(&used)) {
            return None;
        }
        let part = |(run, score): &(&FreeRun, &Figures)| {
            let expected = (run.to - run.from).min(longest);
            let follows = score.follows_seconds.unwrap_or(f64::INFINITY);
            follows / expected.max(f64::MIN_POSITIVE)
        };
        let (run, score) = (self.of(true)).min_by(|a, b| part(a).total_cmp(&part(b)))?;
        let used = self.of(false).map(|(_, s)| error(s)).fold(0.0, f64::max);
        let large = error(score) > (FREE_RUNS.slight * self.spread()).max(FREE_RUNS.worse * used)
            || run.ended.is_some();
        (large && part(&(run, score)) < FREE_RUNS.carried).then(|| {
            Reason::new(
                ReasonCode::NotCarriedOver,
                format!(
                    "along {}, which was held out, a free run follows {} for {} of {} {}, and to the end along the data used: what was found holds \
                     for those alone",
                    run.record,
                    score.signal,
                    rounded(score.follows_seconds.unwrap_or(0.0), 3),
                    rounded(run.to - run.from, 3),
                    self.unit
                ),
            )
        })
    }

    fn left(&self) -> Option<Reason> {
        let all = self.of(false).chain(self.of(true));
        let (run, score) = all.max_by(|a, b| error(a.1).total_cmp(&error(b.1)))?;
        let spreads = error(score) / self.spread();
        (spreads > FREE_RUNS.left).then(|| {
            Reason::new(
                ReasonCode::RunLeavesData,
                format!(
                    "a free run along {} leaves what was measured of {}: its error is {spreads:.0} times the spread",
                    run.record, score.signal
                ),
            )
        })
    }

    /// Where a run on data held out is sensitive: whether predictions are worse there than on the data used.
    fn predicted(&self, k_step: KStepErrors<'a>) -> Option<Reason> {
        let held = self.runs.runs.iter().filter(|r| r.held_out);
        held.clone().find(|r| r.sensitive)?;
        let of = |p: &'a Prediction| p.signals.iter().find(|s| s.signal == self.name);
        let (used, held_out) = (of(k_step.used)?, of(k_step.held_out)?);
        let spread = held_out.spread;
        let error = |p: &Prediction, s: &SignalPrediction| {
            let error = s.error.quantile_90.filter(|_| p.mostly_reaches());
            error.unwrap_or(f64::INFINITY)
        };
        let (used, held_out) = (error(k_step.used, used), error(k_step.held_out, held_out));
        let bound = (FREE_RUNS.slight * spread).max(FREE_RUNS.worse * used);
        (held_out > bound).then(|| {
            let shown = |error: f64| match error {
                e if e.is_finite() => rounded(e, 2).to_string(),
                _ => "infinity (its runs end early)".into(),
            };
            Reason::new(
                ReasonCode::NotCarriedOver,
                format!(
                    "{} {} ahead, {} has an error of {} on data held out and of {} on the data used: what was found holds for those alone",
                    rounded(k_step.held_out.horizon, 3),
                    self.unit,
                    self.name,
                    shown(held_out),
                    shown(used),
                ),
            )
        })
    }

    /// The largest standard deviation of the signal in a run.
    fn spread(&self) -> f64 {
        let all = self.of(false).chain(self.of(true));
        all.map(|(_, s)| spread(s)).fold(0.0, f64::max)
    }
}

/// Root mean square error, in units of the signal.
fn error(s: &Figures) -> f64 {
    s.mean_squared_error.map_or(0.0, f64::sqrt)
}

/// From error and fit, 100 (1 − error/spread). Where the fit is exact, from the root mean square of the signal, which
/// is not smaller.
fn spread(s: &Figures) -> f64 {
    let part = s.fit_percent.map_or(f64::NAN, |fit| 1.0 - fit / 100.0);
    let to_signal = s
        .error_to_signal_db
        .map_or(f64::NAN, |db| 10f64.powf(db / 20.0));
    let size = error(s)
        / if part > FREE_RUNS.visible {
            part
        } else {
            to_signal
        };
    if size.is_finite() { size } else { 0.0 }
}
