//! What a fit leaves of each channel's readings: how large, and whether one residual says anything of the next.
//!
//! In: a problem and a fit. Out: a [`Channel`] for every state that is read. White residuals of the sensor's own size are the test of
//! laws and library together: what is missing from them stays in the residuals.

use super::fit::Fit;
use super::problem::Problem;
use crate::term::Signal;

/// One channel's residuals.
#[derive(Clone, Debug)]
pub struct Channel {
    pub signal: Signal,
    /// Root mean square of the residuals, in the channel's units.
    pub left: f64,
    /// The sensor's noise, as declared or as smoothing sees it.
    pub noise: f64,
    /// Standard deviation of the channel.
    pub spread: f64,
    pub readings: usize,
    /// Σ over lags 1 … 8 of the squared autocorrelation, its root, signed by the first: 0 for white residuals.
    pub memory: f64,
    /// What chance allows `memory` to be.
    pub chance: f64,
}

/// Lags looked at.
const LAGS: usize = 8;
/// Standard deviations that chance is allowed.
const ALLOWED: f64 = 5.0;

pub fn channels(problem: &Problem, fit: &Fit) -> Vec<Channel> {
    (0..problem.states())
        .filter(|i| problem.readings[*i] > 0)
        .map(|i| channel(problem, fit, i))
        .collect()
}

/// Every channel before there is a fit: nothing is left but noise.
pub(super) fn first(problem: &Problem) -> Vec<Channel> {
    let states = 0..problem.states();
    let read = states.filter(|i| problem.readings[*i] > 0);
    read.map(|i| Channel {
        signal: problem.system.states[i],
        left: problem.noise[i],
        noise: problem.noise[i],
        spread: problem.spread[i],
        readings: problem.readings[i],
        memory: 0.0,
        chance: 0.0,
    })
    .collect()
}

fn channel(problem: &Problem, fit: &Fit, state: usize) -> Channel {
    let n = problem.states();
    let (mut sums, mut total) = ([0.0; LAGS], 0.0);
    for (record, path) in problem.records.iter().zip(fit.paths()) {
        let read = record.measured[state].iter().enumerate();
        let left: Vec<f64> = read.map(|(k, y)| y - path[k * n + state]).collect();
        let known = |x: &f64| if x.is_finite() { *x } else { 0.0 };
        total += left.iter().map(known).map(|x| x * x).sum::<f64>();
        for (lag, sum) in (1..).zip(&mut sums) {
            let pairs = left.iter().zip(left.iter().skip(lag));
            *sum += pairs.map(|(a, b)| known(a) * known(b)).sum::<f64>();
        }
    }
    let readings = problem.readings[state];
    let m = readings as f64;
    let correlation = sums.map(|s| s / total.max(f64::MIN_POSITIVE));
    let square: f64 = correlation.iter().map(|r| r * r).sum();
    // M Σ r² is about χ² of as many degrees of freedom as lags, less what the fit took.
    let lags = LAGS as f64;
    Channel {
        signal: problem.system.states[state],
        left: (total / m).sqrt(),
        noise: problem.noise[state],
        spread: problem.spread[state],
        readings,
        memory: square.sqrt().copysign(correlation[0]),
        chance: ((lags + ALLOWED * (2.0 * lags).sqrt()) / m).sqrt(),
    }
}
