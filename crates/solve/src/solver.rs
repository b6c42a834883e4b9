//! What every solver implements.

use std::ops::ControlFlow;

use sidc_progress::SolverProgress;

use crate::problem::{Problem, Solution};

/// Called after every iteration; `Break` asks the solver to stop and return what it has.
pub type Monitor<'a> = &'a mut dyn FnMut(SolverProgress) -> ControlFlow<()>;

/// A monitor that never stops anything.
pub fn unwatched(_: SolverProgress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

pub trait Solver: Sync {
    /// What `--solver` takes.
    fn name(&self) -> &'static str;
    /// One line for help texts.
    fn about(&self) -> &'static str;
    /// True if it solves the stated problem and returns a dual point that can prove so. False for a heuristic: its answer fits, but
    /// another may be smaller or sparser, and its dual point is zero.
    fn exact(&self) -> bool {
        true
    }
    fn solve(&self, problem: &Problem, monitor: Monitor) -> Solution;
}
