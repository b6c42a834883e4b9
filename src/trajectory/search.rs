//! Which terms: supports proposed on linearised likelihoods, accepted only where the refitted likelihood improves.
//!
//! In: a problem. Out: the best fit, its rivals, and how many were tried. The floor under the noise is lowered in steps: first the
//! few terms that explain most, then what they leave. Never decides whether the answer is to be trusted.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::beam::{Subset, subsets};
use super::errors;
use super::fit::{Fit, Judge, fit};
use super::guide::{GoOn, Grace, Guide};
use super::pair::guided;
use super::problem::{Point, Problem};
use super::worth::readings_as_one;
use crate::solve::quadratic::Quadratic;

/// Floors under the noise, relative to the spread, largest first.
const FLOORS: [f64; 5] = [0.1, 0.01, 1e-3, 1e-4, 1e-5];
/// A floor this near the noise that smoothing saw is skipped.
const NEAR: f64 = 1.5;
/// Noise of the laws in the first forms, in units of the sensors'.
const FIRST_SLACKS: [f64; 2] = [0.3, 0.03];
/// Multiples of the penalty that supports are proposed for.
const FIRST_PENALTIES: [f64; 3] = [1.0, 4.0, 16.0];
const PENALTIES: [f64; 5] = [1.0, 2.0, 4.0, 8.0, 16.0];
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

/// What the search came to.
#[derive(Debug)]
pub struct Found {
    pub best: Fit,
    /// Every support fitted at the last level with its criterion, best first; the best fit's own is the first.
    pub rivals: Vec<(Vec<usize>, f64)>,
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
    /// The form about the fit of a support.
    form: Option<(Vec<usize>, Arc<Quadratic>)>,
}

