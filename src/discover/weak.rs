//! One equation by its weak form: guess, weigh the rows by the guess, guess again; the most likely guess is concluded.
//!
//! In: a task. Out: the same as from regression: rows, Φ, and what errors allow. What noise does to the library is known only as
//! soon as the equation is, nearly: so a few rounds are run from cautious beginnings, and judged by their likelihood.

use super::equation::Task;
use super::prepared::{Basis, Prepared};
use super::subset::Criterion;
use super::support;
use super::watch::{Stage, Watcher};
use super::weights::{Weights, rms};
use super::{Discovery, Equation, Failed, Method, Unevaluable};
use crate::data::Samples;
use crate::dictionary::{BadValue, Dictionary};
use crate::solve::{self, Problem};
use crate::term::Term;
use crate::weak::{Asked, Weak, Whitened};

/// Most entries of Φ; there are some copies of it.
const ENTRIES: usize = 8_000_000;
/// Bytes for each entry, with all copies.
const BYTES: u64 = 64;
/// Cautious beginnings: the noise of a record that each step of the equation may be wrong by.
const SLACKS: [f64; 2] = [0.3, 0.03];
/// The same where there is a guess.
const SLACK: f64 = 0.01;
/// Times that the equations hand each other their motion.
const PASSES: usize = 3;
/// Mean squared residual, in units of its error, up to which an equation's motion is worth handing on.
const TRUSTED: f64 = 1.5;
/// Rounds from each beginning.
const ROUNDS: usize = 4;
/// Rows are known to have errors of size one, to a factor.
const KNOWN: f64 = 0.3;

/// Terms dearer than their due find what is large first: a guess with terms too many misleads more than one with too few.
const DEAR: [f64; 3] = [1.0, 4.0, 16.0];

/// Terms of one round.
#[derive(Clone)]
struct Found {
    support: Vec<usize>,
    pairs: Vec<(usize, f64)>,
    /// Squared residual.
    left: f64,
    /// Squared residual, and the cost of the terms.
    value: f64,
}

/// One guess, and how well it does.
struct Round {
    /// With the motion that goes with the guess.
    own: Weak,
    whitened: Whitened,
    found: Found,
    /// Mean square of the whitened residual: 1 for noise alone.
    left: f64,
}

/// Equations that are found from their integrals, in order of the model, each with its place there.
pub(super) struct Together<'a> {
    members: Vec<Member<'a>>,
}

struct Member<'a> {
    place: usize,
    task: Task<'a>,
    weak: Weak,
    best: Option<Round>,
}

impl<'a> Together<'a> {
    /// The tasks that have a weak form.
    ///
    /// # Errors
    /// Terms that the data cannot evaluate, one a task.
    pub fn new(tasks: impl Iterator<Item = (usize, Task<'a>)>) -> Result<Self, Vec<Unevaluable>> {
        let (mut members, mut bad) = (Vec::new(), Vec::new());
        for (place, task) in tasks {
            match task.weak() {
                Ok(Some(weak)) => members.push(Member {
                    place,
                    task,
                    weak,
                    best: None,
                }),
                Ok(None) => {}
                Err(value) => bad.push((place, value)),
            }
        }
        if bad.is_empty() {
            Ok(Together { members })
        } else {
            Err(bad)
        }
    }

    /// Finds all equations: each alone, then again on the motion that the others gave.
    pub fn run(
        mut self,
        names: &Discovery,
        watcher: &mut Watcher,
    ) -> Vec<(usize, Result<Equation, Failed>)> {
        for pass in 0..PASSES {
            let mut changed = false;
            for k in 0..self.members.len() {
                let Some(member) = self.members.get(k) else {
                    continue;
                };
                watcher.turn_to(member.place);
                let mut weak = member.weak.clone();
                let shared = self.members.iter().filter_map(|m| m.best.as_ref());
                let shared = shared.filter(|r| r.left < TRUSTED && r.own.moved());
                let shared = shared.map(|r| &r.own);
                let others: Vec<&Weak> = shared.collect();
                if weak.adopt(&others, member.task.library).is_err() {
                    weak = member.weak.clone();
                }
                let before = member.best.as_ref().map(|r| &r.found);
                let next = member.task.search(&weak, before, watcher);
                let support = |r: &Option<Round>| r.as_ref().map(|r| r.found.support.clone());
                changed |= support(&next) != support(&member.best);
                if let (Some(member), Some(next)) = (self.members.get_mut(k), next) {
                    member.best = Some(next);
                }
            }
            let moved = |m: &Member| m.best.as_ref().is_some_and(|r| r.own.moved());
            if pass > 0 && !changed || !self.members.iter().any(moved) {
                break;
            }
        }
        let conclude = |m: Member| (m.place, m.task.integrated(m.best, names, watcher));
        self.members.into_iter().map(conclude).collect()
    }
}

impl Task<'_> {
    /// The integrals of this equation; `None` where there is nothing to integrate.
    ///
    /// # Errors
    /// A term that the data cannot evaluate.
    pub fn weak(&self) -> Result<Option<Weak>, Box<BadValue>> {
        let asked = Asked {
            model: self.model,
            dataset: self.dataset,
            target: self.target,
            known: &self.known,
            library: self.library,
            entries: ENTRIES.min((self.options.memory / BYTES) as usize),
        };
        Weak::new(&asked).map_err(|(mut bad, (trajectory, time))| {
            bad.row = nearest(self.samples, trajectory, time);
            bad
        })
    }

    /// The best guess from all beginnings, and from what was found before.
    fn search(&self, weak: &Weak, before: Option<&Found>, watcher: &mut Watcher) -> Option<Round> {
        let mut best: Option<Round> = None;
        let mut beginnings = self.beginnings(weak, watcher);
        beginnings.extend(before.cloned());
        for found in beginnings {
            self.rounds(weak, found, &mut best, watcher);
        }
        best
    }

