//! A law of its own for an equation that repeats others: the best support whose relation is independent of theirs.
//!
//! In: the equation, the task that it came from, and a test of independence. Out: the equation instead, and what it costs. The
//! best supports are gone through in order of the criterion by forbidding the terms of those that are dependent, one at a time
//! (Lawler 1972): whatever is independent lacks at least one of them.

use std::collections::BTreeSet;

use super::Again;
use crate::discover::equation::Task;
use crate::discover::pools::simplest;
use crate::discover::prepared::Prepared;
use crate::discover::subset::{Criterion, Search};
use crate::discover::support::{self, Choice, MOST_TERMS, SEARCHABLE};
use crate::discover::watch::{Stage, Watcher};
use crate::discover::weights::{correlation_time, norm};
use crate::discover::{Discovery, Equation};
use crate::solve::{self, Polished};
use crate::term::{Signal, Term};

/// Supports times columns that are gone through: a second of work at most.
const WORK: usize = 4000;
/// Fewest and most supports.
const SUPPORTS: (usize, usize) = (8, 60);
/// Terms of a library of which the simplest are still looked up.
const LISTED: usize = 100_000;

/// An equation that says what the others do not.
pub(super) struct Own {
    pub equation: Equation,
    /// Relative residual.
    pub residual: f64,
    /// The factor by which it grows where the system is solved for its targets.
    pub grown: f64,
    /// What the criterion loses.
    pub loss: f64,
    /// The part of it that is the fit's: more terms are no fault of a law that has to be another.
    pub worse: f64,
    /// The same for each independent row, growth included.
    pub price: f64,
}

/// By what factor the residual of terms, known ones included, that leave this part of the target grows where the system is
/// solved; `None` if they make no independent relation.
pub(super) type Test<'a> = &'a dyn Fn(&[(f64, &Term)], f64) -> Option<f64>;

/// The best independent law of `equation`'s target; `None` if it is not to be sought again, or there is none.
pub(super) fn seek(
    again: &mut Again,
    names: &Discovery,
    equation: &Equation,
    independent: Test,
) -> Option<Own> {
    let task = again.tasks.iter().find(|t| t.target == equation.target)?;
    let mut prepared = task.as_found(names, equation, again.watcher)?;
    let mut proposed = task.propose(&mut prepared, again.watcher);
    if again.watcher.stop().is_some() {
        return None;
    }
    let mut seeker = Seeker {
        task,
        prepared: &prepared,
        criterion: proposed.criterion,
        independent,
    };
    let others: Vec<Signal> = (names.equations.iter().map(|e| e.target))
        .filter(|s| *s != equation.target)
        .collect();
    let pool = seeker.pool(&proposed.solution.coefficients);
    let found = seeker.best(&pool, &others, again.watcher)?;
    let criterion = seeker.criterion;
    let polished = solve::polish(prepared.phi.as_ref(), &prepared.aim, &found.columns);
    let columns = equation.terms.iter().filter(|t| !t.fixed);
    let columns: Option<Vec<usize>> = columns.map(|t| task.library.contains(&t.term)).collect();
    let before = solve::polish(prepared.phi.as_ref(), &prepared.aim, &columns?);
    let value = |p: &Polished| criterion.value(p.residual.powi(2), p.coefficients.len());
    let loss = value(&polished) - value(&before);
    let fit = |p: &Polished| criterion.value(p.residual.powi(2), 0);
    let worse = fit(&polished) - fit(&before);
    proposed.choice = Choice {
        support: found.columns,
        ties: Vec::new(),
        searched: pool.len(),
        as_proposed: false,
        cut: false,
    };
    proposed.polished = polished;
    let answer = task.answer(&prepared, &proposed);
    let equation = task.conclude(names, &prepared, &answer);
    let residual = equation.evidence.as_ref()?.residual;
    Some(Own {
        equation,
        residual,
        grown: found.grown,
        loss,
        worse,
        price: loss / criterion.samples + 2.0 * found.grown.ln(),
    })
}

struct Seeker<'a, 't> {
    task: &'a Task<'t>,
    prepared: &'a Prepared,
    criterion: Criterion,
    independent: Test<'a>,
}

/// Places of the pool that are forbidden, and the best support without them.
struct Node {
    value: f64,
    forbidden: BTreeSet<usize>,
    support: Vec<usize>,
}

/// The best support so far.
struct Found {
    columns: Vec<usize>,
    grown: f64,
    /// The criterion, of the residual as it is where the system is solved: a law of which a part is another's seems to leave little.
    value: f64,
}

impl Seeker<'_, '_> {
    /// Columns that take part, rising: all, or what the solver proposes and the simplest.
    fn pool(&self, proposed: &[(usize, f64)]) -> Vec<usize> {
        let phi = self.prepared.phi.as_ref();
        let mut pool = support::pool(phi, &support::proposals(phi, proposed));
        if phi.cols() > SEARCHABLE && self.task.library.len() <= LISTED {
            pool.extend(simplest(self.task.library));
            let mut seen = BTreeSet::new();
            pool.retain(|j| seen.insert(*j));
            pool.truncate(SEARCHABLE);
            pool.sort_unstable();
        }
        pool
    }

