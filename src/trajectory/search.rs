//! Which terms: supports proposed on linearised likelihoods, accepted only where the refitted likelihood improves.
//!
//! In: a problem. Out: the best fit, its rivals, and how many were tried. The floor under the noise is lowered in steps: first the
//! few terms that explain most, then what they leave. Never decides whether the answer is to be trusted.

use std::collections::BTreeMap;

use super::beam::{Subset, subsets};
use super::fit::{Fit, Judge, fit};
use super::problem::{Point, Problem};
use super::quadratic::Quadratic;
use super::worth::readings_as_one;

/// Floors under the noise, relative to the spread, largest first.
const FLOORS: [f64; 5] = [0.1, 0.01, 1e-3, 1e-4, 1e-5];
/// A floor this near the noise that smoothing saw is skipped.
const NEAR: f64 = 1.5;
/// No floor is lower than this part of that noise.
const TRUSTED: f64 = 0.5;
/// Noise of the laws in the first forms, in units of the sensors'.
const FIRST_SLACKS: [f64; 2] = [0.3, 0.03];
/// Multiples of the penalty that supports are proposed for.
const FIRST_PENALTIES: [f64; 3] = [1.0, 4.0, 16.0];
const PENALTIES: [f64; 5] = [1.0, 2.0, 4.0, 8.0, 16.0];
/// Cost of a term, in logarithms of the number of readings.
const TERM: f64 = 1.5;
/// Terms a law that the beam goes to.
const MOST: usize = 7;
/// Fits a level, not counting those carried over and the first ones.
const FITS: usize = 40;
/// A proposal whose predicted criterion is worse than this is not fitted.
const WORSE: f64 = 3.0;
/// Nor, when all else is done, one worse than this, which the data would tell from the best.
const APART: f64 = 6.0;
/// Rivals fitted at the end.
const RIVALS: usize = 12;
/// Fits carried over to the next level.
const CARRIED: usize = 3;
/// Best subsets a law that are proposed.
const PROPOSED: usize = 4;
/// Single changes proposed.
const CHANGES: usize = 6;
/// An improvement smaller than this is none.
const BETTER: f64 = 1e-3;
/// Terms up to which every one is tried without at the end.
const PRUNED: usize = 30;
/// Readings that count as one above which the choice is made anew.
const REPEATED: f64 = 1.5;
/// Readings that a record is worth at least.
const FEW: f64 = 4.0;

/// What the search came to.
#[derive(Debug)]
pub struct Found {
    pub best: Fit,
    /// Every support fitted at the last level with its criterion, best first; the best fit's own is the first.
    pub rivals: Rivals,
    /// Fits in all.
    pub tried: usize,
    /// Cost of a term.
    pub penalty: f64,
    /// Readings that count as one: 1 where the residuals are white.
    pub as_one: f64,
}

/// Supports tried at one level.
struct Level<'a> {
    problem: &'a Problem,
    judge: Judge,
    /// Criterion of each support tried; ∞ where the fit failed.
    tried: BTreeMap<Vec<usize>, f64>,
    /// The best fits, best first.
    best: Vec<Fit>,
}

type Rivals = Vec<(Vec<usize>, f64)>;

