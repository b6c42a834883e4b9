//! The same rows and columns under several weights, solved side by side: the path with the fewest steps goes on first.
//!
//! In: problems that differ in their weights. Out: an answer for each. Which weights lead to a sparse answer is not known beforehand;
//! a path that leads there is short, and one that does not takes thousands of steps. So once a path has ended in a sparse answer, the
//! others may take only some times as many steps.

use sidc_progress::Observer;

use super::path_in_progress::{PathInProgress, PreparedPath, start};
use crate::certificates::support;
use crate::problem::{Problem, Solution, Status};
use crate::thresholds::SIDE_BY_SIDE;

/// Solves each problem by [`super::Homotopy`]. A path that was given up has the status [`Status::Interrupted`]; none is given up
/// within its first round.
pub fn side_by_side(
    problems: &[Problem],
    mut most_steps: usize,
    observer: &mut dyn Observer,
) -> Vec<Solution> {
    let targets: Vec<_> = problems.iter().map(start).collect();
    let mut runs: Vec<ActivePath> = problems.iter().zip(&targets).map(ActivePath::new).collect();
    loop {
        let going = runs.iter_mut().filter(|run| run.solution.is_none());
        let Some(run) = going.min_by_key(|run| run.steps()) else {
            break;
        };
        run.round(most_steps, observer);
        if run
            .solution
            .as_ref()
            .is_some_and(|s| is_sparse(run.problem, s))
        {
            let allowed = run.steps().max(SIDE_BY_SIDE.least_steps) * SIDE_BY_SIDE.patience;
            most_steps = most_steps.min(allowed);
        }
    }
    let zero = |problem| Solution::zero(problem, Status::broken_down());
    let solutions = runs.into_iter().zip(problems);
    solutions
        .map(|(run, problem)| run.solution.unwrap_or_else(|| zero(problem)))
        .collect()
}

/// One problem with its path.
struct ActivePath<'a> {
    problem: &'a Problem<'a>,
    path: Option<PathInProgress<'a>>,
    solution: Option<Solution>,
}

impl<'a> ActivePath<'a> {
    fn new((problem, started): (&'a Problem<'a>, &'a PreparedPath)) -> ActivePath<'a> {
        let (path, solution) = match started.run(problem) {
            Ok(path) => (Some(path), None),
            Err(solution) => (None, Some(solution)),
        };
        ActivePath {
            problem,
            path,
            solution,
        }
    }

    fn steps(&self) -> usize {
        self.path.as_ref().map_or(0, |path| path.steps())
    }

    /// One round of the path. Sets the solution if the path has ended, or was given up after `most_steps` steps.
    fn round(&mut self, most_steps: usize, observer: &mut dyn Observer) {
        if let Some(path) = &mut self.path {
            self.solution = match path.steps() < most_steps {
                true => path.round(observer),
                false => Some(path.given_up()),
            };
        }
    }
}

/// Whether an answer has so few terms that it is no fit of as many columns as rows.
pub fn is_sparse(problem: &Problem, solution: &Solution) -> bool {
    let terms = support(problem, &solution.coefficients).len() as f64;
    let rows = problem.dictionary.rows() as f64;
    solution.status == Status::Solved && terms <= SIDE_BY_SIDE.sparse * rows
}
