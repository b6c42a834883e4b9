//! The same rows and columns under several weights, solved side by side: the path with the fewest steps goes on first.
//!
//! In: problems that differ in their weights. Out: an answer for each. Which weights lead to a sparse answer is not known beforehand;
//! a path that leads there is short, and one that does not takes thousands of steps. So once a path has ended in a sparse answer, the
//! others may take only some times as many steps.

use sidc_progress::Observer;

use super::running::{Running, Started, start};
use crate::certificates::support;
use crate::problem::{Problem, Solution, Status};
use crate::thresholds::SIDE_BY_SIDE;

/// Solves each problem by [`super::Homotopy`]. A path that was given up, which none is within its first round, has the status
/// [`Status::Interrupted`].
pub fn side_by_side(
    problems: &[Problem],
    mut most_steps: usize,
    observer: &mut dyn Observer,
) -> Vec<Solution> {
    let targets: Vec<_> = problems.iter().map(start).collect();
    let mut runs: Vec<Run> = problems.iter().zip(&targets).map(Run::new).collect();
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

/// One path on its way.
struct Run<'a> {
    problem: &'a Problem<'a>,
    path: Option<Running<'a>>,
    solution: Option<Solution>,
}

impl<'a> Run<'a> {
    fn new((problem, started): (&'a Problem<'a>, &'a Started)) -> Run<'a> {
        let (path, solution) = match started.run(problem) {
            Ok(path) => (Some(path), None),
            Err(solution) => (None, Some(solution)),
        };
        Run {
            problem,
            path,
            solution,
        }
    }

    fn steps(&self) -> usize {
        self.path.as_ref().map_or(0, |path| path.steps())
    }

    /// One round of the path; its end if it has come, or if it has taken too many steps.
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

#[cfg(test)]
mod tests {
    use sidc_progress::Unwatched;
    use sidc_random::Numbers;

    use super::*;
    use crate::dictionary::{Dictionary, Graded, Grades};
    use crate::planted::planted;
    use crate::solvers::{Clarabel, Homotopy};
    use crate::{Solver, certify};

    /// y is in the span of four columns of 300, and fits more than 20 rows by no other four.
    #[test]
    fn every_norm_has_its_own_minimum_and_proof() {
        let mut numbers = Numbers(5);
        let (columns, target) = planted(&mut numbers, (20, 300), &[3, 50, 120, 290], 1.5);
        for seed in 0..6 {
            let mut numbers = Numbers(seed);
            let grade = |_| 3.0_f64.powf(numbers.next());
            let grades = Grades::of_columns((0..300).map(grade).collect());
            let graded = Graded {
                columns: &columns,
                grades: &grades,
            };
            for tolerance in [0.0, 0.2] {
                let problem = Problem {
                    dictionary: &graded,
                    target: &target,
                    tolerance,
                };
                let found = Homotopy.solve(&problem, &mut Unwatched);
                let other = Clarabel.solve(&problem, &mut Unwatched);
                let proof = certify(&problem, &found.coefficients, &found.dual);
                assert!(proof.proves_optimal, "{proof:?}");
                let size = |s: &Solution| problem.contributions(&s.coefficients).sum::<f64>();
                assert!((size(&found) / size(&other) - 1.0).abs() < 1e-6);
            }
        }
    }

    /// Weights that dismiss all but the law leave it in a few steps; the plain path is then given up, unless it is as short.
    #[test]
    fn a_sparse_answer_ends_the_long_paths() {
        let mut numbers = Numbers(9);
        let support: Vec<usize> = (0..12).map(|k| 40 * k).collect();
        let (columns, target) = planted(&mut numbers, (30, 600), &support, 1.5);
        let cheap = |j: usize| if support.contains(&j) { 1.0 } else { 50.0 };
        let grades = Grades::of_columns((0..600).map(cheap).collect());
        let graded = Graded {
            columns: &columns,
            grades: &grades,
        };
        let problem = |dictionary| Problem {
            dictionary,
            target: &target,
            tolerance: 0.0,
        };
        let alone = |p: &Problem| Homotopy.solve(p, &mut Unwatched);
        let problems = [problem(&columns as &dyn Dictionary), problem(&graded)];
        let found = side_by_side(&problems, usize::MAX, &mut Unwatched);
        assert_eq!(
            support,
            crate::support(&problems[1], &found[1].coefficients)
        );
        assert_eq!(found[1].coefficients, alone(&problems[1]).coefficients);
        let plain = alone(&problems[0]);
        let limit = SIDE_BY_SIDE.patience * found[1].iterations.max(SIDE_BY_SIDE.least_steps);
        match plain.iterations > limit + 64 {
            true => assert_eq!(found[0].status, Status::Interrupted),
            false => assert_eq!(found[0].coefficients, plain.coefficients),
        }
        // Of problems without a sparse answer none is given up.
        let noise = numbers.many(30);
        let dense = problems.map(|p| Problem {
            target: &noise,
            ..p
        });
        let found = side_by_side(&dense, usize::MAX, &mut Unwatched);
        assert!(found.iter().all(|s| s.status == Status::Solved));
    }
}
