//! Continuation over noise floors: the search for the support of all laws together.
//!
//! In: a problem. Out: the best fit, its rivals, and how many supports were tried. The floor under the noise falls level by level: first
//! come the few terms that explain most, then those that explain what is left.

use super::noise_floor_search::NoiseFloorSearch;
use super::search_observer::{FitBudget, SearchObserver};
use crate::trajectory::likelihood::{
    Fit, PenalizedLikelihood, fit, set_variances, undisturbed_value,
};
use crate::trajectory::model::{LinearizationPoint, Problem};
use crate::trajectory::residuals::statistical_inefficiency;
use crate::trajectory::thresholds::SEARCH;
use sidc_progress::Observer;
use std::collections::BTreeMap;

/// A support and its fit.
#[derive(Clone, Debug)]
pub struct Rival {
    pub support: Vec<usize>,
    /// Its criterion.
    pub value: f64,
    /// Whether an unknown constant takes another value: one outside its 95 % interval in the answer, or that of a search from elsewhere.
    pub moves_constants: bool,
}

impl Rival {
    /// A support fitted at the constants of the answer.
    pub fn new(support: Vec<usize>, value: f64) -> Rival {
        Rival {
            support,
            value,
            moves_constants: false,
        }
    }
}

/// The result of a search.
#[derive(Clone, Debug)]
pub struct Found {
    pub best: Fit,
    /// Every support fitted at the last level with its criterion, best first; the first is the best fit's own.
    pub rivals: Vec<Rival>,
    /// Number of fits.
    pub tried: usize,
    /// Price of a term.
    pub penalty: f64,
    /// Statistical inefficiency of the residuals: readings that count as one independent one.
    pub inefficiency: f64,
}

/// Columns with their coefficients, from another method; columns rising.
pub type StartingSupport = Vec<(usize, f64)>;

/// Searches the support of all laws together, from `start` if that explains the readings. `None` if nothing could be fitted.
///
/// Long records are searched on segments first. The support found there, and what is proposed about it, is then fitted on all samples.
pub fn search(
    problem: &Problem,
    start: &[(usize, f64)],
    observer: &mut dyn SearchObserver,
) -> Option<Found> {
    if problem.system.columns.is_empty() {
        return fit_given(problem, starting_point(problem, &[]), observer);
    }
    let mut found = match problem.on_segments() {
        None => search_whole(problem, start, observer)?,
        Some(short) => {
            let found = search_whole(&short, start, observer)?;
            let start = LinearizationPoint {
                paths: problem.initial_point(&[]).paths,
                ..found.best.point.clone()
            };
            let plan = Plan::last_level(found.inefficiency).near();
            let all = match observer.go_on() {
                true => continuation(problem, vec![start.clone()], plan, observer),
                false => None,
            };
            // After a stop, the support found on segments is still fitted on all samples once: without that it is no answer.
            let all = match all {
                None => continuation(problem, vec![start], plan, &mut FitBudget::default())?,
                Some(all) => all,
            };
            Found {
                tried: found.tried + all.tried,
                ..all
            }
        }
    };
    set_variances(problem, &mut found.best, observer);
    Some(found)
}

/// The fit of laws that are all given.
pub(super) fn fit_given(
    problem: &Problem,
    start: LinearizationPoint,
    observer: &mut dyn Observer,
) -> Option<Found> {
    let criterion = final_criterion(problem);
    let mut best = fit(problem, start, &criterion, f64::INFINITY, observer)?;
    set_variances(problem, &mut best, observer);
    Some(Found {
        rivals: vec![Rival::new(Vec::new(), best.value)],
        tried: 1,
        penalty: criterion.penalty,
        inefficiency: statistical_inefficiency(problem, &best),
        best,
    })
}

/// All levels, or the last one alone where the start explains the readings.
fn search_whole(
    problem: &Problem,
    start: &[(usize, f64)],
    observer: &mut dyn SearchObserver,
) -> Option<Found> {
    if !problem.system.hidden.is_empty() && !start.is_empty() {
        let point = starting_point(problem, start);
        return continuation(problem, vec![point], Plan::last_level(1.0), observer);
    }
    match explaining_start(problem, start, observer) {
        Some(point) => {
            let plan = Plan {
                most_terms: SEARCH.terms_of_start * point.support.len(),
                ..Plan::all_levels()
            };
            continuation(problem, vec![point], plan, observer)
        }
        None => search_with_inefficiency(problem, observer),
    }
}