    /// The equation of the best guess, with its evidence.
    fn integrated(
        &self,
        best: Option<Round>,
        names: &Discovery,
        watcher: &mut Watcher,
    ) -> Result<Equation, Failed> {
        if let (None, Some(stop)) = (&best, watcher.stop()) {
            return Err(self.failed(stop.failure()));
        }
        let best = best.and_then(|b| self.prepare_weak(&b.own, b.whitened));
        let Some(mut prepared) = best else {
            return Err(self.motionless(names));
        };
        let proposed = self.propose(&mut prepared, watcher);
        let answer = self.answer(&prepared, &proposed);
        let mut equation = self.conclude(names, &prepared, &answer);
        equation.path = self.path(&prepared, watcher);
        Ok(equation)
    }

    /// Distinct guesses from cautious beginnings: from dear terms and from cheap ones.
    fn beginnings(&self, weak: &Weak, watcher: &mut Watcher) -> Vec<Found> {
        let mut out: Vec<Found> = Vec::new();
        for slack in SLACKS {
            let Some(whitened) = weak.whitened(&[], slack) else {
                continue;
            };
            let first = out.len();
            for dear in DEAR {
                let found = self.choose(&whitened, dear, watcher);
                if out.iter().skip(first).all(|f| f.support != found.support) {
                    out.push(found);
                }
            }
        }
        out
    }

    /// Guess after guess, until the terms stay.
    fn rounds(
        &self,
        weak: &Weak,
        mut found: Found,
        best: &mut Option<Round>,
        watcher: &mut Watcher,
    ) {
        let mut own = weak.clone();
        for round in 0..ROUNDS {
            if watcher.at(Stage::Evaluating).is_some() {
                return;
            }
            let pairs = found.pairs.iter();
            let belief: Vec<(f64, Term)> = pairs.map(|(j, a)| (*a, self.term(*j))).collect();
            if own.refine(&belief, SLACK, self.library).is_err() {
                return;
            }
            let Some(whitened) = own.whitened(&belief, SLACK) else {
                return;
            };
            let next = self.choose(&whitened, 1.0, watcher);
            let settled = round > 0 && next.support == found.support;
            if best.as_ref().is_none_or(|b| next.value < b.found.value) {
                *best = Some(Round {
                    left: next.left / own.rows().max(1) as f64,
                    own: own.clone(),
                    whitened,
                    found: next.clone(),
                });
            }
            found = next;
            if settled {
                return;
            }
        }
    }

    /// The best terms where each costs `dear` times its due.
    fn choose(&self, whitened: &Whitened, dear: f64, watcher: &mut Watcher) -> Found {
        let phi = &whitened.columns;
        let mut criterion = Criterion::new(phi.rows(), 1.0, self.library.len(), KNOWN * KNOWN);
        criterion.per_term *= dear;
        let proposals = if phi.cols() > support::SEARCHABLE {
            let problem = Problem {
                dictionary: phi,
                target: &whitened.target,
                tolerance: (phi.rows() as f64).sqrt(),
            };
            watcher
                .solving(|monitor| self.options.solver.solve(&problem, monitor))
                .coefficients
        } else {
            Vec::new()
        };
        let choice = support::choose(phi, &whitened.target, &proposals, criterion, &mut || {
            watcher.at(Stage::Choosing).is_none()
        });
        let polished = solve::polish(phi, &whitened.target, &choice.support);
        let terms = choice.support.len() as f64;
        let columns = choice.support.iter().copied();
        let left = polished.residual.powi(2);
        Found {
            left,
            value: left + criterion.per_term * terms,
            pairs: columns.zip(polished.coefficients).collect(),
            support: choice.support,
        }
    }

    /// The rows of an equation that was found, weighed by what it says of their errors; `None` if there are none.
    pub fn as_found(
        &self,
        names: &Discovery,
        equation: &Equation,
        watcher: &mut Watcher,
    ) -> Option<Prepared> {
        let weak = match self.options.method {
            Method::Weak => self.weak().ok()?,
            _ => None,
        };
        let Some(mut weak) = weak else {
            return self.prepare(names, watcher).ok()?.ok();
        };
        let found = equation.terms.iter().filter(|t| !t.fixed);
        let belief: Vec<(f64, Term)> = found.map(|t| (t.coefficient, t.term.clone())).collect();
        weak.refine(&belief, SLACK, self.library).ok()?;
        let whitened = weak.whitened(&belief, SLACK)?;
        self.prepare_weak(&weak, whitened)
    }

    /// `None` where the target is zero.
    pub fn prepare_weak(&self, weak: &Weak, whitened: Whitened) -> Option<Prepared> {
        let rows = weak.rows();
        let size = rms(&whitened.target);
        if size == 0.0 || !size.is_finite() {
            return None;
        }
        let weights = Weights::known(rows, KNOWN);
        let basis = Basis::Integrals {
            rows,
            reach: weak.reach(),
        };
        Some(Prepared::new(
            basis,
            weights,
            Box::new(whitened.columns),
            whitened.target,
        ))
    }
}

/// The row of a trajectory that is nearest to an instant.
fn nearest(samples: &Samples, trajectory: u32, time: f64) -> usize {
    let rows = samples.trajectory.iter().zip(&samples.time).enumerate();
    let own = rows.filter(|(_, (t, _))| **t == trajectory);
    let apart = own.map(|(row, (_, at))| (row, (at - time).abs()));
    let nearest = apart.min_by(|a, b| a.1.total_cmp(&b.1));
    nearest.map_or(0, |(row, _)| row)
}
