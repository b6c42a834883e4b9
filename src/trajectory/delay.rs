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
/// Terms a law up to which a support is taken as it is.
const MOST: usize = 8;
/// Multiples of a term's price that sparser ones are proposed for, and how many of those are tried.
const STRENGTHS: [f64; 6] = [4.0, 16.0, 64.0, 256.0, 1024.0, 4096.0];
const SPARSE: usize = 2;
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
    let judge = last_judge(&cut(problem, reach, reach));
    let starts = starts(problem, found);
    let mut best: Option<(f64, Late)> = None;
    for set in sets {
        for start in &starts {
            let Some(trial) = Trial::new(problem, start, &set, (reach, &judge)) else {
                continue;
            };
            let (samples, value) = trial.best(go_on);
            let gain = trial.undelayed - value;
            let better = best.as_ref().is_none_or(|(before, _)| value < *before);
            if samples != 0.0 && gain > judge.penalty && better {
                let late = Late {
                    inputs: set.clone(),
                    samples,
                    seconds: samples * step,
                    gain,
                };
                best = Some((value, late));
            }
        }
    }
    best.map(|(_, late)| late)
}

/// Supports that delays are tried with. Under a wrong input many small terms make up for it, and would under any other: the few
/// that explain most tell the delay.
fn starts(problem: &Problem, found: &Fit) -> Vec<Point> {
    let most = MOST * problem.system.laws.len();
    if found.support().len() <= most {
        return vec![found.point.clone()];
    }
    let Ok(form) = problem.form(&found.point) else {
        return Vec::new();
    };
    let penalty = last_judge(problem).penalty;
    let mut supports = form.backward(&STRENGTHS.map(|s| s * penalty));
    supports.retain(|s| !s.is_empty() && s.len() <= most);
    supports.dedup();
    supports.truncate(SPARSE);
    let point = |support: Vec<usize>| Point {
        coefficients: form.least(&support).coefficients,
        support,
        ..found.point.clone()
    };
    supports.into_iter().map(point).collect()
}

/// The criterion of a fit without the delay, over the samples that the delay leaves.
pub fn undelayed(problem: &Problem, found: &Fit, late: &Late) -> f64 {
    let (front, back) = ends(late);
    let problem_cut = cut(problem, front, back);
    let start = cut_point(problem, &found.point, (front, back));
    let fitted = fit(
        &problem_cut,
        start,
        &last_judge(&problem_cut),
        f64::INFINITY,
    );
    fitted.map_or(f64::INFINITY, |f| f.value)
}

/// Samples at both ends of a record whose input is not known.
fn ends(late: &Late) -> (usize, usize) {
    let whole = late.samples.abs().ceil() as usize;
    match late.samples > 0.0 {
        true => (whole, 0),
        false => (0, whole),
    }
}

fn cut_point(problem: &Problem, point: &Point, (front, back): (usize, usize)) -> Point {
    let n = problem.states();
    let part = |(record, path): (&Record, &Vec<f64>)| {
        let (from, to) = kept(record, front, back);
        path[from * n..to * n].to_vec()
    };
    Point {
        paths: problem.records.iter().zip(&point.paths).map(part).collect(),
        ..point.clone()
    }
}

/// The problem with inputs delayed; where a record does not say what they were, it is cut.
pub fn delayed(problem: &Problem, late: &Late) -> Problem {
    let (front, back) = ends(late);
    cut(&shifted(problem, &late.inputs, late.samples), front, back)
}

/// One set of inputs, tried with delays.
struct Trial<'a> {
    problem: &'a Problem,
    inputs: &'a [VarId],
    reach: usize,
    judge: &'a Judge,
    start: Point,
    /// Criterion without delay.
    undelayed: f64,
    held: bool,
}

impl<'a> Trial<'a> {
    fn new(
        problem: &'a Problem,
        start: &Point,
        inputs: &'a [VarId],
        (reach, judge): (usize, &'a Judge),
    ) -> Option<Self> {
        let start = cut_point(problem, start, (reach, reach));
        let base = fit(&cut(problem, reach, reach), start, judge, f64::INFINITY)?;
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
        let fitted = fit(&problem, self.start.clone(), self.judge, f64::INFINITY);
        fitted.map_or(f64::INFINITY, |f| f.value)
    }

    /// The best delay and its criterion.
    fn best(&self, go_on: &mut dyn FnMut() -> bool) -> (f64, f64) {
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