/// The fit of a start where it leaves white residuals of the size of the noise: no other support then explains the readings better, and
/// only sparser ones and near ones are of interest. Without that, the search needs its levels.
fn explaining_start(
    problem: &Problem,
    start: &[(usize, f64)],
    observer: &mut dyn Observer,
) -> Option<LinearizationPoint> {
    if start.is_empty() {
        return None;
    }
    let mut level = NoiseFloorSearch::new(problem, final_criterion(problem));
    level.fit([starting_point(problem, start)], observer);
    let fit = level.best.into_iter().next()?;
    let explains = fit.converged && explains_readings(problem, &fit);
    explains.then_some(fit.point)
}

/// A start along the smoothed readings.
fn starting_point(problem: &Problem, start: &[(usize, f64)]) -> LinearizationPoint {
    let (support, coefficients) = start.iter().copied().unzip();
    let level = NoiseFloorSearch::new(problem, final_criterion(problem));
    LinearizationPoint {
        support,
        coefficients,
        ..problem.initial_point(&level.sigma(&problem.noise))
    }
}

fn explains_readings(problem: &Problem, fit: &Fit) -> bool {
    let white = statistical_inefficiency(problem, fit) <= SEARCH.max_inefficiency;
    let mut sensors = fit
        .sigma()
        .iter()
        .zip(&problem.noise)
        .zip(&problem.readings);
    white && sensors.all(|((left, noise), read)| *read == 0 || *left <= SEARCH.start_noise * noise)
}

/// Laws that are only nearly right leave coloured residuals. The choice is then made again with a price of terms for the effective
/// number of readings.
fn search_with_inefficiency(problem: &Problem, observer: &mut dyn SearchObserver) -> Option<Found> {
    let found = continuation(problem, Vec::new(), Plan::all_levels(), observer)?;
    let inefficiency = statistical_inefficiency(problem, &found.best);
    if inefficiency <= SEARCH.max_inefficiency || !observer.go_on() {
        return Some(found);
    }
    let start = vec![found.best.point.clone()];
    let Some(again) = continuation(problem, start, Plan::last_level(inefficiency), observer) else {
        return Some(found);
    };
    Some(Found {
        tried: found.tried + again.tried,
        ..again
    })
}

/// The fits that ended, best first.
pub(super) fn rivals_among(tried: BTreeMap<Vec<usize>, f64>) -> Vec<Rival> {
    let fitted = tried.into_iter().filter(|(_, value)| value.is_finite());
    let mut rivals: Vec<Rival> = fitted.map(|(s, value)| Rival::new(s, value)).collect();
    rivals.sort_by(|a, b| a.value.total_cmp(&b.value));
    rivals
}

impl Found {
    /// The answer of the same criterion fitted from a point, with its variances.
    pub(crate) fn refitted(
        &self,
        problem: &Problem,
        point: LinearizationPoint,
        observer: &mut dyn Observer,
    ) -> Option<Found> {
        let criterion = last_criterion(problem, self.inefficiency);
        let mut best = fit(problem, point, &criterion, f64::INFINITY, observer)?;
        set_variances(problem, &mut best, observer);
        Some(Found {
            best,
            ..self.clone()
        })
    }

    /// −2 log likelihood of the best fit, without the price of its terms.
    pub fn misfit(&self, problem: &Problem) -> f64 {
        let criterion = last_criterion(problem, self.inefficiency);
        self.best.value - criterion.cost(problem, self.best.support())
    }

    /// What the terms of a support cost more than those of the best fit.
    pub fn extra_cost(&self, problem: &Problem, support: &[usize]) -> f64 {
        let criterion = last_criterion(problem, self.inefficiency);
        criterion.cost(problem, support) - criterion.cost(problem, self.best.support())
    }

    /// The criterion if every reading counts, by which answers to other noises are compared.
    pub fn value_of_all_readings(&self, problem: &Problem) -> f64 {
        self.misfit(problem) + final_criterion(problem).cost(problem, self.best.support())
    }
}

