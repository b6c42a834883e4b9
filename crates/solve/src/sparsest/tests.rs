//! The proved sparsest support against every support there is.

use std::ops::ControlFlow;

use sidc_progress::{Activity, Stop, Unwatched};
use sidc_random::Numbers;

use super::columns::Columns;
use super::{Sparsest, SparsestLimits, fits, prove_sparsest};
use crate::dictionary::Dense;
use crate::linalg::norm;
use crate::planted::planted;
use crate::problem::Problem;
use crate::solver::Solver;
use crate::solvers::Homotopy;

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

/// Ends a search after so many calls.
fn ends_after(calls: usize) -> impl FnMut(Activity) -> ControlFlow<Stop> {
    let mut heard = 0;
    move |_: Activity| {
        heard += 1;
        match heard > calls {
            true => ControlFlow::Break(Stop::Interrupted),
            false => ControlFlow::Continue(()),
        }
    }
}

#[test]
fn a_search_that_is_ended_has_a_true_bound() {
    let mut numbers = Numbers(77);
    let (mut open, mut tried) = (0, 0);
    for round in 0..100 {
        let case = case(&mut numbers);
        let wanted = exhaustive(&case.problem());
        let least = wanted.first().map_or(usize::MAX, Vec::len);
        for calls in 0..12 {
            let limits = SparsestLimits::default();
            let found = prove_sparsest(&case.problem(), &[], limits, &mut ends_after(calls));
            assert!(found.lower <= least, "{round} {calls}: {found:?}");
            if let Some(support) = &found.support {
                assert!(support.len() >= least && fits(&case.problem(), support));
                // What is claimed is so, wherever the end came.
                assert!(!found.proved() || support.len() == least, "{found:?}");
            }
            if found.all_others {
                assert_eq!(all_found(&found), wanted, "{round} {calls}");
            }
            open += usize::from(!found.proved());
            tried += 1;
        }
    }
    assert!(open > 100 && open < tried, "{open} of {tried}");
}

/// Φ with five planted columns among sixteen, exact: sizes at which cuts and branches do the work.
#[test]
fn larger_supports_are_found_and_limits_of_nodes_hold() {
    let mut numbers = Numbers(5);
    for (rows, noise) in [(40, 0.0), (40, 0.05), (14, 0.0), (9, 0.0)] {
        let (dictionary, mut target) = planted(&mut numbers, (rows, 16), &[1, 4, 7, 10, 13], 1.5);
        target.iter_mut().for_each(|y| *y += noise * numbers.next());
        let problem = Problem {
            dictionary: &dictionary,
            target: &target,
            tolerance: noise * (rows as f64).sqrt(),
        };
        let wanted = exhaustive(&problem);
        let found = prove_sparsest(&problem, &[], SparsestLimits::default(), &mut Unwatched);
        assert!(found.proved() && found.all_others, "{found:?}");
        assert_eq!(all_found(&found), wanted);
        let limits = SparsestLimits {
            nodes: 3,
            ..SparsestLimits::default()
        };
        let cut = prove_sparsest(&problem, &[], limits, &mut Unwatched);
        assert!(cut.lower <= found.lower, "{cut:?}");
    }
}

#[test]
fn the_minimum_of_the_one_norm_is_not_always_the_sparsest() {
    // y = 3 φ₀ + 3 φ₁ with nearly opposite columns: φ₂, φ₃, φ₄ reach y with a smaller 1-norm.
    let mut values = Vec::new();
    for column in [
        [1.0, 0.1, 0.0, 0.0],
        [-1.0, 0.1, 0.2, 0.1],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 0.0, 1.0],
    ] {
        values.extend(column);
    }
    let dictionary = Dense::new(4, values);
    let target = [0.0, 0.6, 0.6, 0.3];
    let problem = Problem {
        dictionary: &dictionary,
        target: &target,
        tolerance: 0.0,
    };
    let l1 = Homotopy.solve(&problem, &mut Unwatched);
    assert_eq!(l1.coefficients.len(), 3);
    let found = prove_sparsest(&problem, &[], SparsestLimits::default(), &mut Unwatched);
    assert_eq!(found.support, Some(vec![0, 1]));
    assert!(found.proved() && found.all_others && found.others.is_empty());
}

