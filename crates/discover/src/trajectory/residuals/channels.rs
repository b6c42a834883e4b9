//! Residuals of each channel: their size, their autocorrelation, their outliers.
//!
//! In: a problem and a fit. Out: a [`Channel`] for every state that is read. White residuals of the sensor's own size are the test of laws
//! and library together: what is missing from those stays in the residuals.

use super::outliers::{Outliers, outliers};
use crate::trajectory::likelihood::{Fit, Innovation, final_floor, innovations};
use crate::trajectory::model::Problem;
use crate::trajectory::thresholds::{GAUSS_NEWTON, RESIDUALS};
use sidc_lang::sensor_noise::SensorNoise;
use sidc_lang::term::Signal;
use sidc_solve::{WHITENESS_LAGS, rms_autocorrelation, white_noise_bound};

/// One channel's residuals.
#[derive(Clone, Debug)]
pub struct Channel {
    pub signal: Signal,
    /// Root mean square of the residuals, in the channel's units.
    pub residual: f64,
    /// The sensor's noise, as declared or as smoothing shows it.
    pub noise: f64,
    /// The noise that the residuals show, where it grows with the signal.
    pub growth: Option<SensorNoise>,
    /// Time constant of the noise, s, where it lasts from sample to sample.
    pub lasting: Option<f64>,
    /// Root mean square of residuals, each over the noise of its own record's sensor.
    pub noise_ratio: f64,
    /// How closely the fit was brought to its optimum; what it leaves below that says nothing.
    pub accuracy: f64,
    /// Standard deviation of the state.
    pub spread: f64,
    pub readings: usize,
    /// Root mean square of the autocorrelation over lags 1 … 8, signed by the first: 0 for white residuals, 1 at most. Of noise that lasts, that
    /// of what is new in each residual.
    pub autocorrelation: f64,
    /// Bound of `autocorrelation` for white residuals, plus what the rounding of an encoder adds.
    pub white_noise_bound: f64,
    /// Residuals of each file; empty unless they differ.
    pub files: Vec<File>,
    /// Isolated readings that noise does not explain.
    pub outliers: Option<Outliers>,
    /// Number of readings that had no weight.
    pub left_out: usize,
}

/// One trajectory's part of a channel.
#[derive(Clone, Debug)]
pub struct File {
    pub trajectory: usize,
    /// Root mean square of its residuals.
    pub left: f64,
}

/// The residuals of every state that is read.
///
/// Under process noise residuals are innovations, and what they should be is their deviation: disturbances are no misfit.
pub fn channels(problem: &Problem, fit: &Fit) -> Vec<Channel> {
    if fit.process().is_some() {
        let all = innovations(problem, fit);
        return problem
            .read_states()
            .map(|i| channel_of(problem, fit, i, &all))
            .collect();
    }
    (0..problem.states())
        .filter(|i| problem.readings_of(*i) > 0)
        .map(|i| channel(problem, fit, i))
        .collect()
}

impl Problem {
    /// Every channel before there is a fit, as if the residuals were the noise that smoothing shows.
    pub fn channels(&self) -> Vec<Channel> {
        let read = (0..self.states()).filter(|i| self.readings_of(*i) > 0);
        read.map(|i| Channel {
            signal: self.system.states[i],
            residual: noise(self, i),
            noise: noise(self, i),
            growth: None,
            lasting: self.noise_time_constant(i),
            noise_ratio: 1.0,
            accuracy: accuracy(self, i),
            spread: self.spread[i],
            readings: self.readings_of(i),
            autocorrelation: 0.0,
            white_noise_bound: 0.0,
            files: Vec::new(),
            outliers: None,
            left_out: 0,
        })
        .collect()
    }
}

/// Noise of a state's sensors, root mean square over all readings.
fn noise(problem: &Problem, state: usize) -> f64 {
    mean_noise(problem, &problem.noise, state)
}

/// Noise of a state's sensors, root mean square over all readings, from the levels `noise` of all sensors.
fn mean_noise(problem: &Problem, noise: &[f64], state: usize) -> f64 {
    let n = problem.states();
    let own = (state..noise.len()).step_by(n);
    let square: f64 = own
        .map(|s| problem.readings[s] as f64 * (noise[s] * problem.rms_over_level(s)).powi(2))
        .sum();
    (square / problem.readings_of(state) as f64).sqrt()
}

/// How far a state may still be from the optimum when the fit ends: its largest last step, for the least noise of its sensors.
fn accuracy(problem: &Problem, state: usize) -> f64 {
    let own = final_floor(problem).into_iter().skip(state);
    let least = own.step_by(problem.states()).fold(f64::INFINITY, f64::min);
    GAUSS_NEWTON.state_step * least
}

