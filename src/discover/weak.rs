//! One equation by its weak form: guess, weigh the rows by the guess, guess again; the most likely guess is concluded.
//!
//! In: a task. Out: the same as from regression: rows, Φ, and what errors allow. What noise does to the library is known only as
//! soon as the equation is, nearly: so a few rounds are run from cautious beginnings, and judged by their likelihood.

use super::equation::{Basis, Prepared, Task};
use super::subset::Criterion;
use super::support;
use super::watch::{Stage, Watcher};
use super::weights::{Weights, rms};
use super::{Discovery, Equation, Failed};
use crate::data::Samples;
use crate::dictionary::{BadValue, Dictionary};
use crate::solve::{self, Problem};
use crate::term::Term;
use crate::weak::{Asked, Weak, Whitened};

/// Most entries of Φ, and of its whitened copy.
const ENTRIES: usize = 4_000_000;
/// Cautious beginnings: the noise of a record that each step of the equation may be wrong by.
const SLACKS: [f64; 2] = [0.3, 0.03];
/// Of it, what is left where there is a guess.
const LATER: f64 = 0.1;
/// Rounds from each beginning.
const ROUNDS: usize = 4;
/// Rows are known to have errors of size one, to a factor.
const KNOWN: f64 = 0.3;

/// Terms dearer than their due find what is large first: a guess with terms too many misleads more than one with too few.
const DEAR: [f64; 3] = [1.0, 4.0, 16.0];

/// Terms of one round.
struct Found {
    support: Vec<usize>,
    pairs: Vec<(usize, f64)>,
    /// Squared residual, and the cost of the terms.
    value: f64,
}

/// One guess, and how likely it makes the data.
struct Round {
    whitened: Whitened,
    /// −2 ln likelihood, and the cost of the terms.
    value: f64,
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
            entries: ENTRIES,
        };
        Weak::new(&asked).map_err(|(mut bad, (trajectory, time))| {
            bad.row = nearest(self.samples, trajectory, time);
            bad
        })
    }

    /// Finds the equation from its integrals.
    ///
    /// # Errors
    /// A term that the data cannot evaluate; inside, an equation that was not found.
    pub fn run_weak(
        &self,
        weak: &Weak,
        names: &Discovery,
        watcher: &mut Watcher,
    ) -> Result<Equation, Failed> {
        let beginnings = self.beginnings(weak, watcher);
        let mut best: Option<Round> = None;
        for (slack, found) in beginnings {
            for round in self.rounds(weak, slack, found, watcher) {
                if best.as_ref().is_none_or(|b| round.value < b.value) {
                    best = Some(round);
                }
            }
        }
        if let (None, Some(stop)) = (&best, watcher.stop()) {
            return Err(self.failed(stop.failure()));
        }
        let best = best.and_then(|b| self.prepare_weak(weak, b.whitened));
        let Some(mut prepared) = best else {
            return Err(self.motionless(names));
        };
        let proposed = self.propose(&mut prepared, watcher);
        let answer = self.answer(&prepared, &proposed);
        let mut equation = self.conclude(names, &prepared, &answer);
        equation.path = self.path(&prepared, watcher);
        Ok(equation)
    }

    /// Distinct supports, each with the caution that it was found under: from dear terms and from cheap ones.
    fn beginnings(&self, weak: &Weak, watcher: &mut Watcher) -> Vec<(f64, Found)> {
        let mut out: Vec<(f64, Found)> = Vec::new();
        for slack in SLACKS {
            let Some(whitened) = weak.whitened(&[], slack) else {
                continue;
            };
            for dear in DEAR {
                let found = self.choose(&whitened, dear, watcher);
                let known = |(s, f): &(f64, Found)| *s == slack && f.support == found.support;
                if !out.iter().any(known) {
                    out.push((slack, found));
                }
            }
        }
        out
    }

    /// Guess after guess, until the terms stay.
    fn rounds(
        &self,
        weak: &Weak,
        slack: f64,
        mut found: Found,
        watcher: &mut Watcher,
    ) -> Vec<Round> {
        let mut own = weak.clone();
        let mut out = Vec::new();
        let slack = std::env::var("SL").map_or(0.01, |v| v.parse().unwrap());
        for round in 0..ROUNDS {
            if watcher.at(Stage::Evaluating).is_some() {
                break;
            }
            let belief: Vec<(f64, Term)> = found
                .pairs
                .iter()
                .map(|(j, a)| (*a, self.term(*j)))
                .collect();
            if std::env::var("NOREF").is_err() && own.refine(&belief, slack, self.library).is_err()
            {
                break;
            }
            let Some(whitened) = own.whitened(&belief, slack) else {
                break;
            };
            let next = self.choose(&whitened, 1.0, watcher);
            let settled = round > 0 && next.support == found.support;
            found = next;
            let value = found.value;
            if std::env::var("WDBG").is_ok() {
                eprintln!(
                    "{slack} {round} {value} {} {:?}",
                    whitened.log_det,
                    found.pairs.iter().map(|p| (p.0, p.1)).collect::<Vec<_>>()
                );
            }
            out.push(Round { whitened, value });
            if settled {
                break;
            }
        }
        out
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
        Found {
            value: polished.residual.powi(2) + criterion.per_term * terms,
            pairs: columns.zip(polished.coefficients).collect(),
            support: choice.support,
        }
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