#[test]
fn what_cannot_be_searched_is_said() {
    let dictionary = Dense::new(2, vec![1.0, 0.0, 1.0, 1.0]);
    let with = |target: &[f64], tolerance: f64, memory: u64| {
        let problem = Problem {
            dictionary: &dictionary,
            target,
            tolerance,
        };
        let limits = SparsestLimits {
            memory,
            ..SparsestLimits::default()
        };
        prove_sparsest(&problem, &[vec![7]], limits, &mut Unwatched)
    };
    let small = with(&[1.0, 2.0], 0.0, 100);
    assert!(
        small
            .refused
            .is_some_and(|r| r.contains("2 columns on 2 rows"))
    );
    assert!(with(&[f64::NAN, 1.0], 0.0, u64::MAX).refused.is_some());
    let nothing = with(&[0.0, 0.0], 0.0, u64::MAX);
    assert_eq!(
        (nothing.support.clone(), nothing.proved()),
        (Some(Vec::new()), true)
    );
    assert_eq!(with(&[1.0, 2.0], 3.0, u64::MAX).support, Some(Vec::new()));
    assert_eq!(with(&[1.0, 2.0], 0.0, u64::MAX).support, Some(vec![0, 1]));
}

/// Rounds of several nodes on several cores, and one node after the other, are the same search.
#[test]
fn the_same_problem_gives_the_same_answer_to_the_last_node() {
    let mut numbers = Numbers(31);
    let (dictionary, target) = planted(&mut numbers, (12, 60), &[3, 20, 40, 55], 1.5);
    let problem = Problem {
        dictionary: &dictionary,
        target: &target,
        tolerance: 0.0,
    };
    let run = || prove_sparsest(&problem, &[], SparsestLimits::default(), &mut Unwatched);
    let first = run();
    assert_eq!(first, run());
    assert_eq!(first.support, Some(vec![3, 20, 40, 55]));
    assert!(
        first.proved() && first.all_others && first.others.is_empty(),
        "{first:?}"
    );
}

/// Too many columns for dual bases: the last three are enumerated, which proves sizes up to four where one of four is known.
#[test]
fn without_dual_bases_small_supports_are_proved() {
    let mut numbers = Numbers(41);
    let (dictionary, target) = planted(&mut numbers, (20, 150), &[3, 70, 149], 1.5);
    let problem = Problem {
        dictionary: &dictionary,
        target: &target,
        tolerance: 0.0,
    };
    let run = |memory: u64| {
        let limits = SparsestLimits {
            memory,
            ..SparsestLimits::default()
        };
        prove_sparsest(&problem, &[], limits, &mut Unwatched)
    };
    let (few, all) = (run(400_000), run(u64::MAX));
    assert_eq!(
        (few.refused.clone(), few.support.clone()),
        (None, Some(vec![3, 70, 149]))
    );
    assert!(
        few.proved() && few.all_others && few.others.is_empty(),
        "{few:?}"
    );
    assert_eq!((all.support, all.lower), (few.support, few.lower));
}

/// Columns of small whole numbers, some of which differ from others by 2⁻²⁴ v, and a target of some columns and of such a v: it is
/// fitted without any rounding by terms 2²⁴ times as large. A bound that excludes that fit has to say so.
#[test]
fn terms_that_rounding_cannot_decide_are_beyond_the_assumption() {
    let mut numbers = Numbers(9);
    let mut large = 0;
    for round in 0..400 {
        let (rows, columns) = (8 + below(&mut numbers, 6), 7 + below(&mut numbers, 4));
        let mut values = numbers.many(rows * columns);
        values.iter_mut().for_each(|x| *x = (8.0 * *x).round());
        let mut target = vec![0.0; rows];
        let mut planted = Vec::new();
        for pair in 0..2 {
            let (from, to) = (2 * pair, 2 * pair + 1);
            for i in 0..rows {
                let v = (4.0 * numbers.next()).round();
                values[to * rows + i] = values[from * rows + i] + v * 2.0_f64.powi(-24);
                if pair == 0 {
                    target[i] += v;
                }
            }
            planted.extend([from, to]);
        }
        planted.truncate(2);
        for j in 4..6 {
            let column = &values[j * rows..(j + 1) * rows];
            target.iter_mut().zip(column).for_each(|(y, x)| *y += x);
            planted.push(j);
        }
        let share = 2.0_f64.powi(24) * norm(&values[..rows]) / norm(&target);
        let dictionary = Dense::new(rows, values);
        let problem = Problem {
            dictionary: &dictionary,
            target: &target,
            tolerance: 0.0,
        };
        let limits = SparsestLimits::default();
        let found = prove_sparsest(&problem, &[], limits, &mut Unwatched);
        let excluded = found.lower > planted.len();
        assert!(
            !excluded || share > found.largest_share,
            "{round}: {share} {found:?}"
        );
        let least = found.support.as_ref().map_or(usize::MAX, Vec::len);
        assert!(found.lower <= least, "{round}: {found:?}");
        large += usize::from(excluded);
    }
    assert!(large > 0, "no case of this kind");
}
