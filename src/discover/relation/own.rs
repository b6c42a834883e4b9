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
use crate::discover::{Discovery, Equation};
use crate::solve;
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
    /// What the criterion loses.
    pub loss: f64,
    /// The same for each independent row.
    pub price: f64,
}

/// Whether terms, known ones included, that leave this part of the target make an independent relation.
pub(super) type Test<'a> = &'a dyn Fn(&[(f64, &Term)], f64) -> bool;

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
    let seeker = Seeker {
        task,
        prepared: &prepared,
        criterion: proposed.criterion,
        independent,
    };
    let coupled: Vec<Signal> = (names.equations.iter().map(|e| e.target))
        .filter(|s| *s != equation.target)
        .collect();
    let pool = seeker.pool(&proposed.solution.coefficients);
    let found = seeker.best(&pool, &coupled, again.watcher)?;
    let polished = solve::polish(prepared.phi.as_ref(), &prepared.aim, &found);
    let columns = equation.terms.iter().filter(|t| !t.fixed);
    let columns: Option<Vec<usize>> = columns.map(|t| task.library.contains(&t.term)).collect();
    let before = solve::polish(prepared.phi.as_ref(), &prepared.aim, &columns?);
    let value = |p: &solve::Polished, terms| proposed.criterion.value(p.residual.powi(2), terms);
    let loss = value(&polished, found.len()) - value(&before, before.coefficients.len());
    let samples = proposed.criterion.samples;
    proposed.choice = Choice {
        support: found,
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
        loss,
        price: loss / samples,
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

    /// Columns of the best independent support.
    fn best(&self, pool: &[usize], others: &[Signal], watcher: &mut Watcher) -> Option<Vec<usize>> {
        let phi = self.prepared.phi.as_ref();
        let search = support::search(phi, &self.prepared.aim, pool, self.criterion);
        let named = |s: &[usize]| -> Vec<usize> {
            s.iter().filter_map(|i| pool.get(*i).copied()).collect()
        };
        // Without the others' targets a law cannot be theirs: a bound for the rest.
        let mentions = |j: &usize| {
            let term = self.task.term(*j);
            others.iter().any(|s| term.mentions(*s))
        };
        let places = pool.iter().enumerate();
        let joint = places.filter(|(_, j)| mentions(j)).map(|(i, _)| i).collect();
        let explicit = self.node(&search, joint, watcher);
        let mut best = explicit.filter(|n| self.passes(&named(&n.support)));
        let mut open: Vec<Node> = Vec::new();
        open.extend(self.node(&search, BTreeSet::new(), watcher));
        let mut seen: BTreeSet<BTreeSet<usize>> = BTreeSet::new();
        let most = (WORK / pool.len().max(1)).clamp(SUPPORTS.0, SUPPORTS.1);
        for _ in 0..most {
            open.sort_by(|a, b| b.value.total_cmp(&a.value));
            let Some(node) = open.pop() else { break };
            if best.as_ref().is_some_and(|b| b.value <= node.value) {
                break;
            }
            if self.passes(&named(&node.support)) {
                best = Some(node);
                break;
            }
            for place in &node.support {
                let mut forbidden = node.forbidden.clone();
                forbidden.insert(*place);
                if seen.insert(forbidden.clone()) {
                    open.extend(self.node(&search, forbidden, watcher));
                }
            }
        }
        best.map(|n| named(&n.support))
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
        let most = MOST_TERMS.min(self.prepared.aim.len().saturating_sub(1)).max(1);
        let without = search.without(&forbidden);
        let found = without.run(most, &[], &mut || watcher.at(Stage::Choosing).is_none());
        let first = found.into_iter().find(|s| !s.support.is_empty())?;
        Some(Node {
            value: first.value,
            forbidden,
            support: first.support,
        })
    }

    fn passes(&self, columns: &[usize]) -> bool {
        let polished = solve::polish(self.prepared.phi.as_ref(), &self.prepared.aim, columns);
        let terms: Vec<Term> = columns.iter().map(|j| self.task.term(*j)).collect();
        let found = polished.coefficients.iter().copied().zip(&terms);
        let known = self.task.known.iter().map(|(a, t)| (*a, t));
        let all: Vec<(f64, &Term)> = known.chain(found).collect();
        let size = crate::discover::weights::norm(&self.prepared.aim);
        (self.independent)(&all, polished.residual / size)
    }
}
