//! Free runs that speak against equations.
//!
//! In: runs along the data used and along those held out. Out: reasons, on the equations of the variables that go astray. Chaos is no
//! reason: where the data used are not followed to their end either, only a run that leaves all that was measured is.

use super::{FreeRun, Validation};
use crate::discover::{Discovery, Reason, Status};
use crate::simulate::Figures;
use crate::term::{Signal, SignalNames};

/// Part of the time that a run along data held out must follow, where those along the data used follow to the end.
const CARRIED: f64 = 0.5;
/// Fit in per cent, 100 (1 − error/spread), below which a run has left what was measured: two states of one chaotic motion are
/// some 1.5 spreads apart, −50 %.
const LEFT: f64 = -400.0;

/// Adds to every equation that was found what the runs of its variable say against it.
pub fn doubt(runs: &Validation, d: &mut Discovery) {
    let reason = |k: usize| {
        let equation = &d.equations[k];
        if equation.status == Status::Known {
            return None;
        }
        let target = equation.target;
        let names: Vec<String> = (0..target.der.max(1))
            .map(|der| d.name(Signal::derivative(target.var, der)))
            .collect();
        let unit = if d.discrete { "samples" } else { "s" };
        let runs = Runs { runs, names, unit };
        runs.carried().or_else(|| runs.left())
    };
    let reasons: Vec<Option<Reason>> = (0..d.equations.len()).map(reason).collect();
    for (equation, reason) in d.equations.iter_mut().zip(reasons) {
        if let Some(reason) = reason {
            equation.reasons.push(reason);
            equation.status = Status::Doubt;
        }
    }
}

/// The runs as far as they are of one variable and its derivatives.
struct Runs<'a> {
    runs: &'a Validation,
    names: Vec<String>,
    /// Of its time.
    unit: &'static str,
}

impl<'a> Runs<'a> {
    fn of(&self, held_out: bool) -> impl Iterator<Item = (&'a FreeRun, &'a Figures)> {
        let runs = self
            .runs
            .runs
            .iter()
            .filter(move |r| r.held_out == held_out);
        let scores = runs.flat_map(|r| r.scores.iter().map(move |s| (r, s)));
        scores.filter(|(_, s)| self.names.contains(&s.signal))
    }

    fn carried(&self) -> Option<Reason> {
        let whole = |(run, score): &(&FreeRun, &Figures)| {
            run.ended.is_none() && score.follows_seconds.is_none()
        };
        if !self.of(false).all(|used| whole(&used)) {
            return None;
        }
        let longest = self
            .of(false)
            .map(|(r, _)| r.to - r.from)
            .fold(0.0, f64::max);
        let part = |(run, score): &(&FreeRun, &Figures)| {
            let expected = (run.to - run.from).min(longest);
            let follows = score.follows_seconds.unwrap_or(f64::INFINITY);
            follows / expected.max(f64::MIN_POSITIVE)
        };
        let (run, score) = (self.of(true)).min_by(|a, b| part(a).total_cmp(&part(b)))?;
        (part(&(run, score)) < CARRIED).then(|| {
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
        let fit = |score: &Figures| score.fit_percent.unwrap_or(0.0);
        let all = self.of(false).chain(self.of(true));
        let (run, score) = all.min_by(|a, b| fit(a.1).total_cmp(&fit(b.1)))?;
        (fit(score) < LEFT).then(|| {
            Reason::new(
                "run-leaves-data",
                format!(
                    "a free run along {} leaves what was measured of {}: its error is {:.0} times the spread",
                    run.record,
                    score.signal,
                    1.0 - fit(score) / 100.0
                ),
            )
        })
    }
}

/// Three figures.
fn short(x: f64) -> f64 {
    format!("{x:.2e}").parse().unwrap_or(x)
}