impl<'a> Level<'a> {
    /// A level with the fits carried over from the one before.
    fn new(problem: &'a Problem, judge: Judge, carried: &mut Vec<Fit>) -> Level<'a> {
        let mut level = Level {
            problem,
            judge,
            tried: BTreeMap::new(),
            best: Vec::new(),
        };
        for f in carried.drain(..) {
            let sigma = level.sigma(&problem.noise);
            level.fit(Point { sigma, ..f.point });
        }
        level
    }

    /// The best fits, and every support that could be fitted, best first.
    fn end(self) -> (Vec<Fit>, Rivals) {
        let fitted = self.tried.into_iter().filter(|(_, v)| v.is_finite());
        let mut rivals: Rivals = fitted.collect();
        rivals.sort_by(|a, b| a.1.total_cmp(&b.1));
        (self.best, rivals)
    }

    /// Fits a support, unless it was; true if it became the best.
    fn fit(&mut self, point: Point) -> bool {
        if point.support.is_empty() || self.tried.contains_key(&point.support) {
            return false;
        }
        let support = point.support.clone();
        let found = fit(self.problem, point, &self.judge);
        let value = found.as_ref().map_or(f64::INFINITY, |f| f.value);
        self.tried.insert(support, value);
        let Some(found) = found else { return false };
        let before = self.best.first().map_or(f64::INFINITY, |f| f.value);
        let place = self.best.partition_point(|f| f.value <= found.value);
        self.best.insert(place, found);
        self.best.truncate(CARRIED);
        value < before - BETTER
    }

    fn sigma(&self, at: &[f64]) -> Vec<f64> {
        at.iter()
            .zip(&self.judge.floor)
            .map(|(s, f)| s.max(*f))
            .collect()
    }

    /// From the smooth curves: best subsets a law, at several strengths.
    fn start(&mut self) {
        let problem = self.problem;
        let sigma = self.sigma(&problem.noise);
        for slack in FIRST_SLACKS {
            let form = problem.first_form(&sigma, slack);
            let sizes: Vec<Vec<Subset>> = (problem.ranges.iter())
                .map(|r| subsets(&form, &[], r.clone(), MOST))
                .collect();
            let all: Vec<usize> = (0..form.p).collect();
            let least = form.least(&all).square.max(0.0);
            let scale = (least / problem.measurements() as f64).max(1.0);
            for strength in FIRST_PENALTIES {
                let penalty = self.judge.penalty * strength * scale;
                let cost = |s: &&Subset| s.square + penalty * s.columns.len() as f64;
                let best = sizes
                    .iter()
                    .filter_map(|all| all.iter().min_by(|a, b| cost(a).total_cmp(&cost(b))));
                let mut support: Vec<usize> =
                    best.flat_map(|s| s.columns.iter().copied()).collect();
                support.sort_unstable();
                let coefficients = form.least(&support).coefficients;
                let point = problem.start(&sigma);
                self.fit(Point {
                    support,
                    coefficients,
                    ..point
                });
            }
            let Some(best) = self.best.first().cloned() else {
                continue;
            };
            let Ok(form) = problem.form(&best.point) else {
                continue;
            };
            if let Some(support) = form.backward(&[self.judge.penalty]).into_iter().next() {
                let support = form.improve(&support, self.judge.penalty);
                self.fit(moved(&form, &best.point, support));
            }
        }
    }

    /// Follows improvements until none is found among what the linearised likelihood proposes.
    fn improve(&mut self, last: bool) {
        let mut fits = 0;
        while fits < FITS {
            let Some(current) = self.best.first().cloned() else {
                return;
            };
            let Ok(form) = self.problem.form(&current.point) else {
                return;
            };
            let mut better = false;
            for (change, support) in self.proposals(&form, &current.point.support) {
                if change > WORSE || fits >= FITS {
                    break;
                }
                fits += 1;
                better = self.fit(moved(&form, &current.point, support));
                if better {
                    break;
                }
            }
            if !better && last {
                let rivals = self.proposals(&form, &current.point.support);
                let near = rivals.into_iter().take_while(|(change, _)| *change < APART);
                for (_, support) in near.take(RIVALS) {
                    better |= self.fit(moved(&form, &current.point, support));
                }
            }
            if !better && last && current.support().len() <= PRUNED {
                better = self.prune(&form, &current);
            }
            if !better {
                return;
            }
        }
    }

    /// Tries without each single term.
    fn prune(&mut self, form: &Quadratic, current: &Fit) -> bool {
        let mut better = false;
        for j in current.support() {
            let without = current
                .support()
                .iter()
                .copied()
                .filter(|i| i != j)
                .collect();
            better |= self.fit(moved(form, &current.point, without));
        }
        better
    }

    /// Supports not fitted yet with the predicted change of the criterion, best first.
    fn proposals(&self, form: &Quadratic, support: &[usize]) -> Vec<(f64, Vec<usize>)> {
        let penalty = self.judge.penalty;
        let value = |s: &[usize]| form.least(s).square + penalty * s.len() as f64;
        let base = value(support);
        let mut all: BTreeMap<Vec<usize>, f64> = BTreeMap::new();
        let mut propose = |s: Vec<usize>, change: f64| {
            if !s.is_empty() && !self.tried.contains_key(&s) {
                let known = all.entry(s).or_insert(change);
                *known = known.min(change);
            }
        };
        let strengths = PENALTIES.map(|s| s * penalty);
        let strongest =
            (0..form.p).max_by(|i, j| form.right[*i].abs().total_cmp(&form.right[*j].abs()));
        for (backward, strength) in form.backward(&strengths).into_iter().zip(strengths) {
            let starts = [backward, strongest.into_iter().collect(), support.to_vec()];
            let cost = |s: &Vec<usize>| form.least(s).square + strength * s.len() as f64;
            let ends = starts.iter().map(|s| form.improve(s, strength));
            if let Some(best) = ends.min_by(|a, b| cost(a).total_cmp(&cost(b))) {
                let change = value(&best) - base;
                // Sparser supports are worth a fit whatever the linearised likelihood says.
                let change = if strength > 2.0 * penalty {
                    change.min(0.0)
                } else {
                    change
                };
                propose(best, change);
            }
        }
        let mut combined = support.to_vec();
        for range in &self.problem.ranges {
            if range.is_empty() {
                continue;
            }
            let others: Vec<usize> = support
                .iter()
                .copied()
                .filter(|j| !range.contains(j))
                .collect();
            let mut best = subsets(form, support, range.clone(), MOST);
            let cost = |s: &Subset| s.square + penalty * s.columns.len() as f64;
            best.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
            for s in best.iter().take(PROPOSED) {
                let change = cost(s) + penalty * others.len() as f64 - base;
                propose(joined(&others, &s.columns), change);
            }
            if let Some(s) = best.first() {
                combined.retain(|j| !range.contains(j));
                combined = joined(&combined, &s.columns);
            }
        }
        let change = value(&combined) - base;
        propose(combined, change);
        for m in form.moves(support, penalty, CHANGES) {
            propose(m.applied(support), m.change);
        }
        let mut all: Vec<(f64, Vec<usize>)> = all.into_iter().map(|(s, c)| (c, s)).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)));
        all
    }
}