/// The criterion of an answer without disturbances if every reading counts, as answers with disturbances count: by innovations. `None` where
/// the laws diverge or the observer ends the work.
pub fn value_by_innovations(
    problem: &Problem,
    found: &Found,
    observer: &mut dyn Observer,
) -> Option<f64> {
    undisturbed_value(problem, &found.best, &final_criterion(problem), observer)
}

/// Which levels a search goes through, and what it may try there.
#[derive(Clone, Copy)]
pub(super) struct Plan {
    /// Statistical inefficiency that prices terms.
    inefficiency: f64,
    /// Whether the first level and the last one start from integral matching too, and the last one tries the support without each term.
    fresh: bool,
    /// The lowest floor alone.
    last_only: bool,
    /// Supports of more terms are not fitted.
    most_terms: usize,
}

impl Plan {
    fn all_levels() -> Plan {
        Plan {
            last_only: false,
            ..Plan::last_level(1.0)
        }
    }

    /// The lowest floor, from the points that are given and from integral matching.
    pub fn last_level(inefficiency: f64) -> Plan {
        Plan {
            inefficiency,
            fresh: true,
            last_only: true,
            most_terms: usize::MAX,
        }
    }

    /// From the points that are given alone.
    pub fn near(self) -> Plan {
        Plan {
            fresh: false,
            ..self
        }
    }
}

/// One level after another.
pub(super) fn continuation(
    problem: &Problem,
    start: Vec<LinearizationPoint>,
    plan: Plan,
    observer: &mut dyn SearchObserver,
) -> Option<Found> {
    let Plan {
        inefficiency,
        fresh,
        ..
    } = plan;
    let relative = |i: usize| problem.noise[i] / problem.spread[i % problem.states()];
    let noisiest = (0..problem.noise.len())
        .filter(|i| problem.readings[*i] > 0)
        .map(relative)
        .fold(0.0, f64::max);
    let lowest = SEARCH.floors[SEARCH.floors.len() - 1];
    let floors = SEARCH
        .floors
        .into_iter()
        .filter(|f| *f > SEARCH.floor_over_noise * noisiest || *f == lowest);
    let mut floors: Vec<f64> = floors.collect();
    if plan.last_only {
        floors = vec![lowest];
    }
    let anew = start.is_empty();
    let mut carried = start;
    let mut tried = 0;
    let mut result = None;
    for place in 0..floors.len() {
        let last = place + 1 == floors.len();
        let mut level = NoiseFloorSearch::new(
            problem,
            PenalizedLikelihood::at_floor(problem, floors[place], inefficiency),
        );
        level.most_terms = plan.most_terms;
        let penalty = level.criterion.penalty;
        let sigma = level.sigma(&problem.noise);
        let points = carried.drain(..).map(|point| LinearizationPoint {
            sigma: sigma.clone(),
            ..point
        });
        level.fit(points.collect::<Vec<_>>(), observer);
        if level.best.is_empty() || fresh && (place == 0 || last) {
            level.propose_and_fit_initial(observer);
        }
        let first = level.best.first().filter(|_| anew && place == 0);
        if first.is_some_and(|fit| !observer.first(problem, fit)) {
            return None;
        }
        level.improve((last, fresh), observer);
        tried += level.tried.len();
        let rivals = rivals_among(level.tried);
        carried = level.best.iter().map(|f| f.point.clone()).collect();
        if let Some(best) = level.best.into_iter().next() {
            result = Some(Found {
                best,
                rivals,
                tried,
                penalty,
                inefficiency,
            });
        }
    }
    result
}

/// The criterion of the last level for white residuals.
pub(crate) fn final_criterion(problem: &Problem) -> PenalizedLikelihood {
    last_criterion(problem, 1.0)
}

/// The same for residuals of this statistical inefficiency.
pub(crate) fn last_criterion(problem: &Problem, inefficiency: f64) -> PenalizedLikelihood {
    let lowest = SEARCH.floors[SEARCH.floors.len() - 1];
    PenalizedLikelihood::at_floor(problem, lowest, inefficiency)
}

/// The best fit of the supports that integral matching proposes, under the highest floor.
pub(crate) fn initial_fit(problem: &Problem, observer: &mut dyn Observer) -> Option<Fit> {
    let mut level = NoiseFloorSearch::new(
        problem,
        PenalizedLikelihood::at_floor(problem, SEARCH.floors[0], 1.0),
    );
    level.propose_and_fit_initial(observer);
    level.best.into_iter().next()
}
