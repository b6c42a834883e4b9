//! Which delays of inputs are worth fits: laws along the smooth curves, with inputs moved.
//!
//! In: a problem, which variables are inputs, terms that matter. Out: for every set of inputs the delay under which a few simple terms leave
//! least, with those terms. Linear in samples and delays, and quick, since the columns are few. Nothing is fitted: these are
//! proposals. Never accepts one.

use super::delay::{moved, reach};
use super::guide::GoOn;
use super::pair::guided;
use super::problem::{Point, Problem};
use super::search::last_judge;
use crate::solve::quadratic::Quadratic;
use crate::term::{Expr, Tape, VarId};

/// Delays tried, in samples of the record, to both sides.
pub(super) const TRIED: [usize; 12] = [1, 2, 3, 4, 5, 6, 8, 10, 12, 14, 17, 20];
/// Simplest columns a law that are taken: without inputs, and with inputs (of each input at least so many).
const SIMPLE: usize = 8;
const EACH: usize = 2;
/// Noise of the laws along the smooth curves, in units of the sensors'.
const SLACK: f64 = 0.3;

/// A delay that is worth a fit.
pub struct Proposal {
    pub inputs: Vec<VarId>,
    /// Positive if they act later than recorded; 0 if no delay leaves less.
    pub samples: f64,
    /// What is left, in units of the criterion.
    pub(super) value: f64,
    /// The smooth curves, the terms and their coefficients.
    pub(super) start: Point,
}

/// The best delay of all inputs together and of each, the best first. `support`: terms that are among those tried. Nothing where
/// `go_on` gave it up.
pub fn proposals(
    problem: &Problem,
    support: &[usize],
    inputs: &[VarId],
    go_on: &mut dyn FnMut() -> bool,
) -> Vec<Proposal> {
    let mut sets: Vec<Vec<VarId>> = inputs.iter().map(|v| vec![*v]).collect();
    if inputs.len() > 1 {
        sets.insert(0, inputs.to_vec());
    }
    let screen = Screen::new(problem, support, inputs);
    let best = |set| screen.best(set, go_on);
    let mut found: Vec<Proposal> = sets.into_iter().filter_map(best).collect();
    found.sort_by(|a, b| a.value.total_cmp(&b.value));
    found
}

/// A problem with so few columns that every delay can be looked at.
struct Screen {
    few: Problem,
    /// Those of the problem that it has.
    columns: Vec<usize>,
    /// Noise of each sensor, but no less than arithmetic resolves.
    sigma: Vec<f64>,
    reach: usize,
    penalty: f64,
}

impl Screen {
    fn new(problem: &Problem, support: &[usize], inputs: &[VarId]) -> Screen {
        let columns = columns(problem, support, inputs);
        let judge = last_judge(problem);
        let noise = problem.noise.iter().zip(&judge.floor).zip(&problem.news);
        Screen {
            few: restricted(problem, &columns),
            sigma: noise
                .map(|((s, f), news)| s.max(*f) / news.sqrt())
                .collect(),
            columns,
            reach: reach(problem),
            penalty: judge.penalty,
        }
    }

    fn best(&self, inputs: Vec<VarId>, go_on: GoOn) -> Option<Proposal> {
        let tried = || TRIED.into_iter().filter(|s| *s <= self.reach);
        let side = |sign: f64, go_on: GoOn| -> Option<Vec<(f64, f64)>> {
            let delays = tried().map(|s| sign * s as f64);
            delays
                .map(|s| Some((s, self.left(&inputs, s, go_on)?)))
                .collect()
        };
        let guide = &mut || go_on();
        let (later, earlier) = guided(guide, |go_on| side(1.0, go_on), |go_on| side(-1.0, go_on));
        let mut best = (0.0, self.left(&inputs, 0.0, go_on)?);
        for (samples, value) in later?.into_iter().chain(earlier?) {
            if value < best.1 {
                best = (samples, value);
            }
        }
        let (samples, value) = best;
        let form = self.form(&inputs, samples, go_on)?;
        let support = self.support(&form);
        Some(Proposal {
            samples,
            value,
            start: Point {
                coefficients: form.least(&support).coefficients,
                support: support.iter().map(|j| self.columns[*j]).collect(),
                ..self.few.start(&self.sigma)
            },
            inputs,
        })
    }

    /// The quadratic form with inputs so many samples later.
    fn form(&self, inputs: &[VarId], samples: f64, go_on: GoOn) -> Option<Quadratic> {
        let moved = moved(&self.few, inputs, samples, self.reach);
        moved.first_form(&self.sigma, SLACK, go_on)
    }

    /// χ² of all columns: they are so few that chance makes no delay of it.
    fn left(&self, inputs: &[VarId], samples: f64, go_on: GoOn) -> Option<f64> {
        let form = self.form(inputs, samples, go_on)?;
        Some(form.least(&(0..form.p).collect::<Vec<_>>()).square)
    }

    /// Terms that are worth their price, in units of what all of them leave.
    fn support(&self, form: &Quadratic) -> Vec<usize> {
        let least = form.least(&(0..form.p).collect::<Vec<_>>()).square.max(0.0);
        let scale = (least / self.few.measurements() as f64).max(1.0);
        let supports = form.backward(&[self.penalty * scale]);
        supports.into_iter().next().unwrap_or_default()
    }
}

/// Those of a support, and the simplest of every law.
fn columns(problem: &Problem, support: &[usize], inputs: &[VarId]) -> Vec<usize> {
    let system = &problem.system;
    let has = |j: usize, v: &VarId| {
        let mut found = false;
        system.columns[j].for_each_signal(&mut |s| found |= s.var == *v);
        found
    };
    let degree = |j: &usize| system.columns[*j].degree();
    let each = (SIMPLE / inputs.len().max(1)).max(EACH);
    let mut all = support.to_vec();
    for law in &system.laws {
        let mut simple: Vec<usize> = law.columns.clone().collect();
        simple.sort_by(|a, b| degree(a).total_cmp(&degree(b)));
        let free = simple
            .iter()
            .filter(|j| !inputs.iter().any(|v| has(**j, v)));
        all.extend(free.take(SIMPLE));
        for input in inputs {
            all.extend(simple.iter().filter(|j| has(**j, input)).take(each));
        }
    }
    all.sort_unstable();
    all.dedup();
    all
}

/// The problem with some of its columns, rising.
fn restricted(problem: &Problem, columns: &[usize]) -> Problem {
    let mut out = problem.clone();
    let system = &mut out.system;
    for law in &mut system.laws {
        let place = |j: usize| columns.partition_point(|c| *c < j);
        law.columns = place(law.columns.start)..place(law.columns.end);
    }
    let kept = columns.iter().map(|j| problem.system.columns[*j].clone());
    system.columns = kept.collect();
    let all: Vec<Expr> = system.columns.iter().map(|t| t.clone().into()).collect();
    out.all = Tape::new(&all, &system.inputs()).unwrap_or_default();
    out.ranges = system.laws.iter().map(|l| l.columns.clone()).collect();
    out
}