/// Searches the support of all laws together. `None` if nothing could be fitted.
pub fn search(problem: &Problem, go_on: &mut dyn FnMut() -> bool) -> Option<Found> {
    let penalty = TERM * (problem.measurements() as f64).ln();
    let relative = |i: usize| problem.noise[i] / problem.spread[i];
    let noisiest = (0..problem.states())
        .filter(|i| problem.readings[*i] > 0)
        .map(relative)
        .fold(0.0, f64::max);
    let lowest = FLOORS[FLOORS.len() - 1];
    let floors = FLOORS
        .into_iter()
        .filter(|f| *f > NEAR * noisiest || *f == lowest);
    let floors: Vec<f64> = floors.collect();
    let mut carried: Vec<Fit> = Vec::new();
    let mut tried = 0;
    let mut found: Option<Found> = None;
    let judge = |floor: f64, penalty: f64| Judge {
        floor: (problem.spread.iter().zip(&problem.noise))
            .map(|(d, s)| (floor * d).max(TRUSTED * s))
            .collect(),
        penalty,
    };
    for (place, floor) in floors.iter().enumerate() {
        let last = place + 1 == floors.len();
        let mut level = Level::new(problem, judge(*floor, penalty), &mut carried);
        if place == 0 || last || level.best.is_empty() {
            level.start();
        }
        if go_on() {
            level.improve(last);
        }
        tried += level.tried.len();
        let (best, rivals) = level.end();
        carried = best;
        if let Some(best) = carried.first().cloned() {
            found = Some(Found {
                best,
                rivals,
                tried,
                penalty,
                as_one: 1.0,
            });
        }
    }
    let mut found = found?;
    let as_one = readings_as_one(problem, &found.best);
    if as_one > REPEATED && go_on() {
        // Laws that are only nearly right: what each term earns is counted in readings that say something new.
        let readings = (problem.measurements() as f64 / as_one).max(FEW);
        let dear = as_one * TERM * readings.ln();
        let mut level = Level::new(problem, judge(lowest, dear), &mut carried);
        level.start();
        level.improve(true);
        tried += level.tried.len();
        let (best, rivals) = level.end();
        if let Some(best) = best.into_iter().next() {
            found = Found {
                best,
                rivals,
                tried,
                penalty: dear,
                as_one,
            };
        }
    }
    let wider = readings_as_one(problem, &found.best);
    found.best.variances.iter_mut().for_each(|v| *v *= wider);
    Some(found)
}

fn moved(form: &Quadratic, from: &Point, support: Vec<usize>) -> Point {
    let coefficients = form.least(&support).coefficients;
    Point {
        support,
        coefficients,
        ..from.clone()
    }
}

fn joined(a: &[usize], b: &[usize]) -> Vec<usize> {
    let mut all: Vec<usize> = a.iter().chain(b).copied().collect();
    all.sort_unstable();
    all
}
