//! The effective sample size of coloured residuals.
//!
//! In: a problem and a fit. Out: the statistical inefficiency, the number of readings that count as one independent one; 1 for white
//! residuals. Laws that are nearly right leave an error that varies slowly. If each of its samples counted as independent, any term that changes the
//! laws a little would seem to be significant. The variance of M values with autocorrelations ρ is known as well as that of M/(1 + 2 Σ ρ²) independent ones
//! (Bartlett, J. R. Stat. Soc. Suppl. 1946).

use super::channels::{Channel, channels};
use crate::trajectory::likelihood::Fit;
use crate::trajectory::model::Problem;
use crate::trajectory::thresholds::RESIDUALS;

/// Readings over effective readings, of all channels together.
pub(crate) fn statistical_inefficiency(problem: &Problem, fit: &Fit) -> f64 {
    let (mut all, mut effective) = (0.0, 0.0);
    for channel in channels(problem, fit) {
        let m = channel.readings as f64;
        all += m;
        effective += m / inefficiency_of_channel(problem, fit, &channel);
    }
    if effective > 0.0 {
        all / effective
    } else {
        1.0
    }
}

fn inefficiency_of_channel(problem: &Problem, fit: &Fit, channel: &Channel) -> f64 {
    let white = channel.autocorrelation.abs() <= channel.white_noise_bound.max(RESIDUALS.white);
    if white || channel.residual < RESIDUALS.arithmetic * channel.spread {
        return 1.0;
    }
    let Some(state) = problem.system.state_index(channel.signal) else {
        return 1.0;
    };
    let of = |r: usize| -> Vec<f64> {
        let left = fit.whitened(problem, r, state).into_iter();
        left.map(|x| if x.is_finite() { x } else { 0.0 }).collect()
    };
    let residuals: Vec<Vec<f64>> = (0..problem.records.len()).map(of).collect();
    let total: f64 = residuals.iter().flatten().map(|x| x * x).sum();
    let longest = residuals.iter().map(Vec::len).max().unwrap_or(0);
    let mut sum = 1.0;
    for lag in 1..longest {
        if lag as f64 > RESIDUALS.lag_window * sum {
            break;
        }
        let pairs = residuals
            .iter()
            .flat_map(|r| r.iter().zip(r.iter().skip(lag)));
        let correlation = pairs.map(|(a, b)| a * b).sum::<f64>() / total;
        sum += 2.0 * correlation * correlation;
    }
    if sum.is_finite() { sum } else { 1.0 }
}
