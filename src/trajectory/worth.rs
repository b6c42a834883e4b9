//! How many readings one is worth: residuals that follow each other say the same thing many times.
//!
//! In: a problem and a fit. Out: the number of readings that count as one, 1 for white residuals. Right laws leave white ones; laws
//! that are nearly right leave a slow error, and to take its every sample for news would buy any term that bends the laws a
//! little. The variance of M values with autocorrelations ρ is known as well as that of M/(1 + 2 Σ ρ²) independent ones
//! (Bartlett, J. R. Stat. Soc. Suppl. 1946). Never judges.

use super::channel::{Channel, channels};
use super::fit::Fit;
use super::problem::Problem;

/// Memory of residuals below which they count as white, however sure it is.
const WHITE: f64 = 0.05;
/// Residual over spread under which what is left is the arithmetic's.
const CLOSE: f64 = 1e-6;
/// The sum over lags goes this many times as far as what it comes to (Sokal 1997).
const FAR: f64 = 5.0;

/// Readings that count as one, over all channels: the readings there are over those they are worth.
pub(super) fn readings_as_one(problem: &Problem, fit: &Fit) -> f64 {
    let (mut all, mut worth) = (0.0, 0.0);
    for channel in channels(problem, fit) {
        let m = channel.readings as f64;
        all += m;
        worth += m / time(problem, fit, &channel);
    }
    if worth > 0.0 { all / worth } else { 1.0 }
}

fn time(problem: &Problem, fit: &Fit, channel: &Channel) -> f64 {
    let white = channel.memory.abs() <= channel.chance.max(WHITE);
    if white || channel.left < CLOSE * channel.spread {
        return 1.0;
    }
    let Some(state) = problem.system.state(channel.signal) else {
        return 1.0;
    };
    let residuals = residuals(problem, fit, state);
    let total: f64 = residuals.iter().flatten().map(|x| x * x).sum();
    let longest = residuals.iter().map(Vec::len).max().unwrap_or(0);
    let mut sum = 1.0;
    for lag in 1..longest {
        if lag as f64 > FAR * sum {
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

/// Residuals of a state's readings, record by record; 0 where there is none.
fn residuals(problem: &Problem, fit: &Fit, state: usize) -> Vec<Vec<f64>> {
    let n = problem.states();
    let records = problem.records.iter().zip(fit.paths());
    records
        .map(|(record, path)| {
            let read = record.measured[state].iter().enumerate();
            read.map(|(k, y)| y - path[k * n + state])
                .map(|x| if x.is_finite() { x } else { 0.0 })
                .collect()
        })
        .collect()
}
