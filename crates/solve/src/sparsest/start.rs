//! A sparse fit to begin with, by greedy steps.
//!
//! In: columns, supports that others found. Out: the smallest fit that dropping and greedy addition reach. Proves nothing.

use sidc_progress::{Activity, Observer, Stage};

use super::columns::{Columns, project_off};
use crate::linalg::dot_in_lanes;
use crate::problem::Problem;
use crate::solver::Solver;
use crate::solvers::Homotopy;
use crate::thresholds::{NUMERICAL_RANK, SPARSEST};

/// A support that fits.
pub(super) struct Start {
    pub support: Vec<usize>,
    /// Largest |a_j|‖φ_j‖/‖y‖ of its least squares.
    pub largest_share: f64,
}

/// The smallest fit among those reached from the known supports, from the minimum of the 1-norm and from nothing.
pub(super) fn sparse_start(
    problem: &Problem,
    all: &Columns,
    known: &[Vec<usize>],
    observer: &mut dyn Observer,
) -> Option<Start> {
    let place = |j: &usize| all.kept.binary_search(j).ok();
    let mut tried: Vec<Vec<usize>> = Vec::new();
    for support in known {
        tried.push(support.iter().filter_map(place).collect());
    }
    let proving = Activity::Stage(Stage::Proving { terms: 1, nodes: 0 });
    let mut observer = |_: Activity| observer.hear(proving);
    let solution = Homotopy.solve(problem, &mut observer);
    let mut proposed: Vec<(usize, f64)> = problem
        .contributions(&solution.coefficients)
        .zip(&solution.coefficients)
        .filter_map(|(share, (j, _))| Some((place(j)?, share)))
        .collect();
    proposed.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    proposed.truncate(SPARSEST.start_terms);
    tried.push(proposed.into_iter().map(|(j, _)| j).collect());
    tried.push(greedy(all, &mut observer));
    let fits = tried.into_iter().filter(|s| all.fits(s));
    let dropped = fits.map(|s| without_needless(all, s));
    let best = dropped.min_by(|a, b| a.len().cmp(&b.len()).then_with(|| a.cmp(b)))?;
    Some(Start {
        largest_share: largest_share(all, &best),
        support: best,
    })
}

/// Orthogonal least squares: always the column that lowers the residual most.
fn greedy(all: &Columns, observer: &mut dyn Observer) -> Vec<usize> {
    let mut columns = all.values.clone();
    let mut target = all.target.clone();
    let mut support: Vec<usize> = Vec::new();
    while dot_in_lanes::<8, f64>(&target, &target) > all.square
        && support.len() < SPARSEST.start_terms
        && observer.go_on()
    {
        let gain = |j: usize| {
            let column = &columns[j * all.rows..(j + 1) * all.rows];
            let length = dot_in_lanes::<8, f64>(column, column);
            let usable = length > NUMERICAL_RANK.dependent && !support.contains(&j);
            usable.then(|| dot_in_lanes::<8, f64>(column, &target).powi(2) / length)
        };
        let gains = (0..all.count()).filter_map(|j| Some((j, gain(j)?)));
        let Some((best, _)) = gains.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0))) else {
            break;
        };
        let mut direction = columns[best * all.rows..(best + 1) * all.rows].to_vec();
        let length = dot_in_lanes::<8, f64>(&direction, &direction).sqrt();
        direction.iter_mut().for_each(|x| *x /= length);
        for column in columns.chunks_exact_mut(all.rows) {
            project_off(column, &direction);
        }
        project_off(&mut target, &direction);
        support.push(best);
    }
    support
}

/// Drops the column that matters least, as long as what is left fits.
fn without_needless(all: &Columns, mut support: Vec<usize>) -> Vec<usize> {
    loop {
        let without = |i: usize| -> Vec<usize> {
            let others = support.iter().enumerate().filter(|(k, _)| *k != i);
            others.map(|(_, j)| *j).collect()
        };
        let smaller = (0..support.len()).map(|i| {
            let smaller = without(i);
            (all.residual_square(&smaller), smaller)
        });
        match smaller.min_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((square, smaller)) if square <= all.square => support = smaller,
            _ => {
                support.sort_unstable();
                return support;
            }
        }
    }
}

/// The largest coefficient of least squares.
fn largest_share(all: &Columns, support: &[usize]) -> f64 {
    let share = |i: usize| {
        let others: Vec<usize> = support
            .iter()
            .copied()
            .filter(|j| *j != support[i])
            .collect();
        let (mut column, mut target) = (all.column(support[i]).to_vec(), all.target.clone());
        for d in all.directions(&others) {
            project_off(&mut column, &d);
            project_off(&mut target, &d);
        }
        let length = dot_in_lanes::<8, f64>(&column, &column);
        match length > 0.0 {
            true => (dot_in_lanes::<8, f64>(&column, &target) / length).abs(),
            false => 0.0,
        }
    };
    (0..support.len()).map(share).fold(0.0, f64::max)
}
