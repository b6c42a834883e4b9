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

/// Selects columns on the integrals of the laws between samples: one fit for each slack and price of a first linearisation, always in the
/// same order, so that fits of different guesses can be compared one by one. Fewer where the observer ends the work, or a column is not
/// finite.
pub(super) fn observed_fits(problem: &Problem, observer: &mut dyn Observer) -> Vec<ObservedFit> {
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
        let all: Vec<usize> = (0..form.p).collect();
        let least = form.least_squares(&all).square.max(0.0) / readings;
        if !least.is_finite() {
            return fits;
        }
        let prices = SEARCH.initial_prices.map(|p| p * penalty * least.max(1.0));
        let supports = form.backward_elimination(&prices).into_iter().zip(prices);
        for (support, price) in supports {
            let support = form.steepest_descent(&support, price);
            let fit = form.least_squares(&support);
            let left = (fit.square.max(0.0) / readings).max(f64::MIN_POSITIVE);
            let strength = |(j, a): (&usize, &f64)| a.abs() * form.row(*j)[*j].max(0.0).sqrt();
            fits.push(ObservedFit {
                value: readings * left.ln() + penalty * support.len() as f64,
                strengths: support
                    .iter()
                    .zip(&fit.coefficients)
                    .map(strength)
                    .collect(),
                terms: support.into_iter().zip(fit.coefficients).collect(),
            });
        }
    }
    fits
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
                .set_exogenous(*signal, false, values.iter().map(Vec::as_slice));
        }
    }
    let whole = |(j, a): (usize, f64)| Some((part.origin[j]?, a));
    let fits = observed_fits(&part.problem, observer).into_iter();
    fits.map(|fit| ObservedFit {
        terms: fit.terms.into_iter().filter_map(whole).collect(),
        ..fit
    })
    .collect()
}
