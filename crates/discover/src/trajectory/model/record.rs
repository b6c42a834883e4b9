//! Records: uninterrupted pieces of trajectories with the readings of the states and the exogenous signals.
//!
//! In: a dataset, a system. Out: [`Record`]s, or the signal that is missing. Readings stay as measured. Only states without a law are
//! smoothed, since no fit will estimate their noise.

use std::ops::Range;

use super::system::System;
use super::thresholds::NOISE_MEMORY;
use crate::trajectory::thresholds::RECORDS;
use sidc_data as data;
use sidc_data::{Cubic, Dataset, Trajectory};
use sidc_lang::model::Between;
use sidc_lang::sensor_noise::SensorNoise;
use sidc_lang::term::{Signal, VarId};

/// One uninterrupted piece of a trajectory, M samples.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// Index of the trajectory.
    pub trajectory: usize,
    /// Seconds. Length M.
    pub time: Vec<f64>,
    /// Readings of each state, each column of length M; NaN where there is none.
    pub measured: Vec<Vec<f64>>,
    /// Noise of each state's readings relative to the level of their sensor, each column of length M; empty where it is the same for all.
    pub relative_noise: Vec<Vec<f64>>,
    /// Time constant (s) of the noise of each state's readings; 0 for white noise, empty where all are white.
    pub noise_time_constant: Vec<f64>,
    /// The exogenous signals of the system, in its order.
    pub exogenous: Vec<Exogenous>,
}

/// An exogenous signal.
#[derive(Clone, Debug)]
pub struct Exogenous {
    /// Length M.
    pub values: Vec<f64>,
    /// How it moves from each sample to the next.
    pub between: Between,
}

impl Exogenous {
    /// Whether a value is held until the next sample (zero-order hold).
    pub fn is_held(&self) -> bool {
        self.between == Between::Hold
    }
}

impl Record {
    pub fn len(&self) -> usize {
        self.time.len()
    }

    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// Some of its samples.
    pub(crate) fn part(&self, samples: Range<usize>) -> Record {
        let keep = |x: &Vec<f64>| x[samples.clone()].to_vec();
        let exogenous = self.exogenous.iter().map(|e| Exogenous {
            values: keep(&e.values),
            between: e.between,
        });
        Record {
            trajectory: self.trajectory,
            time: keep(&self.time),
            measured: self.measured.iter().map(keep).collect(),
            relative_noise: self
                .relative_noise
                .iter()
                .map(|all| all.get(samples.clone()).unwrap_or(&[]).to_vec())
                .collect(),
            noise_time_constant: self.noise_time_constant.clone(),
            exogenous: exogenous.collect(),
        }
    }

    /// Noise of a reading relative to the level of its sensor: 1 where all are equally noisy.
    pub(crate) fn relative_noise_at(&self, state: usize, k: usize) -> f64 {
        let own = self.relative_noise.get(state).and_then(|all| all.get(k));
        own.copied().unwrap_or(1.0)
    }

    /// The share of a reading's error, over its relative noise, that lasts from the sample before: 0 for white noise, and where that sample
    /// has no reading.
    pub(crate) fn lasting_at(&self, state: usize, k: usize) -> f64 {
        let memory = self.noise_time_constant.get(state).copied().unwrap_or(0.0);
        if memory <= 0.0 || k == 0 {
            return 0.0;
        }
        let both = self.measured[state][k].is_finite() && self.measured[state][k - 1].is_finite();
        if both { self.lasting(memory, k) } else { 0.0 }
    }

    /// The share of an error of noise with this time constant, s, that lasts from sample `k` − 1 to `k`.
    pub(crate) fn lasting(&self, memory: f64, k: usize) -> f64 {
        let share = ((self.time[k - 1] - self.time[k]) / memory).exp();
        share.min(NOISE_MEMORY.most_lasting)
    }

    /// What is new in each value of a series over this record, each over the relative noise of a state's reading there: a first-order
    /// autoregression of deviation σ becomes white noise of that deviation (Prais & Winsten 1954). NaN stays.
    pub(crate) fn whitened(&self, state: usize, values: &[f64]) -> Vec<f64> {
        let before = |k: usize| k.checked_sub(1).map_or(f64::NAN, |k| values[k]);
        let new = |(k, x): (usize, &f64)| self.new_at(state, k, (before(k), *x));
        values.iter().enumerate().map(new).collect()
    }

    /// What is new in the value `x` of such a series at sample `k`, after `before` at the one before.
    pub(crate) fn new_at(&self, state: usize, k: usize, (before, x): (f64, f64)) -> f64 {
        match self.lasting_at(state, k) {
            0.0 => x,
            lasting => (x - lasting * before) / (1.0 - lasting * lasting).sqrt(),
        }
    }

    /// Smallest and largest relative noise of a state's readings.
    pub(crate) fn relative_noise_range(&self, state: usize) -> (f64, f64) {
        match self.relative_noise.get(state).filter(|all| !all.is_empty()) {
            None => (1.0, 1.0),
            Some(all) => all
                .iter()
                .fold((f64::INFINITY, 0.0), |(a, b), x| (x.min(a), x.max(b))),
        }
    }

