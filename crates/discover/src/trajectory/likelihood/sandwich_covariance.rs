//! Variances of a fit's coefficients by the sandwich formula (Huber 1967; White 1982).
//!
//! In: a problem and a fit. Out: the fit's variances. The laws may slip a little in a fit, but right laws do not: their rows weigh in the
//! estimate and add nothing to its errors. With A_r the rows of the readings, A those of all, and C = (AᵀA)⁻¹, errors e move the
//! estimate by C A_rᵀ e, so its covariance is C A_rᵀ S A_r C. S, the covariance of the errors, is diagonal where residuals are white, else
//! that of an autoregression. Under constraints C is the covariance of the coefficients that they leave free.

use super::eliminated_records::EliminatedRecords;
use super::fitted_support::Fit;
use crate::trajectory::integration::CompiledLaws;
use crate::trajectory::least_squares::{IncrementalQr, constrained_covariances};
use crate::trajectory::model::Problem;
use crate::trajectory::thresholds::RESIDUALS;
use sidc_progress::Observer;
use sidc_solve::{Autoregression, WeightedSum};

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
    let eliminated =
        EliminatedRecords::new((problem, &code), &fit.point, &mut qr, observer).ok()?;
    let memories: Vec<Autoregression> = (0..problem.states())
        .map(|i| Autoregression::fit(&whitened_residuals(problem, fit, i)))
        .collect();
    let rows = problem.system.constraints.on(fit.support());
    let covariances = constrained_covariances(&mut qr, fit.coefficients(), &rows);
    let known: Vec<&Vec<f64>> = covariances.iter().flatten().collect();
    let mut sums = vec![0.0; known.len()];
    for r in 0..problem.records.len() {
        let of_record = variances_of_record(
            (problem, fit),
            &eliminated,
            (r, &memories),
            &known,
            observer,
        )?;
        sums.iter_mut()
            .zip(of_record)
            .for_each(|(sum, x)| *sum += x);
    }
    let scarce = degrees_of_freedom_factor(problem, fit);
    let mut sums = sums.into_iter();
    let mut of = |c: &Option<Vec<f64>>| match c {
        Some(_) => scarce * sums.next().unwrap_or(f64::INFINITY),
        None => f64::INFINITY,
    };
    Some(covariances.iter().map(&mut of).collect())
}

/// The response of a coefficient's estimate to the readings, accumulated backwards along a record.
struct Response<'a> {
    /// Its column of C.
    column: &'a Vec<f64>,
    /// Response of the states at the sample after the present one.
    after: Vec<f64>,
    /// For each state the weighted sum of its readings' errors.
    sums: Vec<WeightedSum<'a>>,
    /// For each state the weight of its next reading: what is new in that error is known once the present reading's weight is.
    behind: Vec<Option<f64>>,
}

/// What the errors of a record's readings add to the variance of each coefficient; `columns` are those of C, one for each coefficient. One
/// backward sweep serves all, so that no response is stored.
fn variances_of_record(
    (problem, fit): (&Problem, &Fit),
    eliminated: &EliminatedRecords,
    (r, memories): (usize, &[Autoregression]),
    columns: &[&Vec<f64>],
    observer: &mut dyn Observer,
) -> Option<Vec<f64>> {
    let (n, record) = (problem.states(), &problem.records[r]);
    let rms = |sensor: usize| residual_rms(problem, fit, sensor) / fit.sigma()[sensor].powi(2);
    let weights: Vec<f64> = problem.sensors.of(r).map(rms).collect();
    let sums = || memories.iter().map(Autoregression::weighted_sum).collect();
    let start = |column| Response {
        column,
        after: vec![0.0; n],
        sums: sums(),
        behind: vec![None; n],
    };
    let mut all: Vec<Response> = columns.iter().copied().map(start).collect();
    let back = eliminated.backward(r, observer, &mut |samples, rows| {
        for of in &mut all {
            let response = rows.response(of.column, &of.after);
            of.after.copy_from_slice(&response[..n]);
            for (k, states) in samples.clone().zip(response.chunks_exact(n)).rev() {
                for (i, z) in states.iter().enumerate() {
                    let here = match record.measured[i][k].is_finite() {
                        true => z * weights[i] / record.relative_noise_at(i, k),
                        false => 0.0,
                    };
                    if let Some(next) = of.behind[i].replace(here) {
                        of.sums[i].add(record.new_at(i, k + 1, (here, next)));
                    }
                }
            }
        }
    });
    back.ok()?;
    for of in &mut all {
        let first = of.sums.iter_mut().zip(&of.behind);
        first.for_each(|(sum, x)| sum.add(x.unwrap_or(0.0)));
    }
    let variance = |sums: Vec<WeightedSum>| sums.into_iter().map(WeightedSum::variance).sum();
    Some(all.into_iter().map(|of| variance(of.sums)).collect())
}

/// Root mean square of a sensor's residuals, each over its relative noise. It replaces the noise of the fit, which a floor or uninformative
/// readings may enlarge: that is a weight, no error. It is at least a part of that noise, since the fit is no more accurate than the noise
/// required.
fn residual_rms(problem: &Problem, fit: &Fit, sensor: usize) -> f64 {
    let mean = fit.residual_squares[sensor] / problem.readings[sensor].max(1) as f64;
    mean.sqrt().max(RESIDUALS.min_noise * fit.sigma()[sensor])
}

/// M/(M − p): fitting p coefficients and first states to the M readings makes residuals smaller than the noise.
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
