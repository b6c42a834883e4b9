//! A sensor that reads a constant too much as a rival of terms: laws about x − b have fewer of them.
//!
//! In: a problem and the fit of a support. Out: the offset of one state under which at least two terms are not needed, if there is
//! one. A term and the one that is its derivative by the state say what the offset may be: sin(x − b) = sin x − b cos x + ….

use super::fit::{Fit, Judge, fit};
use super::guide::GoOn;
use super::problem::{Point, Problem};
use super::search::last_judge;
use crate::term::{Expr, Signal, Term};

/// Offsets tried a state.
const TRIED: usize = 2;
/// Offsets nearer to each other than this part are one.
const SAME: f64 = 0.2;
/// Parabolas laid through the criterion.
const PARABOLAS: usize = 4;
/// First distance from an offset that is looked at, relative to it.
const NEAR: f64 = 0.1;
/// Fewest terms that an offset must explain.
const FEWEST: usize = 2;
/// Prices of a term by which the first guess of an offset may be worse than the laws without it.
const HOPELESS: f64 = 30.0;
/// Terms that may go: their standard errors are at least this part of them.
const WEAK: f64 = 0.1;

/// An offset that explains terms.
#[derive(Clone, Debug, PartialEq)]
pub struct Offset {
    /// What the sensor measures.
    pub signal: Signal,
    /// What it reads too much, in its units.
    pub value: f64,
    /// Columns that are not needed with it.
    pub terms: Vec<usize>,
    /// What the criterion gains, the offset charged as a term.
    pub gain: f64,
}

/// The offset that gains most.
pub fn offset(problem: &Problem, found: &Fit, go_on: &mut dyn FnMut() -> bool) -> Option<Offset> {
    let judge = last_judge(problem);
    let mut best: Option<Offset> = None;
    for state in 0..problem.states() {
        let signal = problem.system.states[state];
        if signal.der > 0
            || problem
                .records
                .iter()
                .all(|r| r.measured[state].iter().all(|x| x.is_nan()))
        {
            continue;
        }
        for (value, column) in candidates(problem, found, signal) {
            if !go_on() {
                return best;
            }
            let trial = Trial {
                problem,
                state,
                judge: &judge,
                hopeless: found.value + HOPELESS * judge.penalty,
            };
            let Some((value, fitted)) = trial.settle(value, (found, column), go_on) else {
                continue;
            };
            let gain = found.value - fitted.value - judge.penalty;
            let gone = |j: &&usize| !fitted.support().contains(j);
            let terms: Vec<usize> = found.support().iter().filter(gone).copied().collect();
            let before = best.as_ref().map_or(0.0, |b| b.gain);
            if terms.len() >= FEWEST && gain > before {
                best = Some(Offset {
                    signal,
                    value,
                    terms,
                    gain,
                });
            }
        }
    }
    best
}

/// Offsets that would explain a term as part of another, and that term.
fn candidates(problem: &Problem, found: &Fit, signal: Signal) -> Vec<(f64, usize)> {
    let system = &problem.system;
    let mut all: Vec<(f64, f64, usize)> = Vec::new();
    let terms = found.support().iter().zip(found.coefficients());
    for ((j, a), variance) in terms.clone().zip(&found.variances) {
        let slope = Expr::from(system.columns[*j].clone()).derivative(signal);
        let slopes: Vec<(f64, &Term)> = slope.terms().collect();
        let [(factor, term)] = slopes[..] else {
            continue;
        };
        let law = system.law_of(*j);
        let same = |k: &usize| system.law_of(*k) == law && system.columns[*k] == *term;
        if let Some((k, b)) = terms.clone().find(|(k, _)| same(k)) {
            all.push((variance.sqrt() / a.abs(), -b / (a * factor), *k));
        }
    }
    // The best known term first.
    all.sort_by(|x, y| x.0.total_cmp(&y.0));
    let mut out: Vec<(f64, usize)> = Vec::new();
    for (_, value, column) in all {
        let near = |(v, _): &(f64, usize)| (v - value).abs() < SAME * value.abs();
        if value.is_finite() && value != 0.0 && !out.iter().any(near) && out.len() < TRIED {
            out.push((value, column));
        }
    }
    out
}

