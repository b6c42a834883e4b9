//! Variances of a fit's coefficients by the sandwich formula (Huber 1967; White 1982).
//!
//! In: a problem and a fit. Out: the fit's variances. The laws may slip a little in a fit, but right laws do not: their rows weigh in the
//! estimate and add nothing to its errors. With A_r the rows of the readings, A those of all, and C = (AᵀA)⁻¹, errors e move the
//! estimate by C A_rᵀ e, so its covariance is C A_rᵀ S A_r C. S, the covariance of the errors, is diagonal where residuals are white, else
//! that of an autoregression. Under constraints C is the covariance of the coefficients that they leave free.

use super::fitted_support::Fit;
use crate::trajectory::integration::CompiledLaws;
use crate::trajectory::least_squares::{IncrementalQr, constrained_covariances};
use crate::trajectory::model::Problem;
use crate::trajectory::thresholds::RESIDUALS;
use sidc_progress::Observer;
use sidc_solve::Autoregression;

/// Sets the variances; they stay as they are if the laws diverge or the observer ends the work.
pub(crate) fn set_variances(problem: &Problem, fit: &mut Fit, observer: &mut dyn Observer) {
    // Innovations under process noise are white: the variances of the fit are right.
    if fit.point.process.is_some() {
        return;
    }
    if let Some(variances) = variances(problem, fit, observer) {
        fit.variances = variances;
    }
}

fn variances(problem: &Problem, fit: &Fit, observer: &mut dyn Observer) -> Option<Vec<f64>> {
    let code = CompiledLaws::new(&problem.system, fit.support());
    let mut qr = IncrementalQr::new(fit.support().len());
    let eliminated = problem
        .eliminate_all(&code, &fit.point, &mut qr, observer)
        .ok()?;
    let n = problem.states();
    let memories: Vec<Autoregression> = (0..n)
        .map(|i| Autoregression::fit(&whitened_residuals(problem, fit, i)))
        .collect();
    let variance = |covariances: &Vec<f64>| {
        let mut sum = 0.0;
        for (r, (record, eliminated)) in problem.records.iter().zip(&eliminated).enumerate() {
            let response = eliminated.response(covariances);
            let sensors = problem.sensors.of(r);
            for ((i, memory), sensor) in memories.iter().enumerate().zip(sensors) {
                let states = response.iter().skip(i).step_by(n);
                let read = record.measured[i].iter().zip(states).enumerate();
                let weight = residual_rms(problem, fit, sensor) / fit.sigma()[sensor].powi(2);
                let weights = read.map(|(k, (y, z))| match y.is_finite() {
                    true => z * weight / record.relative_noise_at(i, k),
                    false => 0.0,
                });
                let weights: Vec<f64> = weights.collect();
                sum += memory.variance(&record.whitened(i, &weights));
            }
        }
        sum
    };
    let scarce = degrees_of_freedom_factor(problem, fit);
    let of = |c: &Option<Vec<f64>>| c.as_ref().map_or(f64::INFINITY, |c| scarce * variance(c));
    let rows = problem.system.constraints.on(fit.support());
    let covariances = constrained_covariances(&mut qr, fit.coefficients(), &rows);
    Some(covariances.iter().map(of).collect())
}

/// Root mean square of a sensor's residuals, each over its relative noise. The noise in the fit is larger where a floor holds it, or where readings are little
/// informative: that is the sensor's weight, not its error. It may not be far smaller, since arithmetic is only as fine as the fit needs.
fn residual_rms(problem: &Problem, fit: &Fit, sensor: usize) -> f64 {
    let mean = fit.residual_squares[sensor] / problem.readings[sensor].max(1) as f64;
    mean.sqrt().max(RESIDUALS.min_noise * fit.sigma()[sensor])
}

/// M/(M − p): residuals are smaller than the noise, for p coefficients and first states were fitted to them.
fn degrees_of_freedom_factor(problem: &Problem, fit: &Fit) -> f64 {
    let readings = problem.measurements() as f64;
    let fitted = fit.support().len() + problem.states() * problem.records.len();
    readings / (readings - fitted as f64).max(1.0)
}

/// Residuals of a state over their sensor's noise, record by record; 0 where there is no reading.
fn whitened_residuals(problem: &Problem, fit: &Fit, state: usize) -> Vec<Vec<f64>> {
    let of = |r: usize| {
        let sigma = fit.sigma()[problem.sensors.of(r).start + state];
        let left = fit.whitened(problem, r, state).into_iter();
        left.map(|x| if x.is_finite() { x / sigma } else { 0.0 })
            .collect()
    };
    (0..problem.records.len()).map(of).collect()
}
