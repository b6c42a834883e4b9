//! The search on several runs, and what to do where not all of them can be followed together.
//!
//! In: a problem of several runs. Out: the best fit, and the runs that it does not follow, with the time from which it does not. One
//! bad record must not spoil the others: if all together leave more than noise, each run is searched alone. Laws are then found from
//! the runs that can be followed, together if they agree, else with a coefficient for each run. Never writes messages.

use std::borrow::Cow;

use crate::doubts::trajectory_rules;
use crate::joint::delay_outlier_search::search_system;
use crate::joint::joint_fit::{JointFit, unexplained};
use crate::options::Options;
use crate::trajectory;
use crate::trajectory::{Found, POOLING, Problem, Rival, RunNotFollowed, StartingSupport};
use sidc_lang::model::Model;
use sidc_progress::EquationObserver;

/// A fit to the runs that can be followed.
pub(crate) struct PooledFit<'a> {
    pub fit: JointFit<'a>,
    /// Runs that the fit does not follow and was not found from.
    pub not_followed: Vec<RunNotFollowed>,
}

/// Searches all equations on all runs, or on those that can be followed. `None` if no support could be fitted to any.
pub(crate) fn search_runs<'a>(
    (model, problem): (&Model, &'a Problem),
    start: Option<StartingSupport>,
    options: &Options,
    watcher: &mut EquationObserver,
) -> Option<PooledFit<'a>> {
    let all = search_system((model, problem), start.clone(), options, watcher);
    let runs = problem.runs();
    let several = (2..=POOLING.max_runs).contains(&runs.len());
    let explained = all.as_ref().is_some_and(explains);
    if explained || !several || watcher.stop().is_some() {
        return all.map(whole);
    }
    let mut search = RunSearch {
        model,
        problem,
        start,
        options,
        watcher,
    };
    let alone: Vec<(usize, Option<JointFit>)> = (runs.iter())
        .map(|run| (*run, search.on_runs(&[*run])))
        .collect();
    if search.watcher.stop().is_some() {
        return all.map(whole);
    }
    let explained = |fit: &Option<JointFit>| fit.as_ref().is_some_and(explains);
    let good: Vec<usize> = alone
        .iter()
        .filter(|a| explained(&a.1))
        .map(|a| a.0)
        .collect();
    // If only half of the runs or fewer are explained when searched alone, the library may lack a term that the others need.
    let most = 2 * good.len() > runs.len() || all.is_none();
    if most && let Some(found) = search.fit_explained_runs(&good, &runs, &alone) {
        return Some(found);
    }
    all.map(whole).or_else(|| search.fit_any_runs(alone, &runs))
}

fn whole(fit: JointFit) -> PooledFit {
    PooledFit {
        fit,
        not_followed: Vec::new(),
    }
}

/// Whether residuals are no larger than the noise of the sensors. Autocorrelation alone is no reason to separate runs: nearly right
/// laws cause it, and coefficients for each run would hide it.
fn explains(fit: &JointFit) -> bool {
    let channels = trajectory::channels(&fit.problem, &fit.found.best);
    !channels.iter().any(trajectory_rules::misfits)
}

struct RunSearch<'p, 'w, 'o> {
    model: &'p Model,
    problem: &'p Problem,
    start: Option<StartingSupport>,
    options: &'p Options,
    watcher: &'w mut EquationObserver<'o>,
}

