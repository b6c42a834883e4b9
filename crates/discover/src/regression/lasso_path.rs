//! The Lasso path of one equation: its answers for falling penalties, from no term to the tolerance of the equation.
//!
//! In: the problem of one equation. Out: the first knots of the path and the last one, as terms. Never selects terms.

use crate::regression::task::Task;
use crate::regression::thresholds::LASSO_PATH;
use crate::statistics::norm;
use sidc_progress::EquationObserver;
use sidc_solve as solve;
use sidc_solve::{Knot, Problem};
use sidc_system::discovery::PathKnot;

impl Task<'_> {
    /// The knots down to ε of a problem, in its norm, if they were requested; none once the work is to stop.
    pub fn lasso_path(&self, problem: &Problem, watcher: &mut EquationObserver) -> Vec<PathKnot> {
        if !self.options.path || watcher.stop().is_some() {
            return Vec::new();
        }
        let knots = solve::lasso_path(problem, LASSO_PATH.max_knots, watcher);
        let largest = knots.first().map_or(1.0, |k| k.penalty);
        let last = knots.len().saturating_sub(1);
        let kept = knots.iter().enumerate();
        let kept = kept.filter(|(i, _)| *i + 1 < LASSO_PATH.kept_knots || *i == last);
        kept.map(|(i, knot)| self.knot(problem, i + 1, knot, largest))
            .collect()
    }

    fn knot(&self, problem: &Problem, number: usize, knot: &Knot, largest: f64) -> PathKnot {
        let proof = solve::certify_lasso(problem, knot.penalty, &knot.coefficients, &knot.dual);
        let shares: Vec<f64> = problem.contributions(&knot.coefficients).collect();
        let least = LASSO_PATH.zero_share * shares.iter().fold(0.0, |m: f64, s| m.max(*s));
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
