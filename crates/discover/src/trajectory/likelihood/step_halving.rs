//! Steps of Gauss–Newton that do not keep what they promised: halved until the criterion falls.
//!
//! In: points and the criterion where they are. Out: the point to try next, or that no step helps. Terms that jump, as `sign(dx)` does,
//! have no slope at their jump, so the linearised likelihood does not see them coming: full steps then swing between two points for ever.
//! A fit that goes downhill by itself is left alone. Linearises nothing.

use super::gauss_newton::Fit;
use crate::trajectory::model::LinearizationPoint;
use crate::trajectory::thresholds::GAUSS_NEWTON;

/// The control of one fit's steps.
#[derive(Default)]
pub(super) struct StepHalving {
    /// Whether a step has gone uphill: from then on every point is judged by its own criterion.
    careful: bool,
    /// The best point so far that was judged, as a fit.
    accepted: Option<Fit>,
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

impl StepHalving {
    pub fn is_careful(&self) -> bool {
        self.careful
    }

    /// Whether one step more may be taken for one that only looked.
    pub fn may_add_step(&mut self) -> bool {
        self.added += 1;
        self.added <= GAUSS_NEWTON.careful_steps
    }

    /// A full step starts here; its largest move of a state is `reach`.
    pub fn starts(&mut self, at: LinearizationPoint, reach: f64) {
        self.start = Some(at);
        self.reach = reach;
        self.halvings = 0;
    }

    /// The criterion went uphill with full steps.
    pub fn mistrust(&mut self) {
        self.careful = true;
    }

    /// Judges a point by its fit without a further move of the coefficients.
    pub fn judge(&mut self, here: Fit) -> Verdict {
        let best = self.accepted.as_ref().map_or(f64::INFINITY, |f| f.value);
        if here.value < best - GAUSS_NEWTON.criterion_step || self.accepted.is_none() {
            self.accepted = Some(here);
            return Verdict::Step;
        }
        match self.halfway(here.point) {
            Some(point) => Verdict::Try(point),
            None => Verdict::End,
        }
    }

    /// The point halfway back to where the last step began; `None` once that is no step any more, or there was none.
    pub fn halfway(&mut self, from: LinearizationPoint) -> Option<LinearizationPoint> {
        let start = self.start.as_ref()?;
        if self.halvings >= GAUSS_NEWTON.max_halvings {
            return None;
        }
        self.careful = true;
        self.halvings += 1;
        Some(middle(start, from))
    }

    /// Whether a step promises no more than the best point has.
    pub fn promises_nothing(&self, promised: f64) -> bool {
        let best = self.accepted.as_ref().map_or(f64::INFINITY, |f| f.value);
        best - promised < GAUSS_NEWTON.criterion_step
    }

    /// The best point that was judged. It has arrived if the last step promised nothing, or if steps that did not help from there were
    /// as small as those of any fit that has converged.
    pub fn best(self, arrived: bool) -> Option<Fit> {
        let shortest = self.reach * 0.5_f64.powi(self.halvings as i32);
        let arrived = arrived || shortest < GAUSS_NEWTON.state_step;
        self.accepted.map(|fit| Fit { arrived, ..fit })
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
