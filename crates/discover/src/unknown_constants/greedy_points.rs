//! A quick look at many values of the constants: how well a few terms describe the targets there, chosen greedily.
//!
//! In: the equations with their rows, values. Out: the values at local minima of the criterion, the least first. Refines nothing.
//!
//! Basis pursuit over the ranges can spread a term over columns of many others, so that the right value is proposed by none. At the right
//! values themselves a few terms explain far more than elsewhere. Orthogonal matching pursuit (Pati, Rezaiifar and Krishnaprasad 1993) shows
//! that at the price of a few products with Φ a point.

use super::maxima::Grid;
use super::profile::{Profile, ProfiledEquation};
use super::thresholds::GREEDY;
use crate::dictionary::compile;
use sidc_data::Samples;
use sidc_progress::Observer;
use sidc_solve::threads::{self, map_watched};
use sidc_solve::{Omp, Problem};

/// At most `greedy.minima` of the points.
pub(super) fn minima(
    profile: &Profile,
    points: &[Vec<f64>],
    observer: &mut dyn Observer,
) -> Vec<Vec<f64>> {
    let ranked = ranked(profile, points.to_vec(), observer);
    let grid = Grid::new(&ranked);
    let is_minimum = |p: &usize| !(0..*p).any(|better| grid.adjacent(better, *p));
    let minima = (0..ranked.len()).filter(is_minimum);
    minima
        .take(GREEDY.minima)
        .map(|p| ranked[p].clone())
        .collect()
}

/// The points at which the terms have values, those of the least criterion first.
pub(super) fn ranked(
    profile: &Profile,
    points: Vec<Vec<f64>>,
    observer: &mut dyn Observer,
) -> Vec<Vec<f64>> {
    let judged = |values: Vec<f64>, observer: &mut dyn Observer| {
        if !observer.go_on() {
            return None;
        }
        let samples = profile.samples_at(&values);
        let each = profile.equations.iter().map(|e| criterion(e, &samples));
        let whole: Option<f64> = each.sum();
        Some((whole?, values))
    };
    let seen = map_watched(threads::available(), points, observer, judged);
    let mut seen: Vec<(f64, Vec<f64>)> = seen.into_iter().flatten().collect();
    seen.sort_by(|a, b| a.0.total_cmp(&b.0));
    seen.into_iter().map(|(_, values)| values).collect()
}

/// The least criterion of an equation along its greedy path; `None` where a term has no value.
fn criterion(equation: &ProfiledEquation, samples: &Samples) -> Option<f64> {
    let target = equation.target_values(samples)?;
    let phi = compile(&equation.library, samples, Some(&equation.row)).ok()?;
    let problem = Problem {
        dictionary: phi.as_ref(),
        target: &target,
        tolerance: 0.0,
    };
    let residuals = Omp::residuals(&problem, GREEDY.terms);
    let path = residuals.iter().enumerate();
    path.map(|(terms, left)| equation.criterion.value(left * left, terms))
        .min_by(f64::total_cmp)
}
