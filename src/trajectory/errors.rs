//! Variances of a fit's coefficients: what the noise of the readings does to them.
//!
//! In: a problem and a fit. Out: the fit's variances. The fit lets the laws slip a little from sample to sample; right laws do not, so the
//! rows of the laws weigh in the estimate but add nothing to its errors. With the rows A_r of the readings and A of all, the
//! coefficients and states move by C A_rᵀ e for errors e, C = (AᵀA)⁻¹, and their covariance is C A_rᵀ S A_r C with S that of the errors
//! (the sandwich of Huber 1967 and White 1982). S is diagonal where residuals are white, else as their memory has it.

use super::code::Code;
use super::fit::Fit;
use super::guide::GoOn;
use super::problem::Problem;
use super::record::Record;
use super::triangle::Triangle;
use crate::solve::Memory;

/// Residuals smaller than this part of the noise that the fit went by may be cut off by its arithmetic, which is as fine as that asks for.
const ARITHMETIC: f64 = 0.1;

/// Sets the variances; those of the fit stay where its laws lead nowhere, or `go_on` gave it up.
pub(super) fn judge(problem: &Problem, fit: &mut Fit, go_on: GoOn) {
    if let Some(variances) = variances(problem, fit, go_on) {
        fit.variances = variances;
    }
}

fn variances(problem: &Problem, fit: &Fit, go_on: GoOn) -> Option<Vec<f64>> {
    let code = Code::new(&problem.system, fit.support());
    let mut triangle = Triangle::new(fit.support().len());
    let eliminated = problem
        .eliminate_all(&code, &fit.point, &mut triangle, go_on)
        .ok()?;
    let n = problem.states();
    let memories: Vec<Memory> = (0..n)
        .map(|i| Memory::of(&residuals(problem, fit, i)))
        .collect();
    let variance = |covariances: &Vec<f64>| {
        let mut sum = 0.0;
        for (r, (record, eliminated)) in problem.records.iter().zip(&eliminated).enumerate() {
            let response = eliminated.response(covariances);
            let sensors = problem.sensors.of(r);
            for ((i, memory), sensor) in memories.iter().enumerate().zip(sensors) {
                let states = response.iter().skip(i).step_by(n);
                let read = record.measured[i].iter().zip(states);
                let weight = size(problem, fit, sensor) / fit.sigma()[sensor].powi(2);
                let weights = read.map(|(y, z)| if y.is_finite() { z * weight } else { 0.0 });
                sum += memory.square(&weights.collect::<Vec<_>>());
            }
        }
        sum
    };
    let scarce = scarce(problem, fit);
    let of = |c: &Option<Vec<f64>>| c.as_ref().map_or(f64::INFINITY, |c| scarce * variance(c));
    Some(triangle.covariances().iter().map(of).collect())
}

/// Root mean square of a sensor's residuals. The noise that the fit went by is larger where it was held above a floor, or readings are
/// little news; that is its weight in the estimate, not its error.
fn size(problem: &Problem, fit: &Fit, sensor: usize) -> f64 {
    let mean = fit.squares[sensor] / problem.readings[sensor].max(1) as f64;
    mean.sqrt().max(ARITHMETIC * fit.sigma()[sensor])
}

/// M/(M − p): residuals are smaller than the noise for the p coefficients and first states that were fitted to them.
fn scarce(problem: &Problem, fit: &Fit) -> f64 {
    let readings = problem.measurements() as f64;
    let fitted = fit.support().len() + problem.states() * problem.records.len();
    readings / (readings - fitted as f64).max(1.0)
}

/// Residuals of a state's readings over their sensor's noise, record by record; 0 where there is none.
fn residuals(problem: &Problem, fit: &Fit, state: usize) -> Vec<Vec<f64>> {
    let n = problem.states();
    let records = problem.records.iter().zip(fit.paths()).enumerate();
    let of = |(r, (record, path)): (usize, (&Record, &Vec<f64>))| {
        let sigma = fit.sigma()[problem.sensors.of(r).start + state];
        let read = record.measured[state].iter().enumerate();
        let left = read.map(|(k, y)| (y - path[k * n + state]) / sigma);
        left.map(|x| if x.is_finite() { x } else { 0.0 }).collect()
    };
    records.map(of).collect()
}
