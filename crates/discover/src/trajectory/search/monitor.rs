//! The monitor of a search: it decides whether the search goes on, and receives the first fit.
//!
//! In: questions. Out: answers. Knows no clocks.

use crate::trajectory::likelihood::Fit;
use crate::trajectory::model::Problem;
use crate::trajectory::thresholds::SEARCH;

/// A closure that says whether to go on is a monitor.
pub trait SearchMonitor {
    /// Asked between fits; `false` ends the search with the best fit so far.
    fn go_on(&mut self) -> bool;

    /// The same during a fit, every few intervals. Monitors that count fits do not count these questions.
    fn in_time(&mut self) -> bool {
        self.go_on()
    }

    /// Shown the best fit of the supports that integral matching proposes; `false` ends the search without an answer.
    fn first(&mut self, _problem: &Problem, _fit: &Fit) -> bool {
        true
    }
}

impl<F: FnMut() -> bool> SearchMonitor for F {
    fn go_on(&mut self) -> bool {
        self()
    }
}

/// Allows a stopped search one last fit, if it is short.
#[derive(Default)]
pub(crate) struct FitBudget {
    asked: usize,
}

impl SearchMonitor for FitBudget {
    fn go_on(&mut self) -> bool {
        false
    }

    fn in_time(&mut self) -> bool {
        self.asked += 1;
        self.asked <= SEARCH.grace_blocks
    }
}
