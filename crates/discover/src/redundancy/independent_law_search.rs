//! For an equation that repeats others, the best support whose relation is independent of theirs.
//!
//! In: the equation, its task, a test of independence. Out: the independent equation and its price. Supports are visited in order
//! of the criterion (Lawler 1972): an independent support lacks at least one term of each dependent one, so its terms are forbidden one
//! at a time. Never replaces the equation itself.

use crate::redundancy::thresholds::INDEPENDENT_LAW;
use crate::selection::thresholds::TERM_SELECTION;
use std::collections::BTreeSet;

use crate::regression::design::Design;
use crate::regression::task::Task;
use crate::selection::best_subset::BestSubsetSearch;
use crate::selection::information_criterion::InformationCriterion;
use crate::selection::term_selection::{self, TermSelection};
use crate::statistics::{autocorrelation_time, norm};
use sidc_lang::term::{Signal, Term};
use sidc_progress::EquationObserver;
use sidc_progress::Stage;
use sidc_solve as solve;
use sidc_system::discovery::{Discovery, Equation};

/// What a new fit of an equation needs.
pub(crate) struct Refit<'a, 'w, 't> {
    /// Tasks of the equations without constraints.
    pub tasks: Vec<Task<'t>>,
    pub watcher: &'a mut EquationObserver<'w>,
}

/// An equation that is independent of the others.
pub(super) struct IndependentLaw {
    pub equation: Equation,
    /// Relative residual.
    pub residual: f64,
    /// Factor by which the residual grows when the system is solved for its targets.
    pub growth: f64,
    /// Criterion of this law minus that of the equation that it replaces.
    pub loss: f64,
    /// The part of `loss` that comes from the fit. The rest comes from more terms, which an independent law may need.
    pub worse: f64,
    /// `loss` for each independent row, with the growth of the residual.
    pub price: f64,
}

impl IndependentLaw {
    /// Whether it may replace a copy whose relative residual is `before`.
    pub fn bearable(&self, before: f64) -> bool {
        let little =
            self.worse <= TERM_SELECTION.tie || self.residual <= INDEPENDENT_LAW.bearable * before;
        // For an exact law the residual that grows is rounding only.
        let exact = self.residual * self.growth <= INDEPENDENT_LAW.exact;
        (exact || self.growth <= INDEPENDENT_LAW.growth) && little
    }
}

/// A test of independence: from all terms of an equation and its relative residual, the factor by which the residual grows when the
/// system is solved; `None` if the equation is not independent of the others.
pub(super) type IndependenceTest<'a> = &'a dyn Fn(&[(f64, &Term)], f64) -> Option<f64>;

/// The best independent law of the target of `equation`; `None` if it has no task, there is no such law, or the work is stopped.
pub(super) fn find_independent_law(
    refit: &mut Refit,
    names: &Discovery,
    equation: &Equation,
    independent: IndependenceTest,
) -> Option<IndependentLaw> {
    let task = refit.tasks.iter().find(|t| t.target == equation.target)?;
    let mut design = task.design_about(names, equation, refit.watcher)?;
    let gradings = task.gradings(&design);
    let mut selected = task.select(&mut design, &gradings, refit.watcher);
    if refit.watcher.stop().is_some() {
        return None;
    }
    let mut search = IndependentLawSearch {
        task,
        design: &design,
        criterion: selected.criterion,
        independent,
    };
    let others: Vec<Signal> = (names.equations.iter().map(|e| e.target))
        .filter(|s| *s != equation.target)
        .collect();
    let pool = search.pool(&selected.proposal.solution.coefficients);
    let found = search.best(&pool, &others, refit.watcher)?;
    let criterion = search.criterion;
    let polished = solve::refit(design.phi.as_ref(), &design.target, &found.columns);
    let columns = equation.terms.iter().filter(|t| !t.fixed);
    let columns: Option<Vec<usize>> = columns.map(|t| task.library.contains(&t.term)).collect();
    let before = solve::refit(design.phi.as_ref(), &design.target, &columns?);
    let value = |p: &solve::Refit| criterion.value(p.residual.powi(2), p.coefficients.len());
    let loss = value(&polished) - value(&before);
    let fit = |p: &solve::Refit| criterion.value(p.residual.powi(2), 0);
    let worse = fit(&polished) - fit(&before);
    selected.selection = TermSelection {
        support: found.columns,
        value: found.value,
        ties: Vec::new(),
        searched: pool.len(),
        as_proposed: false,
        cut: false,
    };
    selected.polished = polished;
    let answer = task.estimate(&design, &selected);
    let equation = task.conclude(names, &design, &answer);
    let residual = equation.evidence.as_ref()?.residual;
    Some(IndependentLaw {
        equation,
        residual,
        growth: found.growth,
        loss,
        worse,
        price: loss / criterion.samples + 2.0 * found.growth.ln(),
    })
}

struct IndependentLawSearch<'a, 't> {
    task: &'a Task<'t>,
    design: &'a Design,
    criterion: InformationCriterion,
    independent: IndependenceTest<'a>,
}

/// A node of the search tree: forbidden places of the pool, and the best support without them.
struct Node {
    value: f64,
    forbidden: BTreeSet<usize>,
    support: Vec<usize>,
}

/// The best support so far.
struct Found {
    columns: Vec<usize>,
    growth: f64,
    /// The criterion of the residual after the system is solved for its targets: before that, a law that contains part of another
    /// has a small residual.
    value: f64,
}

