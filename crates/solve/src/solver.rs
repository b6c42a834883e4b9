//! What every solver implements.

use sidc_progress::Observer;

use crate::problem::{Problem, Solution};

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
    /// Tells the observer of every iteration; where it ends the work, the answer is what there is by then.
    fn solve(&self, problem: &Problem, observer: &mut dyn Observer) -> Solution;
    /// Whether `solve_all` gives up paths that lead to no sparse answer, so that several norms cost little more than one.
    fn gives_up(&self) -> bool {
        false
    }
    /// Answers to problems that differ only in the weights of their columns. A solver may give up a path that is not sparse while
    /// another is, or that takes more than the allowed steps; its status is then [`crate::Status::Interrupted`].
    fn solve_all(
        &self,
        problems: &[Problem],
        _most_steps: usize,
        observer: &mut dyn Observer,
    ) -> Vec<Solution> {
        problems.iter().map(|p| self.solve(p, observer)).collect()
    }
}
