//! How well the laws of the measured states follow their readings, with guessed courses of the hidden states.
//!
//! In: the measured part. Out: its best columns with coefficients, and a criterion by which guesses compare. Follows no trajectory.

use crate::trajectory::likelihood::final_floor;
use crate::trajectory::model::Problem;
use crate::trajectory::search::final_criterion;
use crate::trajectory::thresholds::SEARCH;
use sidc_progress::Observer;

/// The best columns of a measured part.
#[derive(Clone, Debug)]
pub(super) struct ObservedFit {
    /// −2 log likelihood of the integrals, and the price of the columns.
    pub value: f64,
    /// Columns with coefficients, rising.
    pub terms: Vec<(usize, f64)>,
    /// How much each of them moves the laws, in standard deviations of the readings.
    pub strengths: Vec<f64>,
}

/// Selects columns on the integrals of the laws between samples: one fit for each slack of a first linearisation, each set of columns to select
/// from, and each price, in this order, so that fits of different guesses compare pairwise. Fewer if the observer ends the work, or a column is
/// not finite.
pub(super) fn observed_fits(
    problem: &Problem,
    sets: &[Vec<usize>],
    observer: &mut dyn Observer,
) -> Vec<ObservedFit> {
    let floor = final_floor(problem);
    let sigma: Vec<f64> = (problem.noise.iter().zip(&floor))
        .map(|(noise, floor)| noise.max(*floor))
        .collect();
    let readings = problem.measurements() as f64;
    let penalty = final_criterion(problem).penalty;
    let mut fits: Vec<ObservedFit> = Vec::new();
    for slack in SEARCH.initial_slacks {
        let Some(form) = problem.integral_matching_form(&sigma, slack, observer) else {
            return fits;
        };
        for columns in sets {
            let some = form.of_columns(columns);
            let all: Vec<usize> = (0..some.p).collect();
            let least = some.least_squares(&all).square.max(0.0) / readings;
            if !least.is_finite() {
                return fits;
            }
            let prices = SEARCH.initial_prices.map(|p| p * penalty * least.max(1.0));
            let supports = some.backward_elimination(&prices).into_iter().zip(prices);
            fits.extend(supports.map(|(support, price)| {
                let support = some.steepest_descent(&support, price);
                let fit = some.least_squares(&support);
                let left = (fit.square.max(0.0) / readings).max(f64::MIN_POSITIVE);
                let size = |j: usize| some.row(j)[j].max(0.0).sqrt();
                let pairs = || support.iter().zip(&fit.coefficients);
                ObservedFit {
                    value: readings * left.ln() + penalty * support.len() as f64,
                    strengths: pairs().map(|(j, a)| a.abs() * size(*j)).collect(),
                    terms: pairs().map(|(j, a)| (columns[*j], *a)).collect(),
                }
            }));
        }
    }
    fits
}

/// One set of all columns, to select from.
pub(super) fn every_column(problem: &Problem) -> [Vec<usize>; 1] {
    [(0..problem.system.columns.len()).collect()]
}

/// The fits of the measured part with the present courses of the hidden states, in columns of the whole problem.
pub(super) fn observed(problem: &Problem, observer: &mut dyn Observer) -> Vec<ObservedFit> {
    let system = &problem.system;
    let columns = |law: usize| {
        let own = system.laws[law].columns.clone();
        own.map(|j| (Some(j), system.columns[j].clone())).collect()
    };
    let mut part = problem.observed_part(&columns);
    let n = problem.states();
    for (i, signal) in system.states.iter().enumerate() {
        if system.is_hidden(i) {
            let values: Vec<Vec<f64>> = (problem.smoothed.iter())
                .map(|c| c.states.iter().skip(i).step_by(n).copied().collect())
                .collect();
            part.problem
                .set_exogenous(*signal, values.iter().map(Vec::as_slice));
        }
    }
    let whole = |(j, a): (usize, f64)| Some((part.origin[j]?, a));
    let sets = every_column(&part.problem);
    let fits = observed_fits(&part.problem, &sets, observer).into_iter();
    fits.map(|fit| ObservedFit {
        terms: fit.terms.into_iter().filter_map(whole).collect(),
        ..fit
    })
    .collect()
}