    /// Value of an exogenous signal between sample `k` and the next; `part` from 0 to 1.
    pub fn exogenous_at(&self, signal: usize, k: usize, part: f64) -> f64 {
        let Some(o) = self.exogenous.get(signal) else {
            return f64::NAN;
        };
        let here = o.values.get(k).copied().unwrap_or(f64::NAN);
        let straight = |next: f64| here + part * (next - here);
        match (o.between, o.values.get(k + 1)) {
            (Between::Hold, _) | (_, None) => here,
            (Between::Linear, Some(next)) => straight(*next),
            (Between::Cubic, Some(next)) => match Cubic::after(&self.time, &o.values, k) {
                Some(cubic) => cubic.at(part * (self.time[k + 1] - self.time[k])),
                None => straight(*next),
            },
        }
    }

    /// Its slope there, a second.
    pub fn exogenous_rate_at(&self, signal: usize, k: usize, part: f64) -> f64 {
        if self.exogenous.get(signal).is_none_or(Exogenous::is_held) {
            return 0.0;
        }
        // Exact for a straight line; what differences leave of a cubic is far below its error.
        let [before, after] = [part - 1e-3, part + 1e-3].map(|at| self.exogenous_at(signal, k, at));
        (after - before) / (2e-3 * (self.time[k + 1] - self.time[k]))
    }
}

/// How readings are treated before there is a fit.
pub struct SensorSettings<'a> {
    /// Noise that the model declares.
    pub declared: &'a dyn Fn(Signal) -> Option<SensorNoise>,
    /// Whether outliers of the smoother get no weight.
    pub robust: bool,
}

/// The records of all trajectories.
///
/// # Errors
/// An exogenous signal that a trajectory lacks, or a variable of which it has no signal.
pub fn records(
    system: &System,
    dataset: &Dataset,
    sensor: &SensorSettings,
) -> Result<Vec<Record>, Signal> {
    let mut all = Vec::new();
    for (index, trajectory) in dataset.trajectories.iter().enumerate() {
        let read = |var: &VarId| !system.hidden.contains(var);
        for law in system.laws.iter().filter(|l| read(&l.target.var)) {
            let chain = system.states.iter().filter(|s| s.var == law.target.var);
            if !chain.clone().any(|s| trajectory.column(*s).is_some()) {
                return Err(Signal::new(law.target.var));
            }
        }
        for piece in data::contiguous_ranges(&trajectory.time) {
            if piece.len() >= RECORDS.min_samples {
                all.push(record(system, dataset, sensor, (index, trajectory), piece)?);
            }
        }
    }
    Ok(all)
}

fn record(
    system: &System,
    dataset: &Dataset,
    sensor: &SensorSettings,
    (index, trajectory): (usize, &Trajectory),
    piece: Range<usize>,
) -> Result<Record, Signal> {
    let cut = |s: Signal| -> Option<Vec<f64>> {
        if s == Signal::TIME {
            return trajectory.time.get(piece.clone()).map(<[f64]>::to_vec);
        }
        Some(trajectory.column(s)?.get(piece.clone())?.to_vec())
    };
    let length = piece.len();
    let mut exogenous = Vec::new();
    for (signal, noisy_exogenous) in system.exogenous.iter().zip(&system.noisy_exogenous) {
        let time = trajectory.time.get(piece.clone()).unwrap_or(&[]);
        let between = dataset.between_samples(*signal);
        // So is the derivative of an input that is not held, if nobody measured it.
        let is_held = dataset.between(signal.var) == Some(Between::Hold);
        let is_smoothed = *noisy_exogenous || cut(*signal).is_none() && !is_held;
        let smoothed = is_smoothed
            .then(|| smoothed(*signal, time, &cut, sensor))
            .flatten();
        let mut values = smoothed.or_else(|| cut(*signal)).ok_or(*signal)?;
        if !fill_missing(time, &mut values, between) {
            return Err(*signal);
        }
        exogenous.push(Exogenous { values, between });
    }
    let unmeasured = || vec![f64::NAN; length];
    Ok(Record {
        trajectory: index,
        time: cut(Signal::TIME).unwrap_or_default(),
        measured: system
            .states
            .iter()
            .map(|s| cut(*s).unwrap_or_else(unmeasured))
            .collect(),
        relative_noise: Vec::new(),
        noise_time_constant: Vec::new(),
        exogenous,
    })
}

/// A signal of a state without a law, smoothed, or as a derivative of the smoothed signal.
fn smoothed(
    signal: Signal,
    time: &[f64],
    cut: &dyn Fn(Signal) -> Option<Vec<f64>>,
    sensor: &SensorSettings,
) -> Option<Vec<f64>> {
    let lower = |steps: u8| {
        Some(Signal::derivative(
            signal.var,
            signal.der.checked_sub(steps)?,
        ))
    };
    let (steps, from, values) =
        (0..=2).find_map(|steps| Some((steps, lower(steps)?, cut(lower(steps)?)?)))?;
    let declared = (sensor.declared)(from).map(|noise| noise.rms(&values));
    let smooth = data::smooth(time, &values, declared, &[], sensor.robust)?;
    Some(match steps {
        0 => smooth.values,
        1 => smooth.slope,
        _ => smooth.curvature,
    })
}

/// Fills missing values with the last one if held, else straight. False if there are no values.
fn fill_missing(time: &[f64], values: &mut [f64], between: Between) -> bool {
    let known: Vec<usize> = (0..values.len())
        .filter(|i| values[*i].is_finite())
        .collect();
    let (Some(first), Some(last)) = (known.first(), known.last()) else {
        return false;
    };
    let (start, end) = (values[*first], values[*last]);
    values[..*first].fill(start);
    values[last + 1..].fill(end);
    for pair in known.windows(2) {
        data::fill_between(between, time, values, (pair[0], pair[1]));
    }
    true
}
