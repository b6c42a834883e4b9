//! Steps of Gauss–Newton that do not keep what they promised: halved until the criterion falls.
//!
//! In: points and the criterion where they are. Out: the point to try next, or that no step helps. Terms that jump, as `sign(dx)` does,
//! have no slope at their jump, so the linearised likelihood does not see them coming: full steps then swing between two points for ever.
//! A fit that goes downhill by itself is left alone. Linearises nothing.

use crate::trajectory::model::LinearizationPoint;
use crate::trajectory::thresholds::GAUSS_NEWTON;

/// The control of one fit's steps.
pub(super) struct StepHalving<Fit> {
    /// Whether a step has gone uphill: from then on every point is judged by its own criterion.
    careful: bool,
    /// The best point so far that was judged, as a fit.
    accepted: Option<(Fit, f64)>,
    /// Where the last full step began.
    start: Option<LinearizationPoint>,
    /// Largest move of a state in that step, in units of its noise.
    reach: f64,
    halvings: usize,
    /// Steps granted beyond the usual number.
    added: usize,
}

/// What to do at a point that was judged.
pub(super) enum Verdict {
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
            careful: false,
            accepted: None,
            start: None,
            reach: 0.0,
            halvings: 0,
            added: 0,
        }
    }
}

impl<Fit> StepHalving<Fit> {
    pub fn is_careful(&self) -> bool {
        self.careful
    }

    /// Whether one step more may be taken for one that only looked.
    pub fn may_add_step(&mut self) -> bool {
        self.added += 1;
        self.added <= GAUSS_NEWTON.careful_steps
    }

    /// A full step starts; its largest move of a state is `reach`. Where it starts is needed once steps are mistrusted.
    pub fn starts(&mut self, at: Option<LinearizationPoint>, reach: f64) {
        self.start = at;
        self.reach = reach;
        self.halvings = 0;
    }

    /// The criterion went uphill with full steps.
    pub fn mistrust(&mut self) {
        self.careful = true;
    }

    /// Judges a point by its fit without a further move of the coefficients, whose criterion is `value`.
    pub fn judge(&mut self, here: Fit, value: f64, at: &LinearizationPoint) -> Verdict {
        let best = self.best_value();
        if value < best - GAUSS_NEWTON.criterion_step || self.accepted.is_none() {
            self.accepted = Some((here, value));
            return Verdict::Step;
        }
        match self.halfway(at.clone()) {
            Some(point) => Verdict::Try(point),
            None => Verdict::End,
        }
    }

    /// Whether some point was judged by its own criterion.
    pub fn has_judged(&self) -> bool {
        self.accepted.is_some()
    }

    fn best_value(&self) -> f64 {
        self.accepted.as_ref().map_or(f64::INFINITY, |(_, v)| *v)
    }

    /// The point halfway back to where the last step began; `None` while full steps are trusted, and once it is no step any more.
    pub fn halfway(&mut self, from: LinearizationPoint) -> Option<LinearizationPoint> {
        let start = self.start.as_ref()?;
        let known = self.careful && self.accepted.is_some();
        if !known || self.halvings >= GAUSS_NEWTON.max_halvings {
            return None;
        }
        self.halvings += 1;
        Some(middle(start, from))
    }

    /// Whether a step promises no more than the best point has.
    pub fn promises_nothing(&self, promised: f64) -> bool {
        self.best_value() - promised < GAUSS_NEWTON.criterion_step
    }

    /// The best point that was judged, and whether it has arrived: the last step promised nothing, or steps that did not help from
    /// there were as small as those of any fit that has converged.
    pub fn best(self, arrived: bool) -> Option<(Fit, bool)> {
        let shortest = self.reach * 0.5_f64.powi(self.halvings as i32);
        let arrived = arrived || shortest < GAUSS_NEWTON.state_step;
        self.accepted.map(|(fit, _)| (fit, arrived))
    }
}

/// Halfway between two points of one support. Noises are those of the first, so that both are measured alike.
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