    fn search(&self, pool: &[usize]) -> Search {
        let phi = self.prepared.phi.as_ref();
        support::search(phi, &self.prepared.aim, pool, self.criterion)
    }

    /// The best independent support.
    fn best(&mut self, pool: &[usize], others: &[Signal], watcher: &mut Watcher) -> Option<Found> {
        // Without the others' targets a law cannot be theirs: a bound for the rest.
        let mentions = |j: &usize| {
            let term = self.task.term(*j);
            others.iter().any(|s| term.mentions(*s))
        };
        let places = pool.iter().enumerate();
        let joint: BTreeSet<usize> = places
            .filter(|(_, j)| mentions(j))
            .map(|(i, _)| i)
            .collect();
        let mut best = None;
        if let Some(first) = self.node(&self.search(pool), joint.clone(), watcher) {
            // What such a law leaves is no noise, but motion that repeats itself.
            self.seen(&named(pool, &first.support));
            let explicit = self.node(&self.search(pool), joint, watcher);
            best = explicit.and_then(|n| self.found(pool, &n));
        }
        let search = self.search(pool);
        let mut open: Vec<Node> = Vec::new();
        open.extend(self.node(&search, BTreeSet::new(), watcher));
        let mut seen: BTreeSet<BTreeSet<usize>> = BTreeSet::new();
        let most = (WORK / pool.len().max(1)).clamp(SUPPORTS.0, SUPPORTS.1);
        for _ in 0..most {
            open.sort_by(|a, b| b.value.total_cmp(&a.value));
            let Some(node) = open.pop() else { break };
            if watcher.stop().is_some() {
                break;
            }
            if best.as_ref().is_some_and(|b| b.value <= node.value) {
                break;
            }
            let found = self.found(pool, &node);
            if let Some(found) = found.filter(|f| best.as_ref().is_none_or(|b| f.value < b.value)) {
                best = Some(found);
            }
            for place in &node.support {
                let mut forbidden = node.forbidden.clone();
                forbidden.insert(*place);
                if seen.insert(forbidden.clone()) {
                    open.extend(self.node(&search, forbidden, watcher));
                }
            }
        }
        best
    }

    /// `None` where nothing is left to choose from, or the work is to stop.
    fn node(
        &self,
        search: &Search,
        forbidden: BTreeSet<usize>,
        watcher: &mut Watcher,
    ) -> Option<Node> {
        if watcher.at(Stage::Choosing).is_some() {
            return None;
        }
        let most = MOST_TERMS
            .min(self.prepared.aim.len().saturating_sub(1))
            .max(1);
        let without = search.without(&forbidden);
        let found = without.run(most, &[], &mut || watcher.at(Stage::Choosing).is_none());
        let first = found.into_iter().find(|s| !s.support.is_empty())?;
        Some(Node {
            value: first.value,
            forbidden,
            support: first.support,
        })
    }

    /// The support of a node, if it is independent.
    fn found(&self, pool: &[usize], node: &Node) -> Option<Found> {
        let columns = named(pool, &node.support);
        let polished = solve::polish(self.prepared.phi.as_ref(), &self.prepared.aim, &columns);
        let terms: Vec<Term> = columns.iter().map(|j| self.task.term(*j)).collect();
        let pairs = polished.coefficients.iter().copied().zip(&terms);
        let known = self.task.known.iter().map(|(a, t)| (*a, t));
        let all: Vec<(f64, &Term)> = known.chain(pairs).collect();
        let left = polished.residual / norm(&self.prepared.aim);
        let grown = (self.independent)(&all, left)?.max(1.0);
        let square = (polished.residual * grown).powi(2);
        Some(Found {
            value: self.criterion.value(square, columns.len()),
            columns,
            grown,
        })
    }

    /// Counts rows that follow each other as one, by what a law leaves of them.
    fn seen(&mut self, columns: &[usize]) {
        let polished = solve::polish(self.prepared.phi.as_ref(), &self.prepared.aim, columns);
        let pairs: Vec<(usize, f64)> = (columns.iter().copied())
            .zip(polished.coefficients)
            .collect();
        let left = self.prepared.problem().left(&pairs);
        let correlation = correlation_time(&left).max(self.criterion.rows / self.criterion.samples);
        let rows = self.prepared.aim.len();
        let candidates = self.task.library.len();
        self.criterion = Criterion::new(rows, correlation, candidates, self.criterion.floor);
    }
}

fn named(pool: &[usize], places: &[usize]) -> Vec<usize> {
    let columns = places.iter().filter_map(|i| pool.get(*i));
    columns.copied().collect()
}
