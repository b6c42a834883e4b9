//! The proved sparsest support against every support there is.

use std::ops::ControlFlow;

use sidc_progress::{Activity, Stop, Unwatched};
use sidc_random::Numbers;

use super::columns::Columns;
use super::{Sparsest, SparsestLimits, prove_sparsest};
use crate::dictionary::Dense;
use crate::linalg::norm;
use crate::problem::Problem;

/// A random problem with what makes supports tie: duplicates, dependent triples, zero columns.
struct Case {
    dictionary: Dense,
    target: Vec<f64>,
    tolerance: f64,
}

impl Case {
    fn problem(&self) -> Problem<'_> {
        Problem {
            dictionary: &self.dictionary,
            target: &self.target,
            tolerance: self.tolerance,
        }
    }
}

fn below(numbers: &mut Numbers, n: usize) -> usize {
    (((numbers.next() + 1.0) / 2.0 * n as f64) as usize).min(n - 1)
}

fn case(numbers: &mut Numbers) -> Case {
    let (rows, columns) = (1 + below(numbers, 8), 1 + below(numbers, 12));
    let mut values = numbers.many(rows * columns);
    let copy = |values: &mut Vec<f64>, from: usize, to: usize, times: f64, add: bool| {
        for i in 0..rows {
            let x = times * values[from * rows + i];
            let old = values[to * rows + i];
            values[to * rows + i] = if add { old + x } else { x };
        }
    };
    if columns > 3 {
        let mut any = || below(numbers, columns);
        let (a, b, c, d, e, z) = (any(), any(), any(), any(), any(), any());
        match below(numbers, 5) {
            0 => copy(&mut values, a, b, -2.0, false),
            1 if a != c && b != c => {
                copy(&mut values, a, c, 1.0, false);
                copy(&mut values, b, c, 1.0, true);
            }
            2 => copy(&mut values, z, z, 0.0, false),
            3 if a != c && b != c && d != e => {
                copy(&mut values, a, c, 1.0, false);
                copy(&mut values, b, c, -1.0, true);
                copy(&mut values, d, e, 3.0, false);
            }
            _ => {}
        }
    }
    let mut target = vec![0.0; rows];
    for _ in 0..1 + below(numbers, 4) {
        let (j, a) = (below(numbers, columns), 1.5 + numbers.next());
        let column = &values[j * rows..(j + 1) * rows];
        target.iter_mut().zip(column).for_each(|(y, x)| *y += a * x);
    }
    let noise = [0.0, 0.0, 1e-6, 1e-2, 0.3][below(numbers, 5)];
    target.iter_mut().for_each(|y| *y += noise * numbers.next());
    let tolerance = match below(numbers, 3) {
        0 if noise == 0.0 => 0.0,
        1 => noise * 0.5 * norm(&target),
        _ => noise * (rows as f64).sqrt(),
    };
    Case {
        dictionary: Dense::new(rows, values),
        target,
        tolerance,
    }
}

/// Every support of the smallest size that fits.
fn exhaustive(problem: &Problem) -> Vec<Vec<usize>> {
    let length = norm(problem.target);
    if length <= problem.tolerance || length == 0.0 {
        return vec![Vec::new()];
    }
    let all = Columns::new(problem);
    let sets = 0..1_usize << all.count();
    let members = |bits: usize| (0..all.count()).filter(|j| bits >> j & 1 == 1).collect();
    let sets: Vec<Vec<usize>> = sets.map(members).collect();
    let fitting: Vec<&Vec<usize>> = sets.iter().filter(|s| all.fits(s)).collect();
    let least = fitting.iter().map(|s| s.len()).min();
    let smallest = fitting.iter().filter(|s| Some(s.len()) == least);
    let mut found: Vec<Vec<usize>> = smallest.map(|s| all.named(s)).collect();
    found.sort();
    found
}

fn all_found(found: &Sparsest) -> Vec<Vec<usize>> {
    let mut all: Vec<Vec<usize>> = found.support.iter().chain(&found.others).cloned().collect();
    all.sort();
    all
}

#[test]
fn the_sparsest_and_its_ties_are_those_of_exhaustive_search() {
    let mut numbers = Numbers(20);
    let (mut tied, mut infeasible) = (0, 0);
    for round in 0..600 {
        let case = case(&mut numbers);
        let wanted = exhaustive(&case.problem());
        let found = prove_sparsest(
            &case.problem(),
            &[],
            SparsestLimits::default(),
            &mut Unwatched,
        );
        assert_eq!(all_found(&found), wanted, "{round}: {found:?}");
        assert_eq!(found.proved(), !wanted.is_empty(), "{round}: {found:?}");
        assert!(wanted.is_empty() || found.all_others, "{round}: {found:?}");
        tied += usize::from(wanted.len() > 1);
        infeasible += usize::from(wanted.is_empty());
    }
    assert!(tied > 100 && infeasible > 10, "{tied} {infeasible}");
}