fn channel(problem: &Problem, fit: &Fit, state: usize) -> Channel {
    let n = problem.states();
    let (mut sums, mut total) = ([0.0; WHITENESS_LAGS], 0.0);
    let (mut square, mut excess, mut rounded) = (0.0, 0.0, [0.0; WHITENESS_LAGS]);
    // Smoothing takes noise that lasts from sample to sample for motion, so its estimate of that noise is too small.
    let own_scale =
        problem.noise_time_constant(state).is_some() && problem.declared[state].is_none();
    let coarse = problem.quantization[state].filter(|l| l.matters(noise(problem, state)));
    for (r, (record, path)) in problem.records.iter().zip(fit.paths()).enumerate() {
        let sensor = problem.sensors.of(r).start + state;
        let sigma = fit.sigma()[sensor];
        let noise = if own_scale {
            sigma
        } else {
            problem.noise[sensor]
        };
        let known = |x: f64| if x.is_finite() { x } else { 0.0 };
        // In units of each record's own noise, so that the noisiest record does not dominate.
        let new = fit.whitened(problem, r, state).into_iter();
        let new: Vec<f64> = new.map(|x| known(x / sigma)).collect();
        let own: f64 = new.iter().map(|x| x * x).sum();
        total += own;
        square += match problem.growth.get(sensor).copied().flatten() {
            None => own * sigma * sigma,
            Some(_) => new
                .iter()
                .enumerate()
                .map(|(k, x)| (x * sigma * record.relative_noise_at(state, k)).powi(2))
                .sum(),
        };
        excess += own * (sigma / noise.max(f64::MIN_POSITIVE)).powi(2);
        add_autocovariances(&new, &mut sums);
        if let Some(lattice) = coarse {
            let way = (0..record.len()).map(|k| path[k * n + state]);
            let error = way.enumerate().map(|(k, x)| {
                (lattice.nearest(x) - x) / (sigma * record.relative_noise_at(state, k))
            });
            let error: Vec<f64> = error.collect();
            add_autocovariances(&error, &mut rounded);
        }
    }
    let readings = problem.readings_of(state);
    let m = readings as f64;
    let correlation = sums.map(|s| s / total.max(f64::MIN_POSITIVE));
    let memory = rms_autocorrelation(&correlation);
    let rounded = rms_autocorrelation(&rounded.map(|s| s / total.max(f64::MIN_POSITIVE)));
    Channel {
        signal: problem.system.states[state],
        residual: (square / m).sqrt(),
        noise: match own_scale {
            true => mean_noise(problem, fit.sigma(), state),
            false => noise(problem, state),
        },
        growth: growth(problem, fit, state),
        lasting: problem.noise_time_constant(state),
        noise_ratio: (excess / m).sqrt(),
        accuracy: accuracy(problem, state),
        spread: problem.spread[state],
        readings,
        autocorrelation: memory.copysign(correlation[0]),
        white_noise_bound: white_noise_bound(m) + rounded,
        files: files(problem, fit, state),
        outliers: outliers(problem, fit, state),
        left_out: problem.left_out.iter().filter(|l| l.state == state).count(),
    }
}

/// A channel by its innovations.
fn channel_of(problem: &Problem, fit: &Fit, state: usize, all: &[Innovation]) -> Channel {
    let own = || all.iter().filter(|i| i.state == state);
    let m = own().count().max(1) as f64;
    let rms =
        |f: &dyn Fn(&Innovation) -> f64| (own().map(|i| f(i).powi(2)).sum::<f64>() / m).sqrt();
    let mut sums = [0.0; WHITENESS_LAGS];
    for (r, record) in problem.records.iter().enumerate() {
        let mut whitened = vec![0.0; record.len()];
        for i in own().filter(|i| i.record == r) {
            whitened[i.sample] = i.value / i.deviation;
        }
        add_autocovariances(&whitened, &mut sums);
    }
    let excess = rms(&|i| i.value / i.deviation);
    let correlation = sums.map(|s| s / (m * excess * excess).max(f64::MIN_POSITIVE));
    Channel {
        signal: problem.system.states[state],
        residual: rms(&|i| i.value),
        noise: mean_noise(problem, fit.sigma(), state),
        noise_ratio: excess,
        accuracy: 0.0,
        spread: problem.spread[state],
        readings: problem.readings_of(state),
        autocorrelation: rms_autocorrelation(&correlation).copysign(correlation[0]),
        white_noise_bound: white_noise_bound(m),
        files: Vec::new(),
        outliers: None,
        left_out: problem.left_out.iter().filter(|l| l.state == state).count(),
        growth: growth(problem, fit, state),
        lasting: None,
    }
}

/// The noise of a state's sensors as the residuals show it, root mean square over all readings; `None` where it does not grow.
fn growth(problem: &Problem, fit: &Fit, state: usize) -> Option<SensorNoise> {
    let (mut floor, mut share) = (0.0, 0.0);
    for s in (state..problem.growth.len()).step_by(problem.states()) {
        if let Some(growth) = problem.growth[s] {
            let weight = problem.readings[s] as f64 / problem.readings_of(state) as f64;
            // Filtered states lie nearer to the readings than the sensor's noise.
            let level = match fit.process() {
                Some(_) => fit.sigma()[s],
                None => (fit.residual_squares[s] / problem.readings[s].max(1) as f64).sqrt(),
            };
            let noise = growth.of_level(level);
            floor += weight * noise.floor.powi(2);
            share += weight * noise.share.powi(2);
        }
    }
    let noise = SensorNoise {
        floor: floor.sqrt(),
        share: share.sqrt(),
    };
    noise.grows().then_some(noise)
}

/// Adds Σ x_k x_{k+lag} for every lag.
fn add_autocovariances(values: &[f64], sums: &mut [f64; WHITENESS_LAGS]) {
    for (lag, sum) in (1..).zip(sums) {
        let pairs = values.iter().zip(values.iter().skip(lag));
        *sum += pairs.map(|(a, b)| a * b).sum::<f64>();
    }
}

/// Residuals of each group of trajectories, if they differ.
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
            left: (fit.residual_squares[sensor] / count as f64).sqrt()
                * problem.rms_over_level(sensor),
        });
    }
    let least = files.iter().map(|f| f.left).fold(f64::INFINITY, f64::min);
    let most = files.iter().map(|f| f.left).fold(0.0, f64::max);
    if most <= RESIDUALS.files_differ * least {
        files.clear();
    }
    files
}