impl IndependentLawSearch<'_, '_> {
    /// Columns that take part, rising: all, or proposals of the solver and the simplest terms.
    fn pool(&self, proposed: &[(usize, f64)]) -> Vec<usize> {
        let phi = self.design.phi.as_ref();
        let mut pool =
            term_selection::candidate_pool(phi, &term_selection::proposed_columns(phi, proposed));
        if phi.cols() > TERM_SELECTION.exhaustive_columns
            && self.task.library.len() <= INDEPENDENT_LAW.listed_terms
        {
            pool.extend(self.task.library.by_degree());
            let mut seen = BTreeSet::new();
            pool.retain(|j| seen.insert(*j));
            pool.truncate(TERM_SELECTION.exhaustive_columns);
        }
        pool.extend_from_slice(self.task.library.required());
        pool.sort_unstable();
        pool.dedup();
        pool
    }

    fn search(&self, pool: &[usize]) -> BestSubsetSearch {
        let phi = self.design.phi.as_ref();
        let asked = (self.criterion, self.task.library.required());
        term_selection::best_subset_search(phi, &self.design.target, pool, asked)
    }

    /// The best independent support.
    fn best(
        &mut self,
        pool: &[usize],
        others: &[Signal],
        watcher: &mut EquationObserver,
    ) -> Option<Found> {
        // A law without the targets of other equations is surely independent of them; its criterion bounds the search.
        let mentions = |j: &usize| {
            let term = self.task.term(*j);
            others.iter().any(|s| term.mentions(*s))
        };
        let places = pool.iter().enumerate();
        let required = self.task.library.required();
        let joint: BTreeSet<usize> = places
            .filter(|(_, j)| mentions(j) && !required.contains(j))
            .map(|(i, _)| i)
            .collect();
        let mut best = None;
        if let Some(first) = self.node(&self.search(pool), joint.clone(), watcher) {
            // Without these targets the residual is mostly unexplained motion, which is autocorrelated, so the effective sample size
            // falls.
            self.lower_sample_size(&named(pool, &first.support));
            let explicit = self.node(&self.search(pool), joint, watcher);
            best = explicit.and_then(|n| self.independent_support(pool, &n));
        }
        let search = self.search(pool);
        let mut nodes: Vec<Node> = Vec::new();
        nodes.extend(self.node(&search, BTreeSet::new(), watcher));
        let mut seen: BTreeSet<BTreeSet<usize>> = BTreeSet::new();
        let most = (INDEPENDENT_LAW.work / pool.len().max(1))
            .clamp(INDEPENDENT_LAW.min_supports, INDEPENDENT_LAW.max_supports);
        for _ in 0..most {
            nodes.sort_by(|a, b| b.value.total_cmp(&a.value));
            let Some(node) = nodes.pop() else { break };
            if watcher.stop().is_some() {
                break;
            }
            if best.as_ref().is_some_and(|b| b.value <= node.value) {
                break;
            }
            let found = self.independent_support(pool, &node);
            if let Some(found) = found.filter(|f| best.as_ref().is_none_or(|b| f.value < b.value)) {
                best = Some(found);
            }
            let free = node.support.iter();
            for place in free.filter(|i| !required.contains(&pool[**i])) {
                let mut forbidden = node.forbidden.clone();
                forbidden.insert(*place);
                if seen.insert(forbidden.clone()) {
                    nodes.extend(self.node(&search, forbidden, watcher));
                }
            }
        }
        best
    }

    /// The best support without the forbidden places; `None` if there is none, or the work is to stop.
    fn node(
        &self,
        search: &BestSubsetSearch,
        forbidden: BTreeSet<usize>,
        watcher: &mut EquationObserver,
    ) -> Option<Node> {
        if watcher.at(Stage::Choosing).is_some() {
            return None;
        }
        let most = TERM_SELECTION
            .max_terms
            .min(self.design.target.len().saturating_sub(1))
            .max(1);
        let without = search.without(&forbidden);
        let found = without.run(most, &[], watcher.during(Stage::Choosing));
        let first = found.into_iter().find(|s| !s.support.is_empty())?;
        Some(Node {
            value: first.value,
            forbidden,
            support: first.support,
        })
    }

    /// The support of a node, if it is independent.
    fn independent_support(&self, pool: &[usize], node: &Node) -> Option<Found> {
        let columns = named(pool, &node.support);
        let polished = solve::refit(self.design.phi.as_ref(), &self.design.target, &columns);
        let terms: Vec<Term> = columns.iter().map(|j| self.task.term(*j)).collect();
        let pairs = polished.coefficients.iter().copied().zip(&terms);
        let known = self.task.known.iter().map(|(a, t)| (*a, t));
        let all: Vec<(f64, &Term)> = known.chain(pairs).collect();
        let left = polished.residual / norm(&self.design.target);
        let growth = (self.independent)(&all, left)?.max(1.0);
        let square = (polished.residual * growth).powi(2);
        Some(Found {
            value: self.criterion.value(square, columns.len()),
            columns,
            growth,
        })
    }

    /// Lowers the effective sample size of the criterion by the autocorrelation of the residual of a law.
    fn lower_sample_size(&mut self, columns: &[usize]) {
        let polished = solve::refit(self.design.phi.as_ref(), &self.design.target, columns);
        let pairs: Vec<(usize, f64)> = (columns.iter().copied())
            .zip(polished.coefficients)
            .collect();
        let left = self.design.problem().residual(&pairs);
        let correlation =
            autocorrelation_time(&left).max(self.criterion.rows / self.criterion.samples);
        let rows = self.design.target.len();
        let candidates = self.task.library.len();
        self.criterion =
            InformationCriterion::new(rows, correlation, candidates, self.criterion.floor);
    }
}

fn named(pool: &[usize], places: &[usize]) -> Vec<usize> {
    let columns = places.iter().filter_map(|i| pool.get(*i));
    columns.copied().collect()
}
