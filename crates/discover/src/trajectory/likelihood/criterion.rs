//! The criterion by which supports are compared: a penalised likelihood with a floor under the noise.
//!
//! In: residuals and a support. Out: one number, the smaller the better. Fits nothing.

use super::thresholds::CRITERION;
use crate::trajectory::model::{LinearizationPoint, Problem};
use crate::trajectory::thresholds::SEARCH;

/// Noise of each sensor below which a closer fit is no evidence, in the end.
pub(crate) fn final_floor(problem: &Problem) -> Vec<f64> {
    let least = SEARCH.floors.iter().copied().fold(f64::INFINITY, f64::min);
    PenalizedLikelihood::new(problem, least, 0.0).floor
}

/// −2 log likelihood + price · terms.
#[derive(Clone, Debug)]
pub(crate) struct PenalizedLikelihood {
    /// Noise below which a closer fit is no evidence, by sensor.
    pub floor: Vec<f64>,
    /// Price of a term.
    pub penalty: f64,
}

impl PenalizedLikelihood {
    /// `floor` is in units of each state's spread.
    pub fn new(problem: &Problem, floor: f64, penalty: f64) -> PenalizedLikelihood {
        let sensors = problem.spread.iter().cycle().zip(&problem.noise);
        let hidden = |i: usize| problem.system.is_hidden(i % problem.states());
        PenalizedLikelihood {
            floor: sensors
                .enumerate()
                .map(|(i, (d, s))| match hidden(i) {
                    // A hidden state has no sensor; its floor sets how much its law may slip, and is the same at all levels.
                    true => CRITERION.min_floor * s,
                    false => (floor * d).max(CRITERION.min_floor * s),
                })
                .collect(),
            penalty,
        }
    }

    /// With the price of a term by the number of independent readings: readings over `inefficiency`.
    pub fn at_floor(problem: &Problem, floor: f64, inefficiency: f64) -> PenalizedLikelihood {
        let readings = problem.measurements() as f64 / inefficiency;
        PenalizedLikelihood::new(problem, floor, inefficiency * term_price(readings))
    }

    /// Noise of each sensor, at least the floor.
    pub fn above_floor(&self, noise: &[f64]) -> Vec<f64> {
        let all = noise.iter().zip(&self.floor);
        all.map(|(noise, floor)| noise.max(*floor)).collect()
    }

    /// The price of a support. Each free coefficient costs `penalty`; coefficients that constraints fix or tie are not estimated and cost
    /// nothing. Degrees cost too, since terms of high degree are less likely. Where readings are few a term costs more, since each fitted
    /// coefficient and first state takes a degree of freedom (the correction of Hurvich & Tsai, Biometrika 1989).
    pub fn cost(&self, problem: &Problem, support: &[usize]) -> f64 {
        let written = |j: &&usize| {
            let law = &problem.system.laws[problem.system.law_of(**j)];
            law.written[**j - law.columns.start]
        };
        let readings = problem.measurements() as f64;
        let free = problem.system.constraints.free_coefficients(support);
        let fitted = free + problem.states() * problem.records.len() + 1;
        let scarce = readings / (readings - fitted as f64).max(1.0);
        let discount = CRITERION.written_discount * support.iter().filter(written).count() as f64;
        let degrees = support.iter().map(|j| problem.term(*j).degree());
        let prior = CRITERION.degree_price * degrees.sum::<f64>();
        self.penalty * free as f64 * scarce + prior - discount
    }

    /// −2 log likelihood with the noise profiled out: Σ Mᵢ ln((RSSᵢ/Mᵢ + floorᵢ²)/spreadᵢ²). Mᵢ counts informative readings only.
    pub fn deviance(&self, problem: &Problem, residual_squares: &[f64]) -> f64 {
        let channel = |i: usize| {
            let m = problem.readings[i] as f64;
            let mean = residual_squares[i] / m.max(1.0) + self.floor[i].powi(2);
            let m = m * problem.informative[i];
            m * (mean / problem.spread[i % problem.states()].powi(2)).ln()
                + problem.informative[i] * problem.log_new_variance[i]
        };
        (0..residual_squares.len()).map(channel).sum()
    }

    /// The criterion of a point, without the misfit of its laws.
    pub fn value_at(&self, problem: &Problem, point: &LinearizationPoint) -> f64 {
        self.deviance(problem, &residual_squares(problem, point))
            + self.cost(problem, &point.support)
    }

    /// The noise of sensor `i` by its residuals. It is enlarged where only a share of the readings is informative, which lowers their
    /// weight.
    pub fn noise(
        &self,
        problem: &Problem,
        residual_squares: &[f64],
        i: usize,
        before: &[f64],
    ) -> f64 {
        if problem.readings[i] == 0 {
            return before[i];
        }
        let mean = residual_squares[i] / problem.readings[i] as f64;
        mean.sqrt().max(self.floor[i]) / problem.informative[i].sqrt()
    }
}

/// Price of a term, given the number of independent readings.
pub fn term_price(readings: f64) -> f64 {
    CRITERION.term_price * readings.max(CRITERION.min_readings).ln()
}

/// Sum of squared residuals of each sensor's readings, each over its relative noise and whitened.
pub(crate) fn residual_squares(problem: &Problem, point: &LinearizationPoint) -> Vec<f64> {
    let n = problem.states();
    let mut out = vec![0.0; problem.sensors.count()];
    for (r, (record, path)) in problem.records.iter().zip(&point.paths).enumerate() {
        for (i, out) in out[problem.sensors.of(r)].iter_mut().enumerate() {
            let read = record.measured[i].iter().enumerate();
            let left =
                |(k, y): (usize, &f64)| (y - path[k * n + i]) / record.relative_noise_at(i, k);
            let left: Vec<f64> = read.map(left).collect();
            let new = record.whitened(i, &left).into_iter();
            new.filter(|x| x.is_finite()).for_each(|x| *out += x * x);
        }
    }
    out
}
