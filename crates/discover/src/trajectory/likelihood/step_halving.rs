//! Step halving for Gauss–Newton: a step after which the criterion rises is halved until it falls.
//!
//! In: points and the criterion there. Out: the point to try next, or that no step helps. The linearised likelihood does not see jumps of
//! terms such as `sign(dx)`, so full steps may oscillate between two points. A fit whose criterion falls with full steps is left alone.
//! Linearises nothing.

use crate::trajectory::model::LinearizationPoint;
use crate::trajectory::thresholds::GAUSS_NEWTON;

/// The control of one fit's steps.
pub(super) struct StepHalving<Fit> {
    /// Whether the criterion has risen after a full step: from then on it is evaluated at every point before a step is taken.
    halves: bool,
    /// The best point so far at which the criterion was evaluated, as a fit.
    accepted: Option<(Fit, f64)>,
    /// Where the last full step began.
    start: Option<LinearizationPoint>,
    /// Largest move of a state in that step, in units of its noise.
    largest_move: f64,
    halvings: usize,
    /// Steps granted beyond the usual number.
    added: usize,
}

/// What to do after the criterion was evaluated at a point.
pub(super) enum StepDecision {
    /// Take a step from it.
    Step,
    /// Try this one instead.
    Try(LinearizationPoint),
    /// No step helps any more.
    End,
}

impl<Fit> Default for StepHalving<Fit> {
    fn default() -> Self {
        StepHalving {
            halves: false,
            accepted: None,
            start: None,
            largest_move: 0.0,
            halvings: 0,
            added: 0,
        }
    }
}

impl<Fit> StepHalving<Fit> {
    pub fn is_halving(&self) -> bool {
        self.halves
    }

    /// Whether the step limit may be raised by one, for an iteration that only evaluated the criterion.
    pub fn may_add_step(&mut self) -> bool {
        self.added += 1;
        self.added <= GAUSS_NEWTON.halving_steps
    }

    /// Notes that a full step starts, and its largest move of a state, `largest_move`, in units of the noise. `at`: where it starts, for
    /// halving; `None` while full steps are trusted.
    pub fn starts(&mut self, at: Option<LinearizationPoint>, largest_move: f64) {
        self.start = at;
        self.largest_move = largest_move;
        self.halvings = 0;
    }

    /// From now on steps are halved where the criterion rises.
    pub fn start_halving(&mut self) {
        self.halves = true;
    }

    /// Decides by the criterion `value` of the fit `here`, which has the coefficients of the point `at`.
    pub fn judge(&mut self, here: Fit, value: f64, at: &LinearizationPoint) -> StepDecision {
        let best = self.best_value();
        if value < best - GAUSS_NEWTON.criterion_step || self.accepted.is_none() {
            self.accepted = Some((here, value));
            return StepDecision::Step;
        }
        match self.halfway(at.clone()) {
            Some(point) => StepDecision::Try(point),
            None => StepDecision::End,
        }
    }

    /// Whether the criterion was evaluated at some point.
    pub fn has_judged(&self) -> bool {
        self.accepted.is_some()
    }

    fn best_value(&self) -> f64 {
        self.accepted.as_ref().map_or(f64::INFINITY, |(_, v)| *v)
    }

    /// The point halfway back to where the last step began; `None` while full steps are trusted, and after the most halvings.
    pub fn halfway(&mut self, from: LinearizationPoint) -> Option<LinearizationPoint> {
        let start = self.start.as_ref()?;
        let known = self.halves && self.accepted.is_some();
        if !known || self.halvings >= GAUSS_NEWTON.max_halvings {
            return None;
        }
        self.halvings += 1;
        Some(middle(start, from))
    }

    /// Whether a predicted criterion is no better than that of the best point.
    pub fn gain_is_negligible(&self, promised: f64) -> bool {
        self.best_value() - promised < GAUSS_NEWTON.criterion_step
    }

    /// The best point at which the criterion was evaluated, and whether the fit has converged: as `converged` says, or because the step
    /// that no longer helped was as small as the steps at convergence are.
    pub fn best(self, converged: bool) -> Option<(Fit, bool)> {
        let shortest = self.largest_move * 0.5_f64.powi(self.halvings as i32);
        let converged = converged || shortest < GAUSS_NEWTON.state_step;
        self.accepted.map(|(fit, _)| (fit, converged))
    }
}

/// Halfway between two points of one support. Noises are those of `a`, so that the criteria at both are comparable.
fn middle(a: &LinearizationPoint, mut b: LinearizationPoint) -> LinearizationPoint {
    let halve = |x: &mut [f64], y: &[f64]| {
        x.iter_mut().zip(y).for_each(|(x, y)| *x = 0.5 * (*x + *y));
    };
    halve(&mut b.coefficients, &a.coefficients);
    for (x, y) in b.paths.iter_mut().zip(&a.paths) {
        halve(x, y);
    }
    b.sigma.clone_from(&a.sigma);
    b
}
