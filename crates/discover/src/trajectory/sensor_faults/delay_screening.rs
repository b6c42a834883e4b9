//! Delays of inputs screened by integral matching, before any is fitted.
//!
//! In: a problem, which variables are inputs, the present support. Out: for every set of inputs the delay under which a few simple terms
//! leave least, with those terms. Cheap, since the columns are few. Accepts no delay.

use super::time_shift::{moved, reach};
use crate::trajectory::cancellation::join;
use crate::trajectory::model::{LinearizationPoint, Problem};
use crate::trajectory::search::{ConstrainedForm, final_criterion, minimum};
use crate::trajectory::thresholds::{DELAYS, SEARCH};
use sidc_lang::term::VarId;
use sidc_progress::Observer;
use sidc_solve::QuadraticForm;

/// A delay to be fitted.
pub struct DelayProposal {
    pub inputs: Vec<VarId>,
    /// How many samples later than recorded the inputs act; 0 if no delay leaves less.
    pub samples: f64,
    /// χ² that is left.
    pub(crate) value: f64,
    /// The smoothed trajectories with the terms and their coefficients.
    pub(crate) start: LinearizationPoint,
}

/// The best delay of all inputs together and of each input, best first. The terms of `support` are among the columns. Sets of inputs are
/// left out once the observer ends the work.
pub fn screen_delays(
    problem: &Problem,
    support: &[usize],
    inputs: &[VarId],
    observer: &mut dyn Observer,
) -> Vec<DelayProposal> {
    let mut sets: Vec<Vec<VarId>> = inputs.iter().map(|v| vec![*v]).collect();
    if inputs.len() > 1 {
        sets.insert(0, inputs.to_vec());
    }
    let screen = DelayScreen::new(problem, support, inputs);
    let best = |set| screen.best(set, observer);
    let mut found: Vec<DelayProposal> = sets.into_iter().filter_map(best).collect();
    found.sort_by(|a, b| a.value.total_cmp(&b.value));
    found
}

/// The problem with few columns.
struct DelayScreen {
    few: Problem,
    /// Their places in the whole problem.
    columns: Vec<usize>,
    /// Noise of each sensor, but no less than arithmetic resolves.
    sigma: Vec<f64>,
    reach: usize,
    penalty: f64,
}

impl DelayScreen {
    fn new(problem: &Problem, support: &[usize], inputs: &[VarId]) -> DelayScreen {
        let columns = columns(problem, support, inputs);
        let criterion = final_criterion(problem);
        let noise = problem
            .noise
            .iter()
            .zip(&criterion.floor)
            .zip(&problem.informative);
        DelayScreen {
            few: restricted(problem, &columns),
            sigma: noise
                .map(|((s, f), informative)| s.max(*f) / informative.sqrt())
                .collect(),
            columns,
            reach: reach(problem),
            penalty: criterion.penalty,
        }
    }

    fn best(&self, inputs: Vec<VarId>, observer: &mut dyn Observer) -> Option<DelayProposal> {
        let tried: Vec<usize> = DELAYS
            .screened
            .into_iter()
            .filter(|s| *s <= self.reach)
            .collect();
        let some = |delays: &[usize], observer: &mut dyn Observer| -> Option<Vec<(f64, f64)>> {
            let delays = delays.iter().map(|s| *s as f64);
            delays
                .map(|s| Some((s, self.left(&inputs, s, observer)?)))
                .collect()
        };
        let (short, long) = tried.split_at(tried.len() / 2);
        let (short, long) = join(
            observer,
            |observer| some(short, observer),
            |observer| some(long, observer),
        );
        let mut best = (0.0, self.left(&inputs, 0.0, observer)?);
        for (samples, value) in short?.into_iter().chain(long?) {
            if value < best.1 {
                best = (samples, value);
            }
        }
        let (samples, value) = best;
        let form = self.form(&inputs, samples, observer)?;
        let support = self.support(&form);
        Some(DelayProposal {
            samples,
            value,
            start: LinearizationPoint {
                coefficients: match minimum(&form, &self.few.system.constraints, &support) {
                    Some((coefficients, _)) => coefficients,
                    None => form.least_squares(&support).coefficients,
                },
                support: support.iter().map(|j| self.columns[*j]).collect(),
                ..self.few.initial_point(&self.sigma)
            },
            inputs,
        })
    }

    /// The quadratic form with inputs delayed.
    fn form(
        &self,
        inputs: &[VarId],
        samples: f64,
        observer: &mut dyn Observer,
    ) -> Option<QuadraticForm> {
        let moved = moved(&self.few, inputs, samples, self.reach);
        moved.integral_matching_form(&self.sigma, SEARCH.initial_slacks[0], observer)
    }

    /// χ² with all columns: they are too few to imitate a delay.
    fn left(&self, inputs: &[VarId], samples: f64, observer: &mut dyn Observer) -> Option<f64> {
        let form = self.form(inputs, samples, observer)?;
        Some(form.least_squares(&(0..form.p).collect::<Vec<_>>()).square)
    }

    /// Backward elimination, with the price of a term in units of the χ² that all columns leave.
    fn support(&self, form: &QuadraticForm) -> Vec<usize> {
        let least = form
            .least_squares(&(0..form.p).collect::<Vec<_>>())
            .square
            .max(0.0);
        let scale = (least / self.few.measurements() as f64).max(1.0);
        let supports = form.backward_elimination(&[self.penalty * scale]);
        let support = supports.into_iter().next().unwrap_or_default();
        let constraints = &self.few.system.constraints;
        if constraints.is_empty() {
            return support;
        }
        let mut search = ConstrainedForm::new(form, constraints, &self.few.ranges);
        let repaired = search.repaired(&support, self.penalty * scale);
        repaired.map_or(support, |s| s.columns)
    }
}

/// The columns of a support and the simplest of every law.
pub(super) fn columns(problem: &Problem, support: &[usize], inputs: &[VarId]) -> Vec<usize> {
    let system = &problem.system;
    let has = |j: usize, v: &VarId| {
        let mut found = false;
        system.columns[j].for_each_signal(&mut |s| found |= s.var == *v);
        found
    };
    let degree = |j: &usize| system.columns[*j].degree();
    let each = (DELAYS.simple_columns / inputs.len().max(1)).max(DELAYS.columns_per_input);
    let mut all = support.to_vec();
    for law in &system.laws {
        let mut simple: Vec<usize> = law.columns.clone().collect();
        simple.sort_by(|a, b| degree(a).total_cmp(&degree(b)));
        let free = simple
            .iter()
            .filter(|j| !inputs.iter().any(|v| has(**j, v)));
        all.extend(free.take(DELAYS.simple_columns));
        for input in inputs {
            all.extend(simple.iter().filter(|j| has(**j, input)).take(each));
        }
    }
    all.sort_unstable();
    all.dedup();
    all
}

/// The problem with only these columns, rising.
pub(super) fn restricted(problem: &Problem, columns: &[usize]) -> Problem {
    let mut out = problem.clone();
    let system = &mut out.system;
    for law in &mut system.laws {
        let place = |j: usize| columns.partition_point(|c| *c < j);
        law.columns = place(law.columns.start)..place(law.columns.end);
    }
    let kept = columns.iter().map(|j| problem.system.columns[*j].clone());
    system.columns = kept.collect();
    let place = |column: usize| columns.binary_search(&column).ok();
    system.constraints = system.constraints.renumbered(&place);
    let origin: Vec<Option<usize>> = columns.iter().copied().map(Some).collect();
    out.run_columns = problem.run_columns.moved(&origin);
    out.compile_columns();
    out
}
