//! What a fit leaves of each channel's readings: how large, and whether one residual says anything of the next.
//!
//! In: a problem and a fit. Out: a [`Channel`] for every state that is read. White residuals of the sensor's own size are the test of
//! laws and library together: what is missing from them stays in the residuals.

use super::fit::Fit;
use super::problem::Problem;
use super::strays::{Strays, strays};
use crate::solve::white::{self, LAGS};
use crate::term::Signal;

/// One channel's residuals.
#[derive(Clone, Debug)]
pub struct Channel {
    pub signal: Signal,
    /// Root mean square of the residuals, in the channel's units.
    pub left: f64,
    /// The sensor's noise, as declared or as smoothing sees it.
    pub noise: f64,
    /// Root mean square of residuals over the noise of their own file.
    pub excess: f64,
    /// Standard deviation of the channel.
    pub spread: f64,
    pub readings: usize,
    /// Root mean square of the autocorrelation over lags 1 … 8, signed by the first: 0 for white residuals, 1 at most.
    pub memory: f64,
    /// What chance allows `memory` to be, and the rounding of an encoder.
    pub chance: f64,
    /// Residuals file by file, where they differ.
    pub files: Vec<File>,
    /// Readings that noise does not explain.
    pub strays: Option<Strays>,
    /// Readings that had no weight.
    pub left_out: usize,
}

/// One trajectory's part of a channel.
#[derive(Clone, Debug)]
pub struct File {
    pub trajectory: usize,
    /// Root mean square of its residuals.
    pub left: f64,
}

/// Files whose noises differ by this factor are told apart.
const DIFFER: f64 = 1.5;

pub fn channels(problem: &Problem, fit: &Fit) -> Vec<Channel> {
    (0..problem.states())
        .filter(|i| readings(problem, *i) > 0)
        .map(|i| channel(problem, fit, i))
        .collect()
}

/// Every channel before there is a fit: nothing is left but noise.
pub(super) fn first(problem: &Problem) -> Vec<Channel> {
    let states = 0..problem.states();
    let read = states.filter(|i| readings(problem, *i) > 0);
    read.map(|i| Channel {
        signal: problem.system.states[i],
        left: noise(problem, i),
        noise: noise(problem, i),
        excess: 1.0,
        spread: problem.spread[i],
        readings: readings(problem, i),
        memory: 0.0,
        chance: 0.0,
        files: Vec::new(),
        strays: None,
        left_out: 0,
    })
    .collect()
}

/// Readings of a state in all groups.
fn readings(problem: &Problem, state: usize) -> usize {
    let own = problem.readings.iter().skip(state);
    own.step_by(problem.states()).sum()
}

/// Root mean square over all readings of the noise of a state's sensors.
fn noise(problem: &Problem, state: usize) -> f64 {
    let n = problem.states();
    let own = || (state..problem.noise.len()).step_by(n);
    let square: f64 = own()
        .map(|s| problem.readings[s] as f64 * problem.noise[s].powi(2))
        .sum();
    (square / readings(problem, state) as f64).sqrt()
}

fn channel(problem: &Problem, fit: &Fit, state: usize) -> Channel {
    let n = problem.states();
    let (mut sums, mut total) = ([0.0; LAGS], 0.0);
    let (mut square, mut excess, mut rounded) = (0.0, 0.0, [0.0; LAGS]);
    let coarse = problem.lattices[state].filter(|l| l.matters(noise(problem, state)));
    for (r, (record, path)) in problem.records.iter().zip(fit.paths()).enumerate() {
        let sensor = problem.sensors.of(r).start + state;
        let (sigma, noise) = (fit.sigma()[sensor], problem.noise[sensor]);
        let read = record.measured[state].iter().enumerate();
        let known = |x: f64| if x.is_finite() { x } else { 0.0 };
        // In units of the file's own noise, so that the noisiest does not speak for all.
        let left: Vec<f64> = read
            .map(|(k, y)| known((y - path[k * n + state]) / sigma))
            .collect();
        let own: f64 = left.iter().map(|x| x * x).sum();
        total += own;
        square += own * sigma * sigma;
        excess += own * (sigma / noise.max(f64::MIN_POSITIVE)).powi(2);
        lagged(&left, &mut sums);
        if let Some(lattice) = coarse {
            let way = (0..record.len()).map(|k| path[k * n + state]);
            let error: Vec<f64> = way.map(|x| (lattice.nearest(x) - x) / sigma).collect();
            lagged(&error, &mut rounded);
        }
    }
    let readings = readings(problem, state);
    let m = readings as f64;
    let correlation = sums.map(|s| s / total.max(f64::MIN_POSITIVE));
    let memory = white::size(&correlation);
    let rounded = white::size(&rounded.map(|s| s / total.max(f64::MIN_POSITIVE)));
    Channel {
        signal: problem.system.states[state],
        left: (square / m).sqrt(),
        noise: noise(problem, state),
        excess: (excess / m).sqrt(),
        spread: problem.spread[state],
        readings,
        memory: memory.copysign(correlation[0]),
        chance: white::chance(m) + rounded,
        files: files(problem, fit, state),
        strays: strays(problem, fit, state),
        left_out: problem.left_out.iter().filter(|l| l.state == state).count(),
    }
}

/// Adds the products of all values with those some samples on.
fn lagged(values: &[f64], sums: &mut [f64; LAGS]) {
    for (lag, sum) in (1..).zip(sums) {
        let pairs = values.iter().zip(values.iter().skip(lag));
        *sum += pairs.map(|(a, b)| a * b).sum::<f64>();
    }
}

/// Residuals of trajectories with sensors of their own, if they differ.
fn files(problem: &Problem, fit: &Fit, state: usize) -> Vec<File> {
    let n = problem.states();
    let mut files: Vec<File> = Vec::new();
    let mut seen = Vec::new();
    for (r, record) in problem.records.iter().enumerate() {
        let group = problem.sensors.group(r);
        let sensor = group * n + state;
        let count = problem.readings[sensor];
        if count == 0 || seen.contains(&group) {
            continue;
        }
        seen.push(group);
        files.push(File {
            trajectory: record.trajectory,
            left: (fit.squares[sensor] / count as f64).sqrt(),
        });
    }
    let least = files.iter().map(|f| f.left).fold(f64::INFINITY, f64::min);
    let most = files.iter().map(|f| f.left).fold(0.0, f64::max);
    if most <= DIFFER * least {
        files.clear();
    }
    files
}
