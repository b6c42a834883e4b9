//! Inputs that act later, or earlier, than they were recorded.
//!
//! In: a problem, the fit of a support, which variables are inputs. Out: the delay under which the same support has a larger
//! likelihood, and the problem with that delay. Records are compared over the instants for which every delay knows the input.

use super::fit::{Fit, Judge, fit};
use super::problem::{Point, Problem};
use super::record::{Outside, Record};
use super::search::last_judge;
use crate::term::VarId;

/// Delays tried first, in samples of the record, to both sides.
const TRIED: [usize; 12] = [1, 2, 3, 4, 5, 6, 8, 10, 12, 14, 17, 20];
/// So many in a row that are worse than the best end the search to that side.
const WORSE: usize = 4;
/// Parts of a sample: what moves on a straight line may be late by these.
const PARTS: [f64; 4] = [2.0, 1.0, 0.5, 0.25];
/// A record is cut by no more than this part of it.
const CUT: usize = 5;

/// Inputs with a delay.
#[derive(Clone, Debug, PartialEq)]
pub struct Late {
    pub inputs: Vec<VarId>,
    /// Positive if it acts later than its record says.
    pub samples: f64,
    pub seconds: f64,
    /// What the criterion gains.
    pub gain: f64,
}

/// The delay that gains most, if it gains more than a term costs: of all inputs together, or of one of them.
pub fn delay(
    problem: &Problem,
    found: &Fit,
    inputs: &[VarId],
    go_on: &mut dyn FnMut() -> bool,
) -> Option<Late> {
    let reach = reach(problem);
    let step = step(problem)?;
    let mut sets: Vec<Vec<VarId>> = inputs.iter().map(|v| vec![*v]).collect();
    if inputs.len() > 1 {
        sets.insert(0, inputs.to_vec());
    }
    let mut best: Option<Late> = None;
    for set in sets {
        let mut trial = Trial::new(problem, found, &set, reach)?;
        let (samples, value) = trial.best(go_on);
        let gain = trial.undelayed - value;
        let before = best.as_ref().map_or(trial.judge.penalty, |b| b.gain);
        if samples != 0.0 && gain > before {
            best = Some(Late {
                inputs: set,
                samples,
                seconds: samples * step,
                gain,
            });
        }
    }
    best
}

/// The problem with inputs delayed; where a record does not say what they were, it is cut.
pub fn delayed(problem: &Problem, late: &Late) -> Problem {
    let whole = late.samples.abs().ceil() as usize;
    let (front, back) = if late.samples > 0.0 {
        (whole, 0)
    } else {
        (0, whole)
    };
    cut(&shifted(problem, &late.inputs, late.samples), front, back)
}

/// One set of inputs, tried with delays.
struct Trial<'a> {
    problem: &'a Problem,
    inputs: &'a [VarId],
    reach: usize,
    judge: Judge,
    start: Point,
    /// Criterion without delay.
    undelayed: f64,
    held: bool,
}

impl<'a> Trial<'a> {
    fn new(problem: &'a Problem, found: &Fit, inputs: &'a [VarId], reach: usize) -> Option<Self> {
        let base = cut(problem, reach, reach);
        let judge = last_judge(&base);
        let start = Point {
            paths: (problem.records.iter().zip(found.paths()))
                .map(|(record, path)| {
                    let (from, to) = kept(record, reach, reach);
                    path[from * problem.states()..to * problem.states()].to_vec()
                })
                .collect(),
            ..found.point.clone()
        };
        let base = fit(&base, start, &judge, f64::INFINITY)?;
        let own = |s: &crate::term::Signal| inputs.contains(&s.var);
        let signals = problem.system.outside.iter().enumerate();
        let held = signals.filter(|(_, s)| own(s)).any(|(x, _)| {
            let outside = problem.records.iter().filter_map(|r| r.outside.get(x));
            outside.into_iter().any(|o| o.held)
        });
        Some(Trial {
            problem,
            inputs,
            reach,
            judge,
            undelayed: base.value,
            start: base.point,
            held,
        })
    }

    fn value(&self, samples: f64) -> f64 {
        let problem = shifted(self.problem, self.inputs, samples);
        let problem = cut(&problem, self.reach, self.reach);
        let fitted = fit(&problem, self.start.clone(), &self.judge, f64::INFINITY);
        fitted.map_or(f64::INFINITY, |f| f.value)
    }

