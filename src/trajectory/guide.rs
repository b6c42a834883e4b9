//! Who may end a search early: asked between fits, and shown the first one.
//!
//! In: nothing but questions. Out: whether to go on. Knows neither clocks nor what the answer is for.

use super::fit::Fit;
use super::problem::Problem;

/// Whoever only says whether to go on is a guide.
pub trait Guide {
    /// `false` ends the search with what there is.
    fn go_on(&mut self) -> bool;

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
