//! Observers of a search of supports.
//!
//! In: what is done, the first fit. Out: whether to go on. Knows no clocks.

use std::ops::ControlFlow;

use sidc_progress::{Activity, Observer, Stop, Unwatched};

use crate::trajectory::likelihood::Fit;
use crate::trajectory::model::Problem;
use crate::trajectory::thresholds::SEARCH;

/// Hears [`Stage::Refitting`](sidc_progress::Stage::Refitting) between fits, and [`Activity::Working`] during a fit.
pub trait SearchObserver: Observer {
    /// Shown the best fit among the supports that integral matching proposes; `false` ends the search without an
    /// answer.
    fn first(&mut self, _problem: &Problem, _fit: &Fit) -> bool {
        true
    }

    /// Shown a fit under disturbances. Returns its residuals over what noise alone may give; above 1 they are
    /// unexplained.
    fn left_by(&mut self, _problem: &Problem, _fit: &Fit) -> f64 {
        0.0
    }
}

impl SearchObserver for Unwatched {}

/// Allows a stopped search one last fit, if it is short.
#[derive(Default)]
pub(crate) struct FitBudget {
    asked: usize,
}

impl Observer for FitBudget {
    fn hear(&mut self, activity: Activity) -> ControlFlow<Stop> {
        self.asked += usize::from(activity == Activity::Working);
        match activity {
            Activity::Working if self.asked <= SEARCH.grace_blocks => ControlFlow::Continue(()),
            _ => ControlFlow::Break(Stop::Interrupted),
        }
    }
}

impl SearchObserver for FitBudget {}
