//! Inputs that act later, or earlier, than they were recorded.
//!
//! In: a problem, the fit of a support, delays proposed for its inputs. Out: the delay that refits say has a larger likelihood, and the
//! problem with that delay. Records are compared over the instants for which every delay knows the input.

use super::fit::{Fit, Judge, as_it_is, fit};
use super::guide::GoOn;
use super::problem::{Point, Problem};
use super::record::{Outside, Record};
use super::screen::{Proposal, TRIED};
use super::search::{first, last_judge};
use crate::term::VarId;

/// Parts of a sample: what moves on a straight line may be late by these.
const PARTS: [f64; 4] = [2.0, 1.0, 0.5, 0.25];
/// Terms a law up to which a support is tried as it is.
const MOST: usize = 8;
/// Sets of inputs that delays are fitted for.
const SETS: usize = 2;
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

/// The delay that gains most, if it gains more than a term costs. Under a wrong input many small terms make up for it, and would under
/// any other: a delay is fitted with the few terms that proposed it, with those found if they are few, and if neither says
/// so, with terms chosen anew under the best proposal.
pub fn delay(
    problem: &Problem,
    found: &Fit,
    proposals: &[Proposal],
    go_on: &mut dyn FnMut() -> bool,
) -> Option<Late> {
    let reach = reach(problem);
    let base = cut(problem, reach, reach);
    let judge = last_judge(&base);
    let own = cut_point(problem, &found.point, (reach, reach));
    let as_found = as_it_is(&base, &own, &judge) + found.bent;
    let undelayed =
        fit(&base, own.clone(), &judge, f64::INFINITY, go_on).map_or(as_found, |f| f.value);
    let few = found.support().len() <= MOST * problem.system.laws.len();
    let trial = |proposal: &Proposal, start: Point, go_on: GoOn| {
        let mut trial = Trial {
            problem,
            inputs: &proposal.inputs,
            reach,
            judge: &judge,
            start,
            best: (0.0, undelayed),
        };
        trial.seek(proposal.samples, go_on);
        (undelayed - trial.best.1 > judge.penalty).then_some((trial.best, proposal.inputs.clone()))
    };
    let mut all = Vec::new();
    for proposal in proposals.iter().take(SETS) {
        all.extend(trial(
            proposal,
            cut_point(problem, &proposal.start, (reach, reach)),
            go_on,
        ));
        if few {
            all.extend(trial(proposal, own.clone(), go_on));
        }
    }
    if all.is_empty() {
        let proposal = proposals.first().filter(|p| p.samples != 0.0)?;
        let moved = moved(problem, &proposal.inputs, proposal.samples, reach);
        let start = first(&moved, &mut || go_on())?.point;
        all.extend(trial(proposal, start, go_on));
    }
    let best = all.into_iter().min_by(|a, b| a.0.1.total_cmp(&b.0.1));
    let ((samples, value), inputs) = best.filter(|b| b.0.0 != 0.0)?;
    Some(Late {
        inputs,
        samples,
        seconds: samples * step(problem)?,
        gain: undelayed - value,
    })
}

/// The criterion of a fit without the delay, over the samples that the delay leaves.
pub fn undelayed(
    problem: &Problem,
    found: &Fit,
    late: &Late,
    go_on: &mut dyn FnMut() -> bool,
) -> f64 {
    let (front, back) = ends(late);
    let problem_cut = cut(problem, front, back);
    let start = cut_point(problem, &found.point, (front, back));
    let fitted = fit(
        &problem_cut,
        start,
        &last_judge(&problem_cut),
        f64::INFINITY,
        go_on,
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

/// The problem with inputs so many samples later, over the instants for which every delay within `reach` knows them.
pub(super) fn moved(problem: &Problem, inputs: &[VarId], samples: f64, reach: usize) -> Problem {
    cut(&shifted(problem, inputs, samples), reach, reach)
}

/// One set of inputs, tried with delays.
struct Trial<'a> {
    problem: &'a Problem,
    inputs: &'a [VarId],
    reach: usize,
    judge: &'a Judge,
    /// The point of the best fit so far.
    start: Point,
    /// The best delay and its criterion.
    best: (f64, f64),
}

impl Trial<'_> {
    fn try_out(&mut self, samples: f64, go_on: GoOn) {
        if samples.abs() > self.reach as f64 {
            return;
        }
        let problem = moved(self.problem, self.inputs, samples, self.reach);
        let start = self.start.clone();
        let Some(found) = fit(&problem, start, self.judge, f64::INFINITY, go_on) else {
            return;
        };
        if found.value < self.best.1 {
            self.best = (samples, found.value);
            self.start = found.point;
        }
    }

    /// The best delay about one that was proposed; no delay is one too.
    fn seek(&mut self, proposed: f64, go_on: &mut dyn FnMut() -> bool) {
        self.try_out(proposed, go_on);
        if proposed != 0.0 && go_on() {
            self.try_out(0.0, go_on);
        }
        let smallest = if self.held() { 1.0 } else { 0.0 };
        for part in PARTS.into_iter().filter(|p| *p >= smallest) {
            let middle = self.best.0;
            for sign in [1.0, -1.0] {
                if !go_on() {
                    return;
                }
                self.try_out(middle + sign * part, go_on);
            }
        }
    }

    fn held(&self) -> bool {
        let problem = self.problem;
        let own = |s: &crate::term::Signal| self.inputs.contains(&s.var);
        let mut signals = problem
            .system
            .outside
            .iter()
            .enumerate()
            .filter(|(_, s)| own(s));
        signals.any(|(x, _)| {
            let outside = problem.records.iter().filter_map(|r| r.outside.get(x));
            outside.into_iter().any(|o| o.held)
        })
    }
}

/// Samples that delays may reach: so many that the longest record has enough left.
pub(super) fn reach(problem: &Problem) -> usize {
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