impl RunSearch<'_, '_, '_> {
    /// The search on the given runs alone.
    fn on_runs<'b>(&mut self, runs: &[usize]) -> Option<JointFit<'b>> {
        let part = self.problem.on_runs(runs);
        let found = search_system(
            (self.model, &part),
            self.start.clone(),
            self.options,
            self.watcher,
        )?;
        Some(found.into_owned())
    }

    /// The fit to the runs that are explained alone: with shared coefficients, or else with coefficients for each run.
    fn fit_explained_runs<'b>(
        &mut self,
        good: &[usize],
        runs: &[usize],
        alone: &[(usize, Option<JointFit<'static>>)],
    ) -> Option<PooledFit<'b>> {
        if good.len() < 2 {
            let fit = self.on_runs(good.get(..1)?)?;
            return Some(self.leaving_out(fit, good, runs));
        }
        if good.len() < runs.len()
            && let Some(fit) = self.on_runs(good).filter(explains)
        {
            return Some(self.leaving_out(fit, good, runs));
        }
        let fit = self.run_by_run(good, alone)?;
        Some(self.leaving_out(fit, good, runs))
    }

    /// The best of several fits: the support found on each run alone, fitted to all of them with coefficients that may differ between
    /// runs.
    fn run_by_run<'b>(
        &mut self,
        good: &[usize],
        alone: &[(usize, Option<JointFit<'static>>)],
    ) -> Option<JointFit<'b>> {
        let part = self.problem.on_runs(good);
        let mut best: Option<JointFit> = None;
        let mut tried: Vec<Vec<usize>> = Vec::new();
        for (_, fit) in alone.iter().filter(|(run, _)| good.contains(run)) {
            // The support of a run with a delay of its own is not tried on the others.
            let Some(own) = fit.as_ref().filter(|f| f.late.is_none()) else {
                continue;
            };
            let point = &own.found.best.point;
            if tried.contains(&point.support) {
                continue;
            }
            tried.push(point.support.clone());
            let inefficiency = own.found.inefficiency;
            let found = trajectory::fit_by_run(&part, point, inefficiency, self.watcher);
            let Some((problem, fit)) = found else {
                continue;
            };
            let value = best.as_ref().map_or(f64::INFINITY, |b| b.found.best.value);
            if fit.value < value && !unexplained(&problem, &fit) {
                let found = Found {
                    rivals: vec![Rival::new(fit.support().to_vec(), fit.value)],
                    tried: own.found.tried,
                    penalty: own.found.penalty,
                    best: fit,
                    inefficiency,
                };
                best = Some(JointFit::new(Cow::Owned(problem), found, None));
            }
        }
        best
    }

    /// The fit to the runs that can be followed at all: all of them together, or else the longest alone.
    fn fit_any_runs<'b>(
        &mut self,
        alone: Vec<(usize, Option<JointFit<'b>>)>,
        runs: &[usize],
    ) -> Option<PooledFit<'b>> {
        let able: Vec<usize> = alone
            .iter()
            .filter(|a| a.1.is_some())
            .map(|a| a.0)
            .collect();
        if (2..runs.len()).contains(&able.len())
            && let Some(fit) = self.on_runs(&able)
        {
            return Some(self.leaving_out(fit, &able, runs));
        }
        let able = alone.into_iter().filter_map(|(run, fit)| Some((run, fit?)));
        let longest = able.max_by_key(|(run, fit)| (fit.problem.samples(), usize::MAX - run))?;
        Some(self.leaving_out(longest.1, &[longest.0], runs))
    }

    fn leaving_out<'b>(
        &mut self,
        fit: JointFit<'b>,
        used: &[usize],
        runs: &[usize],
    ) -> PooledFit<'b> {
        let others = runs.iter().filter(|run| !used.contains(run));
        let mut not_followed = Vec::new();
        let noise = noise_of_runs(&fit);
        for run in others {
            let problem = match &fit.late {
                None => Cow::Borrowed(self.problem),
                Some(late) => Cow::Owned(trajectory::with_delay(self.problem, late)),
            };
            let laws = &fit.found.best.point;
            // If every run has coefficients of its own, there are none to follow this run with.
            let at = match fit.problem.run_columns.is_empty() {
                true => trajectory::left_by(&problem, (laws, &noise), *run, self.watcher),
                false => None,
            };
            not_followed.push(at.unwrap_or(RunNotFollowed {
                trajectory: *run,
                time: None,
            }));
        }
        PooledFit { fit, not_followed }
    }
}

/// The noise of each state's sensors in the fit, the largest over the runs; infinite for states that are not read.
fn noise_of_runs(fit: &JointFit) -> Vec<f64> {
    let (problem, n) = (&fit.problem, fit.problem.states());
    let sigma = fit.found.best.sigma();
    let of_state = |i: usize| {
        let read = (i..sigma.len())
            .step_by(n)
            .filter(|s| problem.readings[*s] > 0);
        let largest = read.map(|s| sigma[s]).fold(0.0, f64::max);
        if largest > 0.0 {
            largest
        } else {
            f64::INFINITY
        }
    };
    (0..n).map(of_state).collect()
}
