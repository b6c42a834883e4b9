//! Paths in several norms: each ends in the minimum of its own, and a sparse answer ends the others.

use sidc_progress::Unwatched;
use sidc_random::Numbers;

use super::side_by_side::side_by_side;
use crate::dictionary::{Dictionary, Graded, Grades};
use crate::planted::planted;
use crate::problem::{Problem, Solution, Status};
use crate::solvers::{Clarabel, Homotopy};
use crate::thresholds::SIDE_BY_SIDE;
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
