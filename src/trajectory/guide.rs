//! Who may end a search early: asked between fits and in their midst, and shown the first one.
//!
//! In: nothing but questions. Out: whether to go on. Knows neither clocks nor what the answer is for.

use super::fit::Fit;
use super::problem::Problem;

/// Whoever only says whether to go on is a guide.
pub trait Guide {
    /// `false` ends the search with what there is.
    fn go_on(&mut self) -> bool;

    /// The same in the midst of a fit, as often as every few intervals: whoever counts fits does not count these.
    fn in_time(&mut self) -> bool {
        self.go_on()
    }

    /// Shown the best fit of what the smooth curves propose, on the samples it was made with; `false` ends the search without an
    /// answer.
    fn first(&mut self, _problem: &Problem, _fit: &Fit) -> bool {
        true
    }
}

impl<F: FnMut() -> bool> Guide for F {
    fn go_on(&mut self) -> bool {
        self()
    }
}

/// One more fit for a search that was stopped, if it is a short one.
#[derive(Default)]
pub(super) struct Grace {
    asked: usize,
}

/// Blocks of intervals of that fit: a second or two.
const GRACE: usize = 5_000;

impl Guide for Grace {
    fn go_on(&mut self) -> bool {
        false
    }

    fn in_time(&mut self) -> bool {
        self.asked += 1;
        self.asked <= GRACE
    }
}

/// Asked in the midst of long work: `false` gives it up.
pub(super) type GoOn<'a> = &'a mut dyn FnMut() -> bool;