/// One state's sensor, tried with offsets.
struct Trial<'a> {
    problem: &'a Problem,
    state: usize,
    judge: &'a Judge,
    /// Criterion beyond which a fit is given up.
    hopeless: f64,
}

impl Trial<'_> {
    /// Without one term the offset is found, then all terms go that it explains.
    fn settle(
        &self,
        value: f64,
        (found, without): (&Fit, usize),
        go_on: GoOn,
    ) -> Option<(f64, Fit)> {
        let start = self.moved(&found.point, value);
        let (mut value, mut fitted) = self.best(value, dropped(&start, without), go_on)?;
        loop {
            let weak = |i: &usize| {
                let error = fitted.variances[*i].sqrt();
                error > WEAK * fitted.coefficients()[*i].abs()
            };
            let strength = |i: &usize| fitted.coefficients()[*i].powi(2) / fitted.variances[*i];
            let mut order: Vec<usize> = (0..fitted.support().len()).filter(weak).collect();
            order.sort_by(|i, j| strength(i).total_cmp(&strength(j)));
            let next = order.first().and_then(|i| {
                let column = fitted.support()[*i];
                self.best(value, dropped(&fitted.point, column), go_on)
            });
            match next.filter(|(_, f)| f.value < fitted.value && !f.support().is_empty()) {
                Some(better) => (value, fitted) = better,
                None => return Some((value, fitted)),
            }
        }
    }

    /// The best offset near one, by parabolas.
    fn best(&self, value: f64, start: Point, go_on: GoOn) -> Option<(f64, Fit)> {
        let mut at = |v: f64, from: &Point, before: f64| {
            let problem = self.shifted(v);
            fit(
                &problem,
                self.moved(from, v - before),
                self.judge,
                self.hopeless,
                go_on,
            )
        };
        let mut middle = at(value, &start, value).filter(|f| f.value < self.hopeless)?;
        let mut value = value;
        let mut reach = NEAR * value.abs();
        for _ in 0..PARABOLAS {
            let left = at(value - reach, &middle.point, value)?;
            let right = at(value + reach, &middle.point, value)?;
            let (l, m, r) = (left.value, middle.value, right.value);
            let bend = l - 2.0 * m + r;
            let step = match bend > 0.0 {
                true => (0.5 * reach * (l - r) / bend).clamp(-4.0 * reach, 4.0 * reach),
                false => reach.copysign(l - r),
            };
            let next = at(value + step, &middle.point, value)?;
            let change = middle.value - next.value;
            if change > 0.0 {
                value += step;
                middle = next;
            }
            // Half a unit of the criterion is less than the offset's standard error.
            if change.abs() < 0.5 && step.abs() <= reach {
                break;
            }
            reach = (0.5 * step.abs()).clamp(0.05 * reach, reach);
        }
        Some((value, middle))
    }

    /// The problem as a sensor without the offset would have it.
    fn shifted(&self, value: f64) -> Problem {
        let n = self.problem.states();
        let mut out = self.problem.clone();
        for (record, curve) in out.records.iter_mut().zip(&mut out.curves) {
            record.measured[self.state]
                .iter_mut()
                .for_each(|x| *x -= value);
            let own = curve.states.iter_mut().skip(self.state).step_by(n);
            own.for_each(|x| *x -= value);
        }
        out
    }

    fn moved(&self, point: &Point, value: f64) -> Point {
        let n = self.problem.states();
        let mut out = point.clone();
        for path in &mut out.paths {
            let own = path.iter_mut().skip(self.state).step_by(n);
            own.for_each(|x| *x -= value);
        }
        out
    }
}

fn dropped(point: &Point, column: usize) -> Point {
    let mut out = point.clone();
    if let Some(at) = out.support.iter().position(|j| *j == column) {
        out.support.remove(at);
        out.coefficients.remove(at);
    }
    out
}
