//! One equation by its weak form: guess, weigh the rows by the guess, guess again; the most likely guess is concluded.
//!
//! In: a task. Out: the same as from regression: rows, Φ, and what errors allow. What noise does to the library is known only as
//! soon as the equation is, nearly: so a few rounds are run from cautious beginnings, and judged by their likelihood.

use super::equation::{Basis, Prepared, Proposed, Task};
use super::watch::{Stage, Watcher};
use super::weights::{Weights, rms};
use super::{Discovery, Equation, Failed};
use crate::data::Samples;
use crate::dictionary::BadValue;
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

/// What was found in one round, and how likely it makes the data.
struct Round {
    prepared: Prepared,
    proposed: Proposed,
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
    pub fn run_weak(
        &self,
        weak: &Weak,
        names: &Discovery,
        watcher: &mut Watcher,
    ) -> Result<Equation, Failed> {
        let mut best: Option<Round> = None;
        for slack in SLACKS {
            let mut belief: Vec<(f64, Term)> = Vec::new();
            let mut support = Vec::new();
            for round in 0..ROUNDS {
                if let Some(stop) = watcher.at(Stage::Evaluating) {
                    if best.is_none() {
                        return Err(self.failed(stop.failure()));
                    }
                    break;
                }
                let slack = if round == 0 { slack } else { LATER * slack };
                let Some(whitened) = weak.whitened(&belief, slack) else {
                    break;
                };
                let Some(mut found) = self.round(weak, whitened, watcher) else {
                    return Err(self.motionless(names));
                };
                let pairs = found.proposed.pairs();
                belief = pairs.iter().map(|(j, a)| (*a, self.term(*j))).collect();
                let settled = round > 1 && support == found.proposed.choice.support;
                support = found.proposed.choice.support.clone();
                if round == 0 {
                    // Without a guess the rows' errors are not those of the library: no likelihood to compare.
                    found.value = f64::MAX;
                }
                if best.as_ref().is_none_or(|b| found.value < b.value) {
                    best = Some(found);
                }
                if settled {
                    break;
                }
            }
        }
        let Some(best) = best else {
            return Err(self.motionless(names));
        };
        let answer = self.answer(&best.prepared, &best.proposed);
        let mut equation = self.conclude(names, &best.prepared, &answer);
        equation.path = self.path(&best.prepared, watcher);
        Ok(equation)
    }

    fn round(&self, weak: &Weak, whitened: Whitened, watcher: &mut Watcher) -> Option<Round> {
        let log_det = whitened.log_det;
        let mut prepared = self.prepare_weak(weak, whitened)?;
        let proposed = self.propose(&mut prepared, watcher);
        let rss = proposed.polished.residual.powi(2);
        let terms = proposed.choice.support.len() as f64;
        let value = log_det + rss + proposed.criterion.per_term * terms;
        Some(Round {
            prepared,
            proposed,
            value,
        })
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
