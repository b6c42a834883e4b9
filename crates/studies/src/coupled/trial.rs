//! One solve: is the answer the law?
//!
//! In: a system's law, a library, rows, a grading. Out: whether the answer is exact, its terms, its steps. A long path is abandoned.

use std::ops::ControlFlow;
use std::time::Instant;

use sidc_progress::{Activity, Stop};
use sidc_solve::dictionary::{Factored, Graded, Grades};
use sidc_solve::{Problem, SOLVERS, Solution, Status};
use sidc_testing::plants::coupled::Law;

use super::library::Library;

/// Largest relative error of a coefficient, and largest share of a false term, in an exact answer.
const EXACT: f64 = 1e-8;
/// Smallest share that counts as a term, relative to the largest.
const COUNTS: f64 = 1e-6;

pub struct Outcome {
    pub exact: bool,
    /// Whether the solver met its own stopping test.
    pub solved: bool,
    pub terms: usize,
    pub steps: usize,
    /// ‖Φa − y‖/‖y‖
    pub residual: f64,
    pub seconds: f64,
}

/// Basis pursuit, abandoned after `most` steps.
pub fn outcome(
    (phi, grades): (&Factored, &Grades),
    target: &[f64],
    law: &Law,
    library: &Library,
    most: usize,
) -> Outcome {
    let start = Instant::now();
    let problem = Problem {
        dictionary: &Graded {
            columns: phi,
            grades,
        },
        target,
        tolerance: 0.0,
    };
    let mut steps = 0;
    let solution = SOLVERS[0].solve(&problem, &mut |_: Activity| {
        steps += 1;
        match steps > most {
            true => ControlFlow::Break(Stop::Interrupted),
            false => ControlFlow::Continue(()),
        }
    });
    let truth: Option<Vec<(usize, f64)>> = law
        .terms
        .iter()
        .map(|(m, c)| Some((library.place(m)?, *c)))
        .collect();
    judged(&problem, &solution, truth, start)
}

/// Compares a solution with the law's columns and coefficients; `truth` is `None` if a column is missing.
pub fn judged(
    problem: &Problem,
    solution: &Solution,
    truth: Option<Vec<(usize, f64)>>,
    start: Instant,
) -> Outcome {
    let share = |(j, a): &(usize, f64)| a.abs() * problem.dictionary.norm(*j);
    let largest = solution.coefficients.iter().map(share).fold(0.0, f64::max);
    let exact = truth.is_some_and(|truth| {
        let right = |(j, c): &(usize, f64)| ((solution.coefficient(*j) - c) / c).abs() <= EXACT;
        let known = |j: usize| truth.iter().any(|(k, _)| *k == j);
        let mut others = solution.coefficients.iter().filter(|(j, _)| !known(*j));
        truth.iter().all(right) && others.all(|pair| share(pair) <= EXACT * largest)
    });
    let counted = solution.coefficients.iter();
    let residual = problem.residual(&solution.coefficients);
    let length = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    Outcome {
        exact,
        solved: solution.status == Status::Solved,
        terms: counted.filter(|p| share(p) > COUNTS * largest).count(),
        steps: solution.iterations,
        residual: length(&residual) / length(problem.target).max(f64::MIN_POSITIVE),
        seconds: start.elapsed().as_secs_f64(),
    }
}
