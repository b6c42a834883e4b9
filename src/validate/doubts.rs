//! Free runs that speak against equations.
//!
//! In: runs along the data used and along those held out. Out: reasons, on the equations of the variables that go astray. Chaos is no
//! reason: where the data used are not followed to their end either, only a run that leaves all that was measured is.

use super::{FreeRun, Validation};
use crate::discover::{Discovery, Equation, Reason, Status};
use crate::simulate::Figures;
use crate::term::{Signal, SignalNames};

/// Part of the time that a run along data held out must follow, where those along the data used follow to the end.
const CARRIED: f64 = 0.5;
/// Its error is no reason below this part of the signal's spread, or below so many times that along the data used: where a motion
/// has died down, noise alone is as large as what is left of it.
const SLIGHT: f64 = 0.1;
const WORSE: f64 = 3.0;
/// Spreads of the signal beyond which a run has left what was measured: two states of one chaotic motion are some 1.5 apart.
const LEFT: f64 = 5.0;
/// Error over spread from which on the spread is known by it.
const VISIBLE: f64 = 1e-9;

/// Adds to every equation that was found what the runs of its variable say against it.
pub fn doubt(runs: &Validation, d: &mut Discovery) {
    let reason = |equation: &Equation| {
        if equation.status == Status::Known {
            return None;
        }
        let target = equation.target;
        let unit = if d.discrete { "samples" } else { "s" };
        (0..target.der.max(1)).find_map(|der| {
            let name = d.name(Signal::derivative(target.var, der));
            let runs = Runs { runs, name, unit };
            runs.carried().or_else(|| runs.left())
        })
    };
    let reasons: Vec<Option<Reason>> = d.equations.iter().map(reason).collect();
    for (equation, reason) in d.equations.iter_mut().zip(reasons) {
        if let Some(reason) = reason {
            equation.reasons.push(reason);
            equation.status = Status::Doubt;
        }
    }
}

/// The runs as far as they are of one signal.
struct Runs<'a> {
    runs: &'a Validation,
    name: String,
    /// Of its time.
    unit: &'static str,
}

impl<'a> Runs<'a> {
    fn of(&self, held_out: bool) -> impl Iterator<Item = (&'a FreeRun, &'a Figures)> {
        let all = self.runs.runs.iter();
        let these = all.filter(move |r| r.held_out == held_out);
        let scores = these.flat_map(|r| r.scores.iter().map(move |s| (r, s)));
        scores.filter(|(_, s)| s.signal == self.name)
    }

    fn carried(&self) -> Option<Reason> {
        let whole = |(run, score): &(&FreeRun, &Figures)| {
            run.ended.is_none() && score.follows_seconds.is_none()
        };
        let longest = self.of(false).map(|(r, _)| r.to - r.from);
        let longest = longest.fold(0.0, f64::max);
        // Without a run along the data used there is nothing to compare with.
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
        let large =
            error(score) > (SLIGHT * self.spread()).max(WORSE * used) || run.ended.is_some();
        (large && part(&(run, score)) < CARRIED).then(|| {
            Reason::new(
                "not-carried-over",
                format!(
                    "along {}, which was held out, a free run follows {} for {} of {} {}, and to the end along the data used: what was found holds \
                     for those alone",
                    run.record,
                    score.signal,
                    short(score.follows_seconds.unwrap_or(0.0)),
                    short(run.to - run.from),
                    self.unit
                ),
            )
        })
    }

    fn left(&self) -> Option<Reason> {
        let all = self.of(false).chain(self.of(true));
        let (run, score) = all.max_by(|a, b| error(a.1).total_cmp(&error(b.1)))?;
        let spreads = error(score) / self.spread();
        (spreads > LEFT).then(|| {
            Reason::new(
                "run-leaves-data",
                format!(
                    "a free run along {} leaves what was measured of {}: its error is {spreads:.0} times the spread",
                    run.record, score.signal
                ),
            )
        })
    }

    /// The largest standard deviation of the signal along a run.
    fn spread(&self) -> f64 {
        let all = self.of(false).chain(self.of(true));
        all.map(|(_, s)| spread(s)).fold(0.0, f64::max)
    }
}

/// Root mean square of the error, in units of the signal.
fn error(s: &Figures) -> f64 {
    s.mean_squared_error.map_or(0.0, f64::sqrt)
}

/// From error and fit, 100 (1 − error/spread); of a run without error from the signal's root mean square, which is no less.
fn spread(s: &Figures) -> f64 {
    let part = s.fit_percent.map_or(f64::NAN, |fit| 1.0 - fit / 100.0);
    let to_signal = s
        .error_to_signal_db
        .map_or(f64::NAN, |db| 10f64.powf(db / 20.0));
    let size = error(s) / if part > VISIBLE { part } else { to_signal };
    if size.is_finite() { size } else { 0.0 }
}

/// Three figures.
fn short(x: f64) -> f64 {
    format!("{x:.2e}").parse().unwrap_or(x)
}
