//! The whole path of an equation: the answers for every larger tolerance, from no term at all to the solver's proposal.
//!
//! In: the problem of one equation. Out: its knots as terms, the first ones and the last; what lies between is counted, not kept.

use super::discovery::PathKnot;
use super::equation::Task;
use super::prepared::Prepared;
use super::watch::Watcher;
use super::weights::norm;
use crate::solve::{self, Knot, Problem};

/// Knots that are kept: all but one from the start, and the last.
const KEPT: usize = 100;
/// Knots after which a path is left: hundreds of terms by then, which say nothing of a sparse law.
const MOST: usize = 2000;
/// Part of the largest |a_j|‖φ_j‖ up to which a coefficient is rounding, and no term.
const ROUNDING: f64 = 1e-12;

impl Task<'_> {
    /// The knots down to the equation's ε, if they are asked for; none once the work is to stop.
    pub fn path(&self, prepared: &Prepared, watcher: &mut Watcher) -> Vec<PathKnot> {
        if !self.options.path || watcher.stop().is_some() {
            return Vec::new();
        }
        let problem = prepared.problem();
        let knots = watcher.solving(|monitor| solve::lasso_path(&problem, MOST, monitor));
        let largest = knots.first().map_or(1.0, |k| k.penalty);
        let last = knots.len().saturating_sub(1);
        let kept = knots.iter().enumerate();
        let kept = kept.filter(|(i, _)| *i + 1 < KEPT || *i == last);
        kept.map(|(i, knot)| self.knot(&problem, i + 1, knot, largest))
            .collect()
    }

    fn knot(&self, problem: &Problem, number: usize, knot: &Knot, largest: f64) -> PathKnot {
        let proof = solve::certify_lasso(problem, knot.penalty, &knot.coefficients, &knot.dual);
        let shares: Vec<f64> = problem.shares(&knot.coefficients).collect();
        let least = ROUNDING * shares.iter().fold(0.0, |m: f64, s| m.max(*s));
        let present = knot.coefficients.iter().zip(&shares);
        let present = present.filter(|(_, share)| **share > least);
        PathKnot {
            number,
            penalty: knot.penalty / largest,
            residual: knot.residual / norm(problem.target),
            terms: self.found(present.map(|(pair, _)| (*pair, None))),
            enters: knot.enters.map(|j| self.term(j)),
            leaves: knot.leaves.map(|j| self.term(j)),
            gap: proof.gap,
        }
    }
}
