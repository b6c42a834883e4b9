//! The search at one floor under the noise: supports proposed on quadratic forms, fitted, and kept if they are better.
//!
//! In: a problem and a criterion. Out: the best fits and the criterion of every support tried.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use super::beam_search::{Subset, best_subsets};
use super::constrained_supports::{ConstrainedForm, minimum};
use crate::trajectory::cancellation::{each, join};
use crate::trajectory::likelihood::{Fit, PenalizedLikelihood, fit};
use crate::trajectory::model::{LinearizationPoint, Problem};
use crate::trajectory::thresholds::SEARCH;
use sidc_progress::{Activity, Observer, Stage};
use sidc_solve::QuadraticForm;

/// The search at one level of the noise floor.
pub(crate) struct NoiseFloorSearch<'a> {
    problem: &'a Problem,
    pub criterion: PenalizedLikelihood,
    /// Criterion of each support tried; ∞ where the fit failed.
    pub tried: BTreeMap<Vec<usize>, f64>,
    /// The best fits, best first.
    pub best: Vec<Fit>,
    /// Supports with more terms than this are not fitted.
    pub most_terms: usize,
    /// The quadratic form about the fit of this support.
    form: Option<(Vec<usize>, Arc<QuadraticForm>)>,
}

impl<'a> NoiseFloorSearch<'a> {
    pub fn new(problem: &'a Problem, criterion: PenalizedLikelihood) -> NoiseFloorSearch<'a> {
        NoiseFloorSearch {
            problem,
            criterion,
            tried: BTreeMap::new(),
            best: Vec::new(),
            most_terms: usize::MAX,
            form: None,
        }
    }

    /// Fits the supports that are new, two at a time, until the observer ends it; true if one became the best.
    pub fn fit(
        &mut self,
        points: impl IntoIterator<Item = LinearizationPoint>,
        observer: &mut dyn Observer,
    ) -> bool {
        let required = &self.problem.system.constraints.required;
        let mut points = points.into_iter().map(|p| p.requiring(required));
        let mut better = false;
        while observer.go_on() {
            let mut pair: Vec<LinearizationPoint> = Vec::new();
            while pair.len() < 2 {
                let Some(point) = points.next() else { break };
                let seen = pair.iter().any(|p| p.support == point.support);
                let size = 1..=self.most_terms.max(required.len());
                let fits = size.contains(&point.support.len());
                if fits && !seen && !self.tried.contains_key(&point.support) {
                    pair.push(point);
                }
            }
            let (problem, criterion) = (self.problem, &self.criterion);
            let beat = self.best.first().map_or(f64::INFINITY, |f| f.value);
            let one = |p: LinearizationPoint, observer: &mut dyn Observer| {
                (
                    p.support.clone(),
                    fit(problem, p, criterion, beat, observer),
                )
            };
            let (second, first) = (pair.pop(), pair.pop());
            let found = match (first, second) {
                (Some(a), Some(b)) => {
                    <[_; 2]>::from(join(observer, |go| one(a, go), |go| one(b, go))).into()
                }
                (None, Some(b)) => vec![one(b, observer)],
                _ => return better,
            };
            for (support, found) in found {
                better |= self.record(support, found);
            }
        }
        better
    }

    /// Records the result of a fit; true if it became the best.
    fn record(&mut self, support: Vec<usize>, found: Option<Fit>) -> bool {
        let value = found.as_ref().map_or(f64::INFINITY, |f| f.value);
        self.tried.insert(support, value);
        let Some(found) = found else { return false };
        self.best.retain(|f| f.support() != found.support());
        let before = self.best.first().map_or(f64::INFINITY, |f| f.value);
        let place = self.best.partition_point(|f| f.value <= found.value);
        self.best.insert(place, found);
        self.best.truncate(SEARCH.carried);
        value < before - SEARCH.min_gain
    }

    /// The best fit and the quadratic form about it, which is kept until another support is the best.
    fn best_and_form(&mut self, observer: &mut dyn Observer) -> Option<(Fit, Arc<QuadraticForm>)> {
        let best = self.best.first()?.clone();
        if let Some((support, form)) = &self.form
            && support == best.support()
        {
            return Some((best, form.clone()));
        }
        let form = self.problem.quadratic_form(&best.point, observer);
        let form = Arc::new(form.ok()?);
        self.form = Some((best.support().to_vec(), form.clone()));
        Some((best, form))
    }

    /// Noise of each sensor for a first linearisation: at least the floor, larger where only a share of the readings is informative.
    pub fn sigma(&self, at: &[f64]) -> Vec<f64> {
        at.iter()
            .zip(&self.criterion.floor)
            .zip(&self.problem.informative)
            .map(|((s, f), informative)| s.max(*f) / informative.sqrt())
            .collect()
    }

    fn may_refit(&self, observer: &mut dyn Observer) -> bool {
        let refitting = Stage::Refitting(self.tried.len());
        observer.hear(Activity::Stage(refitting)).is_continue()
    }

    /// First supports, from integral matching: best subsets of each law, at several prices of a term.
    pub fn propose_and_fit_initial(&mut self, observer: &mut dyn Observer) {
        let problem = self.problem;
        let sigma = self.sigma(&problem.noise);
        let [first, second] = SEARCH.initial_slacks;
        let (first, second) = join(
            observer,
            |observer| problem.integral_matching_form(&sigma, first, observer),
            |observer| problem.integral_matching_form(&sigma, second, observer),
        );
        for form in [first, second].into_iter().flatten() {
            let sizes: Vec<Vec<Subset>> = (problem.ranges.iter())
                .map(|r| best_subsets(&form, &[], r.clone(), SEARCH.max_beam_terms))
                .collect();
            let all: Vec<usize> = (0..form.p).collect();
            let least = form.least_squares(&all).square.max(0.0);
            let scale = (least / problem.measurements() as f64).max(1.0);
            let mut point = |strength: f64| {
                let penalty = self.criterion.penalty * strength * scale;
                let cost = |s: &&Subset| s.square + penalty * s.columns.len() as f64;
                let best = sizes
                    .iter()
                    .filter_map(|all| all.iter().min_by(|a, b| cost(a).total_cmp(&cost(b))));
                let mut support: Vec<usize> =
                    best.flat_map(|s| s.columns.iter().copied()).collect();
                support.sort_unstable();
                let support = problem.run_columns.whole(support, &[]);
                let price = strength * scale;
                let support = self.obeying(&form, support, price, observer);
                at_minimum(problem, &form, &problem.initial_point(&sigma), support)
            };
            let points = SEARCH.initial_prices.map(&mut point);
            self.fit(points, observer);
            let Some((best, form)) = self.best_and_form(observer) else {
                continue;
            };
            if let Some(support) = form
                .backward_elimination(&[self.criterion.penalty])
                .into_iter()
                .next()
            {
                let support = form.steepest_descent(&support, self.criterion.penalty);
                let support = problem.run_columns.whole(support, best.support());
                let support = self.obeying(&form, support, 1.0, observer);
                let point = at_minimum(problem, &form, &best.point, support);
                self.fit([point], observer);
            }
        }
    }

    /// Fits the supports that the quadratic form proposes and repeats this about each better one, until there is none. On the `last`
    /// level rivals are fitted too; with `prune` also the support without each of its terms, where that is predicted to cost little.
    pub fn improve(&mut self, (last, prune): (bool, bool), observer: &mut dyn Observer) {
        let mut fits = 0;
        while fits < SEARCH.max_fits && self.may_refit(observer) {
            let Some((current, form)) = self.best_and_form(observer) else {
                return;
            };
            let problem = self.problem;
            let point = |support| at_minimum(problem, &form, &current.point, support);
            let proposals = self.proposals(&form, current.support(), observer);
            let near = proposals
                .iter()
                .take_while(|(change, _)| *change <= SEARCH.max_predicted_loss);
            let near: Vec<Vec<usize>> = near.map(|(_, s)| s.clone()).collect();
            let mut better = false;
            for pair in near[..near.len().min(SEARCH.max_fits - fits)].chunks(2) {
                fits += pair.len();
                better = self.fit(pair.iter().cloned().map(point), observer);
                if better {
                    break;
                }
                if !self.may_refit(observer) {
                    return;
                }
            }
            if !better && last {
                let new = |s: &Vec<usize>| !self.tried.contains_key(s);
                let rivals = proposals.into_iter().filter(|(_, s)| new(s));
                let near = rivals.take_while(|(change, _)| *change < SEARCH.rival_loss);
                let near: Vec<Vec<usize>> = near.take(SEARCH.max_rivals).map(|(_, s)| s).collect();
                better = self.fit(near.into_iter().map(point), observer);
            }
            let support = current.support();
            if !better && last && prune && support.len() <= SEARCH.max_pruned_terms {
                let whole = form.least_squares(support).square;
                let light =
                    |s: &Vec<usize>| form.least_squares(s).square - whole <= SEARCH.max_pruned_loss;
                let shorter = support.iter().map(|j| self.without(support, *j));
                let shorter: Vec<Vec<usize>> = shorter.filter(light).collect();
                let mut repaired = |s: Vec<usize>| self.obeying(&form, s, 0.0, observer);
                let all = shorter.into_iter().map(|s| point(repaired(s)));
                let all: Vec<LinearizationPoint> = all.collect();
                // From its first start, far from where the search has come, a support may not have got to its best.
                let gain = |p: &LinearizationPoint| {
                    let fewer = support.len().saturating_sub(p.support.len()) as f64;
                    self.criterion.penalty * fewer + whole - form.least_squares(&p.support).square
                };
                let promising = all.iter().filter(|p| gain(p) >= SEARCH.min_gain);
                for point in promising {
                    self.tried.remove(&point.support);
                }
                better = self.fit(all, observer);
            }
            if !better {
                return;
            }
        }
    }

    /// A support without a column, and without the columns of the same term in other runs.
    fn without(&self, support: &[usize], column: usize) -> Vec<usize> {
        let group = self.problem.run_columns.group_of(column);
        let group = group.unwrap_or_else(|| vec![column]);
        support
            .iter()
            .copied()
            .filter(|j| !group.contains(j))
            .collect()
    }

    /// As [`NoiseFloorSearch::improve`], but fits only supports that are predicted to be better, and only a few.
    pub fn improve_briefly(&mut self, observer: &mut dyn Observer) {
        let last = self.tried.len() + SEARCH.fits_beyond;
        while self.tried.len() < last && self.may_refit(observer) {
            let Some((current, form)) = self.best_and_form(observer) else {
                return;
            };
            let proposals = self.proposals(&form, current.support(), observer);
            let large = proposals
                .into_iter()
                .take_while(|(c, _)| *c <= -SEARCH.min_gain);
            let room = last - self.tried.len();
            let problem = self.problem;
            let point = |(_, s)| at_minimum(problem, &form, &current.point, s);
            let mut better = false;
            for next in large.take(room).map(point) {
                better = self.fit([next], observer);
                if better || !self.may_refit(observer) {
                    break;
                }
            }
            if !better {
                return;
            }
        }
    }

    /// For each price of a term the best end of three descents: from backward elimination, from the strongest column, and from
    /// `support`.
    fn descents(
        &self,
        form: &QuadraticForm,
        support: &[usize],
        prices: &[f64],
        observer: &mut dyn Observer,
    ) -> Vec<(Vec<usize>, f64)> {
        let along = |j: &usize| form.right[*j].abs();
        let strongest = (0..form.p).max_by(|i, j| along(i).total_cmp(&along(j)));
        let backward = form.backward_elimination(prices);
        let tasks: Vec<(Vec<usize>, f64)> =
            (backward.into_iter().zip(prices.iter().copied())).collect();
        let descend = |(backward, price): &(Vec<usize>, f64)| {
            let starts = [
                backward,
                &strongest.into_iter().collect(),
                &support.to_vec(),
            ];
            let starts = starts.into_iter().filter(|s| s.len() <= self.most_terms);
            let ends = starts.map(|s| form.steepest_descent(s, *price));
            let cost = |s: &Vec<usize>| form.least_squares(s).square + price * s.len() as f64;
            let best = ends.min_by(|a, b| cost(a).total_cmp(&cost(b)));
            best.map(|best| (best, *price))
        };
        let ends = each(observer, &tasks, descend);
        ends.into_iter().flatten().collect()
    }

    /// A proposed support made to satisfy the constraints. `price`, in units of the price of a term: above zero, a descent under the
    /// constraints follows. Unchanged where there are no constraints.
    fn obeying(
        &self,
        form: &QuadraticForm,
        support: Vec<usize>,
        price: f64,
        observer: &mut dyn Observer,
    ) -> Vec<usize> {
        let (constraints, laws) = (&self.problem.system.constraints, &self.problem.ranges);
        if constraints.is_empty() {
            return support;
        }
        let mut search = ConstrainedForm::new(form, constraints, laws);
        let price = price * self.criterion.penalty;
        let found = search.repaired(&support, price);
        let found = found.map(|s| match price > 0.0 {
            true => search.descend(s, price, observer),
            false => s,
        });
        found.map_or(support, |s| s.columns)
    }

    /// The given supports, made to satisfy the constraints, and others met in a search under them.
    fn constrained_proposals(
        &self,
        form: &QuadraticForm,
        support: &[usize],
        proposed: Vec<Vec<usize>>,
        observer: &mut dyn Observer,
    ) -> Vec<(f64, Vec<usize>)> {
        let (constraints, laws) = (&self.problem.system.constraints, &self.problem.ranges);
        let search = ConstrainedForm::new(form, constraints, laws);
        let price = self.criterion.penalty;
        let mut all = search.proposals(support, proposed, price, observer);
        all.retain(|(_, s)| !self.tried.contains_key(s));
        all
    }

    /// Supports not fitted yet with their predicted change of the criterion, best first.
    fn proposals(
        &self,
        form: &QuadraticForm,
        support: &[usize],
        observer: &mut dyn Observer,
    ) -> Vec<(f64, Vec<usize>)> {
        let penalty = self.criterion.penalty;
        let value = |s: &[usize]| form.least_squares(s).square + penalty * s.len() as f64;
        let base = value(support);
        let mut all: BTreeMap<Vec<usize>, f64> = BTreeMap::new();
        let runs = &self.problem.run_columns;
        let mut propose = |s: Vec<usize>, change: f64| {
            let whole = runs.whole(s.clone(), support);
            let change = if whole == s {
                change
            } else {
                value(&whole) - base
            };
            let s = whole;
            if !s.is_empty() && !self.tried.contains_key(&s) {
                let known = all.entry(s).or_insert(change);
                *known = known.min(change);
            }
        };
        let strengths = SEARCH.prices.map(|s| s * penalty);
        for (best, strength) in self.descents(form, support, &strengths, observer) {
            let change = value(&best) - base;
            // Sparse supports are fitted whatever the quadratic form predicts.
            let change = if strength > SEARCH.sparse_price * penalty {
                change.min(0.0)
            } else {
                change
            };
            propose(best, change);
        }
        let mut combined = support.to_vec();
        let searched = self.problem.ranges.iter().filter(|r| !r.is_empty());
        let ranges: Vec<Range<usize>> = searched.cloned().collect();
        let subsets = each(observer, &ranges, |range| {
            best_subsets(form, support, range.clone(), SEARCH.max_beam_terms)
        });
        for (range, mut best) in ranges.iter().zip(subsets) {
            let others: Vec<usize> = support
                .iter()
                .copied()
                .filter(|j| !range.contains(j))
                .collect();
            let cost = |s: &Subset| s.square + penalty * s.columns.len() as f64;
            best.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
            for s in best.iter().take(SEARCH.subsets_proposed) {
                let change = cost(s) + penalty * others.len() as f64 - base;
                propose(union(&others, &s.columns), change);
            }
            if let Some(s) = best.first() {
                combined.retain(|j| !range.contains(j));
                combined = union(&combined, &s.columns);
            }
        }
        let change = value(&combined) - base;
        propose(combined, change);
        for j in support.iter().filter(|j| runs.get(**j).is_some()) {
            let rest = self.without(support, *j);
            let change = value(&rest) - base;
            propose(rest, change);
        }
        for m in form.single_changes(support, penalty, SEARCH.moves_proposed) {
            propose(m.applied(support), m.change);
        }
        if !self.problem.system.constraints.is_empty() {
            return self.constrained_proposals(form, support, all.into_keys().collect(), observer);
        }
        let mut all: Vec<(f64, Vec<usize>)> = all.into_iter().map(|(s, c)| (c, s)).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)));
        all
    }
}

/// The point with a support at the minimum of its quadratic form under the constraints. A support that cannot obey them has no
/// fit, wherever it starts.
pub(super) fn at_minimum(
    problem: &Problem,
    form: &QuadraticForm,
    from: &LinearizationPoint,
    support: Vec<usize>,
) -> LinearizationPoint {
    let constrained = minimum(form, &problem.system.constraints, &support);
    let coefficients = match constrained {
        Some((coefficients, _)) => coefficients,
        None => form.least_squares(&support).coefficients,
    };
    LinearizationPoint {
        support,
        coefficients,
        ..from.clone()
    }
}

fn union(a: &[usize], b: &[usize]) -> Vec<usize> {
    let mut all: Vec<usize> = a.iter().chain(b).copied().collect();
    all.sort_unstable();
    all
}