    /// The best delay and its criterion.
    fn best(&mut self, go_on: &mut dyn FnMut() -> bool) -> (f64, f64) {
        let mut best = (0.0, self.undelayed);
        for sign in [1.0, -1.0] {
            let mut worse = 0;
            for samples in TRIED.iter().filter(|s| **s <= self.reach) {
                if !go_on() {
                    return best;
                }
                let samples = sign * *samples as f64;
                let value = self.value(samples);
                worse = if value < best.1 { 0 } else { worse + 1 };
                if value < best.1 {
                    best = (samples, value);
                } else if worse >= WORSE {
                    break;
                }
            }
        }
        let smallest = if self.held { 1.0 } else { 0.0 };
        for part in PARTS.iter().filter(|p| **p >= smallest) {
            for sign in [1.0, -1.0] {
                let samples = best.0 + sign * part;
                if samples.abs() > self.reach as f64 || !go_on() {
                    continue;
                }
                let value = self.value(samples);
                if value < best.1 {
                    best = (samples, value);
                }
            }
        }
        best
    }
}

/// Samples that delays may reach: so many that the longest record has enough left.
fn reach(problem: &Problem) -> usize {
    let longest = problem.records.iter().map(Record::len).max().unwrap_or(0);
    (longest / CUT).min(TRIED[TRIED.len() - 1])
}

/// Median step of all records, seconds.
fn step(problem: &Problem) -> Option<f64> {
    let steps = problem.records.iter().flat_map(|r| r.time.windows(2));
    let mut steps: Vec<f64> = steps.map(|w| w[1] - w[0]).collect();
    if steps.is_empty() {
        return None;
    }
    let middle = steps.len() / 2;
    Some(*steps.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Which samples of a record stay; a short one is left as it is.
fn kept(record: &Record, front: usize, back: usize) -> (usize, usize) {
    let length = record.len();
    match length < CUT * front.max(back) {
        true => (0, length),
        false => (front, length - back),
    }
}

/// The problem without the first and the last samples of its records.
fn cut(problem: &Problem, front: usize, back: usize) -> Problem {
    let (n, m) = (problem.states(), problem.system.laws.len());
    let mut out = problem.clone();
    for (record, curve) in out.records.iter_mut().zip(&mut out.curves) {
        let (from, to) = kept(record, front, back);
        let keep = |column: &[f64]| column[from..to].to_vec();
        record.time = keep(&record.time);
        record.measured.iter_mut().for_each(|c| *c = keep(c));
        record
            .outside
            .iter_mut()
            .for_each(|o| o.values = keep(&o.values));
        curve.states = curve.states[from * n..to * n].to_vec();
        curve.rates = curve.rates[from * m..to * m].to_vec();
    }
    out.left_out.retain_mut(|l| {
        let Some((from, to)) = problem.records.get(l.record).map(|r| kept(r, front, back)) else {
            return false;
        };
        let stays = (from..to).contains(&l.sample);
        l.sample = l.sample.saturating_sub(from);
        stays
    });
    out.look();
    out
}

/// The problem with inputs so many samples later.
fn shifted(problem: &Problem, inputs: &[VarId], samples: f64) -> Problem {
    let mut out = problem.clone();
    let seconds = samples * step(problem).unwrap_or(0.0);
    for record in &mut out.records {
        let signals = problem.system.outside.iter().zip(&mut record.outside);
        for (_, outside) in signals.filter(|(s, _)| inputs.contains(&s.var)) {
            let at = record.time.iter().map(|t| t - seconds);
            outside.values = at.map(|t| value(&record.time, outside, t)).collect();
        }
    }
    out
}

/// What acts at an instant; at the ends of the record, what acts there.
fn value(time: &[f64], outside: &Outside, at: f64) -> f64 {
    let x = |k: usize| outside.values.get(k).copied().unwrap_or(f64::NAN);
    let next = time.partition_point(|t| *t <= at);
    if next == 0 || next == time.len() {
        return x(next.min(time.len().saturating_sub(1)));
    }
    let part = (at - time[next - 1]) / (time[next] - time[next - 1]);
    if outside.held {
        // Delays are whole samples, but for rounding of time.
        return if part > 0.5 { x(next) } else { x(next - 1) };
    }
    x(next - 1) + part * (x(next) - x(next - 1))
}