impl<'a> Level<'a> {
    fn new(problem: &'a Problem, judge: Judge) -> Level<'a> {
        Level {
            problem,
            judge,
            tried: BTreeMap::new(),
            best: Vec::new(),
            form: None,
        }
    }

    /// Fits supports, but those that were, two at a time, as long as the guide goes on; true if one became the best.
    fn fit(&mut self, points: impl IntoIterator<Item = Point>, guide: &mut dyn Guide) -> bool {
        let mut points = points.into_iter();
        let mut better = false;
        while guide.in_time() {
            let mut pair: Vec<Point> = Vec::new();
            while pair.len() < 2 {
                let Some(point) = points.next() else { break };
                let seen = pair.iter().any(|p| p.support == point.support);
                if !(seen || point.support.is_empty() || self.tried.contains_key(&point.support)) {
                    pair.push(point);
                }
            }
            let (problem, judge) = (self.problem, &self.judge);
            let beat = self.best.first().map_or(f64::INFINITY, |f| f.value);
            let one =
                |p: Point, go_on: GoOn| (p.support.clone(), fit(problem, p, judge, beat, go_on));
            let (second, first) = (pair.pop(), pair.pop());
            let found = match (first, second) {
                (Some(a), Some(b)) => {
                    <[_; 2]>::from(guided(guide, |go| one(a, go), |go| one(b, go))).into()
                }
                (None, Some(b)) => vec![one(b, &mut || guide.in_time())],
                _ => return better,
            };
            for (support, found) in found {
                better |= self.enter(support, found);
            }
        }
        better
    }

    /// Notes what a fit came to; true if it became the best.
    fn enter(&mut self, support: Vec<usize>, found: Option<Fit>) -> bool {
        let value = found.as_ref().map_or(f64::INFINITY, |f| f.value);
        self.tried.insert(support, value);
        let Some(found) = found else { return false };
        let before = self.best.first().map_or(f64::INFINITY, |f| f.value);
        let place = self.best.partition_point(|f| f.value <= found.value);
        self.best.insert(place, found);
        self.best.truncate(CARRIED);
        value < before - BETTER
    }

    /// The best fit and the form about it, which is made once.
    fn about(&mut self, guide: &mut dyn Guide) -> Option<(Fit, Arc<Quadratic>)> {
        let best = self.best.first()?.clone();
        if let Some((support, form)) = &self.form
            && support == best.support()
        {
            return Some((best, form.clone()));
        }
        let form = self.problem.form(&best.point, &mut || guide.in_time());
        let form = Arc::new(form.ok()?);
        self.form = Some((best.support().to_vec(), form.clone()));
        Some((best, form))
    }

    fn sigma(&self, at: &[f64]) -> Vec<f64> {
        at.iter()
            .zip(&self.judge.floor)
            .zip(&self.problem.news)
            .map(|((s, f), news)| s.max(*f) / news.sqrt())
            .collect()
    }

    /// From the smooth curves: best subsets a law, at several strengths.
    fn start(&mut self, guide: &mut dyn Guide) {
        let problem = self.problem;
        let sigma = self.sigma(&problem.noise);
        let [first, second] = FIRST_SLACKS;
        let (first, second) = guided(
            guide,
            |go_on| problem.first_form(&sigma, first, go_on),
            |go_on| problem.first_form(&sigma, second, go_on),
        );
        for form in [first, second].into_iter().flatten() {
            let sizes: Vec<Vec<Subset>> = (problem.ranges.iter())
                .map(|r| subsets(&form, &[], r.clone(), MOST))
                .collect();
            let all: Vec<usize> = (0..form.p).collect();
            let least = form.least(&all).square.max(0.0);
            let scale = (least / problem.measurements() as f64).max(1.0);
            let point = |strength: f64| {
                let penalty = self.judge.penalty * strength * scale;
                let cost = |s: &&Subset| s.square + penalty * s.columns.len() as f64;
                let best = sizes
                    .iter()
                    .filter_map(|all| all.iter().min_by(|a, b| cost(a).total_cmp(&cost(b))));
                let mut support: Vec<usize> =
                    best.flat_map(|s| s.columns.iter().copied()).collect();
                support.sort_unstable();
                moved(&form, &problem.start(&sigma), support)
            };
            let points = FIRST_PENALTIES.map(point);
            self.fit(points, guide);
            let Some((best, form)) = self.about(guide) else {
                continue;
            };
            if let Some(support) = form.backward(&[self.judge.penalty]).into_iter().next() {
                let support = form.improve(&support, self.judge.penalty);
                self.fit([moved(&form, &best.point, support)], guide);
            }
        }
    }

    /// Follows improvements until none is found among what the linearised likelihood proposes. The `last` level tries rivals too, and
    /// does `without` each single term, unless fewer samples have told already what each is worth.
    fn improve(&mut self, (last, without): (bool, bool), guide: &mut dyn Guide) {
        let mut fits = 0;
        while fits < FITS && guide.go_on() {
            let Some((current, form)) = self.about(guide) else {
                return;
            };
            let point = |support| moved(&form, &current.point, support);
            let proposals = self.proposals(&form, current.support(), guide);
            let near = proposals.iter().take_while(|(change, _)| *change <= WORSE);
            let near: Vec<Vec<usize>> = near.map(|(_, s)| s.clone()).collect();
            let mut better = false;
            for pair in near[..near.len().min(FITS - fits)].chunks(2) {
                fits += pair.len();
                better = self.fit(pair.iter().cloned().map(point), guide);
                if better {
                    break;
                }
                if !guide.go_on() {
                    return;
                }
            }
            if !better && last {
                let new = |s: &Vec<usize>| !self.tried.contains_key(s);
                let rivals = proposals.into_iter().filter(|(_, s)| new(s));
                let near = rivals.take_while(|(change, _)| *change < APART);
                let near: Vec<Vec<usize>> = near.take(RIVALS).map(|(_, s)| s).collect();
                better = self.fit(near.into_iter().map(point), guide);
            }
            let support = current.support();
            if !better && last && without && support.len() <= PRUNED {
                // Without each single term.
                let without = |j: &usize| support.iter().copied().filter(|i| i != j).collect();
                better = self.fit(support.iter().map(|j| point(without(j))), guide);
            }
            if !better {
                return;
            }
        }
    }

    /// Supports not fitted yet with the predicted change of the criterion, best first.
    fn proposals(
        &self,
        form: &Quadratic,
        support: &[usize],
        guide: &mut dyn Guide,
    ) -> Vec<(f64, Vec<usize>)> {
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
            if !guide.in_time() {
                break;
            }
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
            if range.is_empty() || !guide.in_time() {
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
///
/// Long records are searched on stretches first; all samples then judge what was found there, and what is proposed about it.
pub fn search(problem: &Problem, guide: &mut dyn Guide) -> Option<Found> {
    let mut found = match problem.shortened() {
        None => weighed(problem, guide)?,
        Some(short) => {
            let found = weighed(&short, guide)?;
            let start = Point {
                paths: problem.start(&[]).paths,
                ..found.best.point.clone()
            };
            let level = (found.as_one, false);
            let all = match guide.in_time() {
                true => levels(problem, vec![start.clone()], level, guide),
                false => None,
            };
            // What was found by the time it is stopped counts for nothing until all samples have judged it.
            let all = match all {
                None => levels(problem, vec![start], level, &mut Grace::default())?,
                Some(all) => all,
            };
            Found {
                tried: found.tried + all.tried,
                ..all
            }
        }
    };
    errors::judge(problem, &mut found.best, &mut || guide.in_time());
    Some(found)
}

/// Laws that are only nearly right leave residuals that follow each other: the choice is then made anew, what each term earns being
/// counted in readings that say something new.
fn weighed(problem: &Problem, guide: &mut dyn Guide) -> Option<Found> {
    let found = levels(problem, Vec::new(), (1.0, true), guide)?;
    let as_one = readings_as_one(problem, &found.best);
    if as_one <= REPEATED || !guide.go_on() {
        return Some(found);
    }
    let start = vec![found.best.point.clone()];
    let Some(again) = levels(problem, start, (as_one, true), guide) else {
        return Some(found);
    };
    Some(Found {
        tried: found.tried + again.tried,
        ..again
    })
}

/// Level after level, lower and lower floors under the noise; the last one alone if there are points to start from. `as_one`
/// readings count as one; `fresh` levels start from the smooth curves too.
fn levels(
    problem: &Problem,
    start: Vec<Point>,
    (as_one, fresh): (f64, bool),
    guide: &mut dyn Guide,
) -> Option<Found> {
    let relative = |i: usize| problem.noise[i] / problem.spread[i % problem.states()];
    let noisiest = (0..problem.noise.len())
        .filter(|i| problem.readings[*i] > 0)
        .map(relative)
        .fold(0.0, f64::max);
    let lowest = FLOORS[FLOORS.len() - 1];
    let floors = FLOORS
        .into_iter()
        .filter(|f| *f > NEAR * noisiest || *f == lowest);
    let mut floors: Vec<f64> = floors.collect();
    if !start.is_empty() {
        floors = vec![lowest];
    }
    let anew = start.is_empty();
    let mut carried = start;
    let mut tried = 0;
    let mut result = None;
    for place in 0..floors.len() {
        let last = place + 1 == floors.len();
        let mut level = Level::new(problem, Judge::level(problem, floors[place], as_one));
        let penalty = level.judge.penalty;
        let sigma = level.sigma(&problem.noise);
        let points = carried.drain(..).map(|point| Point {
            sigma: sigma.clone(),
            ..point
        });
        level.fit(points.collect::<Vec<_>>(), guide);
        if level.best.is_empty() || fresh && (place == 0 || last) {
            level.start(guide);
        }
        let first = level.best.first().filter(|_| anew && place == 0);
        if first.is_some_and(|fit| !guide.first(problem, fit)) {
            return None;
        }
        level.improve((last, fresh), guide);
        tried += level.tried.len();
        let mut rivals: Vec<(Vec<usize>, f64)> = level
            .tried
            .into_iter()
            .filter(|(_, v)| v.is_finite())
            .collect();
        rivals.sort_by(|a, b| a.1.total_cmp(&b.1));
        carried = level.best.iter().map(|f| f.point.clone()).collect();
        if let Some(best) = level.best.into_iter().next() {
            result = Some(Found {
                best,
                rivals,
                tried,
                penalty,
                as_one,
            });
        }
    }
    result
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

/// The judge of the last level, every reading counted.
pub(super) fn last_judge(problem: &Problem) -> Judge {
    Judge::level(problem, FLOORS[FLOORS.len() - 1], 1.0)
}

/// The best fit of what the smooth curves propose, under the highest floor.
pub(super) fn first(problem: &Problem, guide: &mut dyn Guide) -> Option<Fit> {
    let mut level = Level::new(problem, Judge::level(problem, FLOORS[0], 1.0));
    level.start(guide);
    level.best.into_iter().next()
}
