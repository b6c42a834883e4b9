//! Inputs that act later than they were recorded. No command acts before it is given, so nothing earlier is tried.
//!
//! In: a problem, the fit of a support, screened delays. Out: the delay under which the refitted likelihood gains most, and the problem
//! with that delay. Fits are compared over the instants for which every delay knows the input.

use super::delay_screening::DelayProposal;
use super::time_shift::{cut, cut_point, moved, reach, shifted, step};
use crate::trajectory::likelihood::{Fit, PenalizedLikelihood, fit};
use crate::trajectory::model::{AppliedDelay, Exogenous, LinearizationPoint, Problem};
use crate::trajectory::search::{final_criterion, initial_fit};
use crate::trajectory::thresholds::DELAYS;
use sidc_lang::term::VarId;
use sidc_progress::Observer;

/// Inputs with a delay.
#[derive(Clone, Debug, PartialEq)]
pub struct DelayedInputs {
    pub inputs: Vec<VarId>,
    /// How many samples later than recorded the inputs act.
    pub samples: f64,
    pub seconds: f64,
    /// 95 % confidence interval, seconds; `None` where it was not estimated to a fraction of a sample.
    pub interval: Option<(f64, f64)>,
    /// Decrease of the criterion.
    pub gain: f64,
}

impl DelayedInputs {
    /// The delay of each input.
    pub fn applied(&self) -> impl Iterator<Item = AppliedDelay> {
        let each = |v: &VarId| AppliedDelay::known(*v, self.seconds);
        self.inputs.iter().map(each)
    }
}

/// The delay that improves the criterion most, if by more than the price of a term. Large supports found under the wrong delay
/// compensate for it, so they do not show the right one. A delay is therefore fitted with the few terms of its screening, and with the
/// terms found if they are few; if neither gains, with terms selected anew under the best proposal.
pub fn fit_delay(
    problem: &Problem,
    found: &Fit,
    proposals: &[DelayProposal],
    observer: &mut dyn Observer,
) -> Option<DelayedInputs> {
    let reach = reach(problem);
    let base = cut(problem, reach, reach);
    let criterion = final_criterion(&base);
    let own = cut_point(problem, &found.point, (reach, reach));
    let as_found = criterion.value_at(&base, &own) + found.law_misfit;
    let undelayed =
        fit(&base, own.clone(), &criterion, f64::INFINITY, observer).map_or(as_found, |f| f.value);
    // If no fit without the delay can be compared, no delay is preferred.
    if !undelayed.is_finite() {
        return None;
    }
    let few = found.support().len() <= DELAYS.max_terms * problem.system.laws.len();
    let trial =
        |proposal: &DelayProposal, start: LinearizationPoint, observer: &mut dyn Observer| {
            let mut trial = DelayTrial {
                problem,
                inputs: &proposal.inputs,
                reach,
                criterion: &criterion,
                start,
                best: (0.0, undelayed),
            };
            trial.refine(proposal.samples, observer);
            (undelayed - trial.best.1 > criterion.penalty)
                .then_some((trial.best, proposal.inputs.clone()))
        };
    let mut all = Vec::new();
    for proposal in proposals.iter().take(DELAYS.max_sets) {
        all.extend(trial(
            proposal,
            cut_point(problem, &proposal.start, (reach, reach)),
            observer,
        ));
        if few {
            all.extend(trial(proposal, own.clone(), observer));
        }
    }
    if all.is_empty() {
        let proposal = proposals.first().filter(|p| p.samples != 0.0)?;
        let moved = moved(problem, &proposal.inputs, proposal.samples, reach);
        let start = initial_fit(&moved, observer)?.point;
        all.extend(trial(proposal, start, observer));
    }
    let best = all.into_iter().min_by(|a, b| a.0.1.total_cmp(&b.0.1));
    let ((samples, value), inputs) = best.filter(|b| b.0.0 != 0.0)?;
    Some(DelayedInputs {
        inputs,
        samples,
        seconds: samples * step(problem)?,
        interval: None,
        gain: undelayed - value,
    })
}

/// The criterion without the delay, over the samples that [`with_delay`] keeps; `None` where no trajectory fits them without it.
pub fn criterion_without_delay(
    problem: &Problem,
    found: &Fit,
    late: &DelayedInputs,
    observer: &mut dyn Observer,
) -> Option<f64> {
    let (front, back) = ends(late);
    let problem_cut = cut(problem, front, back);
    let start = cut_point(problem, &found.point, (front, back));
    let fitted = fit(
        &problem_cut,
        start,
        &final_criterion(&problem_cut),
        f64::INFINITY,
        observer,
    );
    fitted.map(|f| f.value).filter(|v| v.is_finite())
}

/// Samples at the start and at the end of a record for which the delayed input is unknown.
pub(super) fn ends(late: &DelayedInputs) -> (usize, usize) {
    let whole = late.samples.abs().ceil() as usize;
    match late.samples > 0.0 {
        true => (whole, 0),
        false => (0, whole),
    }
}

/// The problem with inputs delayed, its records cut where the delayed input is unknown.
pub fn with_delay(problem: &Problem, late: &DelayedInputs) -> Problem {
    let (front, back) = ends(late);
    cut(&shifted(problem, &late.inputs, late.samples), front, back)
}

/// Fits of one support with different delays of a set of inputs.
struct DelayTrial<'a> {
    problem: &'a Problem,
    inputs: &'a [VarId],
    reach: usize,
    criterion: &'a PenalizedLikelihood,
    /// The best point so far.
    start: LinearizationPoint,
    /// The best delay and its criterion.
    best: (f64, f64),
}

impl DelayTrial<'_> {
    fn try_delay(&mut self, samples: f64, observer: &mut dyn Observer) {
        if !(0.0..=self.reach as f64).contains(&samples) {
            return;
        }
        let problem = moved(self.problem, self.inputs, samples, self.reach);
        let start = self.start.clone();
        let Some(found) = fit(&problem, start, self.criterion, f64::INFINITY, observer) else {
            return;
        };
        if found.value < self.best.1 {
            self.best = (samples, found.value);
            self.start = found.point;
        }
    }

    /// Searches about a proposed delay in falling steps; no delay is tried too.
    fn refine(&mut self, proposed: f64, observer: &mut dyn Observer) {
        self.try_delay(proposed, observer);
        if proposed != 0.0 && observer.go_on() {
            self.try_delay(0.0, observer);
        }
        let smallest = match is_held(self.problem, self.inputs) {
            true => 1.0,
            false => 0.0,
        };
        for part in DELAYS.steps.into_iter().filter(|p| *p >= smallest) {
            let middle = self.best.0;
            for sign in [1.0, -1.0] {
                if !observer.go_on() {
                    return;
                }
                self.try_delay(middle + sign * part, observer);
            }
        }
    }
}

/// Whether one of the inputs is held between its samples.
pub fn is_held(problem: &Problem, inputs: &[VarId]) -> bool {
    let signals = problem.system.exogenous.iter().enumerate();
    let mut own = signals.filter(|(_, s)| inputs.contains(&s.var));
    own.any(|(x, _)| {
        let exogenous = problem.records.iter().filter_map(|r| r.exogenous.get(x));
        exogenous.into_iter().any(Exogenous::is_held)
    })
}
