//! The estimation problem: everything that stays the same while supports are tried.
//!
//! In: a system, a dataset, declared noise. Out: a [`Problem`]: records, smoothed trajectories, spread and noise. Linearises nothing.

use std::ops::Range;

use super::coefficient_constraints::CoefficientConstraints;
use super::growth::Growth;
use super::held_sample::HeldSample;
use super::process_noise::ProcessNoise;
use super::quantization::{QuantizationGrid, informative_shares, quantization_grid};
use super::record::{Record, SensorSettings, records};
use super::rejected_readings::{LeftOut, reject_outliers};
use super::resting::{Rest, between_rests};
use super::run_columns::RunColumns;
use super::sensor_groups::{SensorGroups, sensor_groups};
use super::smoothing::{SmoothedTrajectory, smoothed_trajectories};
use super::system::System;
use crate::trajectory::thresholds::SHOOTING;
use sidc_data::Dataset;
use sidc_lang::sensor_noise::SensorNoise;
use sidc_lang::term::{Expr, Signal, Tape};

/// The estimation problem of one system on its data.
#[derive(Clone, Debug)]
pub struct Problem {
    pub system: System,
    pub records: Vec<Record>,
    /// Names of the trajectories.
    pub names: Vec<String>,
    pub(crate) smoothed: Vec<SmoothedTrajectory>,
    /// Standard deviation of each state over the smoothed trajectories.
    pub spread: Vec<f64>,
    /// Which sensors read which record.
    pub sensors: SensorGroups,
    /// Standard deviation of each sensor's noise as smoothing shows it; for unmeasured states in proportion to the measured ones of
    /// their variable. Of noise that grows with the signal, the geometric mean over the readings. Groups × states.
    pub noise: Vec<f64>,
    /// How each sensor's noise grows with the signal, groups × states; `None` where it is the same for all readings.
    pub(crate) growth: Vec<Option<Growth>>,
    /// Number of readings of each sensor, groups × states.
    pub readings: Vec<usize>,
    /// Σ ln of the share of the variance of each sensor's noise that is new in a reading, groups × states: 0 for white noise.
    pub(crate) log_new_variance: Vec<f64>,
    /// Share of each sensor's readings that carries information, groups × states: 1 but for coarse encoders.
    pub(crate) informative: Vec<f64>,
    /// The grid of each state's readings, where those are quantized.
    pub(crate) quantization: Vec<Option<QuantizationGrid>>,
    /// Readings that have no weight.
    pub left_out: Vec<LeftOut>,
    /// Parts of trajectories along which bodies lie on each other, which no record contains.
    pub rests: Vec<Rest>,
    /// Columns that belong to one run each.
    pub run_columns: RunColumns,
    /// What moves the states besides the laws, where a search starts; `None` where laws hold but for slips.
    pub(crate) process: Option<ProcessNoise>,
    /// Noise of the states that are inputs: declared, since nothing shows it; `None` for all others.
    pub(crate) input_noise: Vec<Option<f64>>,
    /// Noise that the model declares for each state.
    pub(crate) declared: Vec<Option<SensorNoise>>,
    /// Time constant of the noise of each state's sensors that the model declares, s; 0 for white noise.
    pub(crate) declared_memory: Vec<Option<f64>>,
    /// Where hidden states without a scale of their own are held: one sample of one record each.
    pub(crate) pins: Vec<HeldSample>,
    /// How many times more than usual laws may slip: 1, but on the way to a first fit.
    pub(crate) looseness: f64,
    /// How many times farther than usual states that nothing reads may move in a step.
    pub(crate) hold: f64,
    /// Columns with coefficients that a search may start from.
    pub(crate) proposed: Option<Vec<(usize, f64)>>,
    /// Columns of each law.
    pub(crate) ranges: Vec<Range<usize>>,
    /// All columns, compiled.
    pub(crate) all: Tape,
}

/// A point about which the likelihood is linearised.
#[derive(Clone, Debug)]
pub(crate) struct LinearizationPoint {
    pub support: Vec<usize>,
    pub coefficients: Vec<f64>,
    /// States along each record, samples × n.
    pub paths: Vec<Vec<f64>>,
    /// Noise of each sensor, groups × states.
    pub sigma: Vec<f64>,
    pub process: Option<ProcessNoise>,
}

impl LinearizationPoint {
    /// Pairs of column and coefficient.
    pub fn active(&self) -> Vec<(usize, f64)> {
        let columns = self.support.iter().copied();
        columns.zip(self.coefficients.iter().copied()).collect()
    }

    /// The same with these columns in its support, at zero where they are new.
    pub fn requiring(mut self, required: &[usize]) -> LinearizationPoint {
        for column in required {
            if !self.support.contains(column) {
                let place = self.support.partition_point(|j| j < column);
                self.support.insert(place, *column);
                self.coefficients.insert(place, 0.0);
            }
        }
        self
    }
}

impl Problem {
    /// With `robust`, readings far from the smooth curve through the others get no weight.
    ///
    /// # Errors
    /// A signal that the data do not have.
    pub fn new(
        system: System,
        dataset: &Dataset,
        declared: &dyn Fn(Signal) -> Option<SensorNoise>,
        robust: bool,
    ) -> Result<Problem, Signal> {
        let records = records(&system, dataset, &SensorSettings { declared, robust })?;
        let (mut records, rests) = between_rests(&system, records);
        let declared: Vec<Option<SensorNoise>> =
            system.states.iter().map(|s| declared(*s)).collect();
        let left_out = match robust {
            true => reject_outliers(&mut records, &declared),
            false => Vec::new(),
        };
        let smoothed = smoothed_trajectories(&system, &records, &declared);
        let n = system.states.len();
        let mut problem = Problem {
            spread: (0..n).map(|i| spread(&smoothed, i, n)).collect(),
            sensors: sensor_groups(&records, n),
            noise: Vec::new(),
            growth: Vec::new(),
            ranges: Vec::new(),
            all: Tape::default(),
            names: dataset
                .trajectories
                .iter()
                .map(|t| t.name.clone())
                .collect(),
            system,
            records,
            smoothed,
            readings: Vec::new(),
            log_new_variance: Vec::new(),
            informative: Vec::new(),
            quantization: Vec::new(),
            left_out,
            rests,
            run_columns: RunColumns::default(),
            process: None,
            input_noise: vec![None; n],
            declared,
            declared_memory: vec![None; n],
            pins: Vec::new(),
            looseness: 1.0,
            hold: 1.0,
            proposed: None,
        };
        problem.compile_columns();
        problem.update_noise();
        let laws: Vec<Option<SensorNoise>> = (problem.declared.iter())
            .map(|noise| noise.filter(SensorNoise::grows))
            .collect();
        let curves: Vec<Vec<f64>> = problem.smoothed.iter().map(|c| c.states.clone()).collect();
        problem.set_growth(&laws, &curves);
        Ok(problem)
    }

    /// Compiles the columns of the system.
    pub(crate) fn compile_columns(&mut self) {
        let system = &self.system;
        let all: Vec<Expr> = system.columns.iter().map(|t| t.clone().into()).collect();
        self.all = Tape::new(&all, &system.evaluation_signals()).unwrap_or_default();
        self.ranges = system.laws.iter().map(|l| l.columns.clone()).collect();
    }

    /// The same data with other columns of the same laws.
    ///
    /// # Errors
    /// A signal that the data do not have.
    pub fn with_system(
        &self,
        system: System,
        dataset: &Dataset,
        declared: &dyn Fn(Signal) -> Option<SensorNoise>,
        robust: bool,
    ) -> Result<Problem, Signal> {
        let fresh = records(&system, dataset, &SensorSettings { declared, robust })?;
        let (fresh, _) = between_rests(&system, fresh);
        let mut problem = self.clone();
        for (record, fresh) in problem.records.iter_mut().zip(fresh) {
            record.exogenous = fresh.exogenous;
        }
        problem.system = system;
        problem.compile_columns();
        Ok(problem)
    }

    /// The same with other constraints on the coefficients.
    pub(crate) fn under(&self, constraints: CoefficientConstraints) -> Problem {
        let mut problem = self.clone();
        problem.system.constraints = constraints;
        problem
    }

    /// Noise that the model declares for each state.
    pub(super) fn declared(&self) -> &[Option<SensorNoise>] {
        &self.declared
    }

    /// The same system, noise and spread on parts of the records; part i is of record `origin[i]`.
    pub(crate) fn with_parts(
        &self,
        records: Vec<Record>,
        smoothed: Vec<SmoothedTrajectory>,
        origin: &[usize],
    ) -> Problem {
        let mut problem = Problem {
            system: self.system.clone(),
            names: self.names.clone(),
            spread: self.spread.clone(),
            sensors: self.sensors.for_parts(origin),
            noise: self.noise.clone(),
            growth: self.growth.clone(),
            declared: self.declared.clone(),
            declared_memory: self.declared_memory.clone(),
            ranges: self.ranges.clone(),
            all: self.all.clone(),
            readings: Vec::new(),
            log_new_variance: Vec::new(),
            informative: self.informative.clone(),
            quantization: self.quantization.clone(),
            left_out: Vec::new(),
            rests: self.rests.clone(),
            run_columns: self.run_columns.clone(),
            process: self.process.clone(),
            input_noise: self.input_noise.clone(),
            pins: Vec::new(),
            looseness: self.looseness,
            hold: self.hold,
            proposed: self.proposed.clone(),
            records,
            smoothed,
        };
        problem.count();
        problem.pin(self.pins.iter().map(|p| p.state));
        problem
    }

    /// The same problem on other readings of the same records, which are smoothed again.
    pub(crate) fn with_records(&self, records: Vec<Record>, left_out: Vec<LeftOut>) -> Problem {
        let mut problem = self.clone();
        problem.smoothed = smoothed_trajectories(&self.system, &records, &self.declared);
        problem.keep_hidden(&self.smoothed);
        problem.records = records;
        problem.left_out = left_out;
        problem.update_noise();
        problem
    }

    /// Counts the readings of every sensor, and what is new in them.
    pub(super) fn count(&mut self) {
        self.log_new_variance = self.log_new_variances();
        self.readings = vec![0; self.sensors.count()];
        for (r, record) in self.records.iter().enumerate() {
            for (of, column) in self.readings[self.sensors.of(r)]
                .iter_mut()
                .zip(&record.measured)
            {
                *of += column.iter().filter(|x| x.is_finite()).count();
            }
        }
    }

    /// Updates what follows from readings and smoothed trajectories: counts, noise, quantization.
    pub(crate) fn update_noise(&mut self) {
        let n = self.states();
        self.count();
        self.noise = (0..self.sensors.count() / n.max(1))
            .flat_map(|group| self.noise_of_group(group))
            .collect();
        self.quantization = (0..n)
            .map(|i| quantization_grid(&self.records, i))
            .collect();
        self.informative = informative_shares(
            &self.records,
            &self.sensors,
            &self.noise,
            &self.quantization,
        );
        for (level, growth) in self.noise.iter_mut().zip(&self.growth) {
            *level /= growth.map_or(1.0, |g| g.rms);
        }
    }

    /// Noise of a group's sensors: root mean square over its records; unmeasured states take the largest relative noise of their variable.
    fn noise_of_group(&self, group: usize) -> Vec<f64> {
        let n = self.system.states.len();
        let seen = |i: usize| -> Option<f64> {
            let (mut sum, mut count) = (0.0, 0.0);
            for (r, (record, curve)) in self.records.iter().zip(&self.smoothed).enumerate() {
                if self.sensors.group(r) != group {
                    continue;
                }
                let m = record.len() as f64;
                if let Some(sigma) = curve.noise.get(i).copied().flatten() {
                    sum += m * sigma * sigma;
                    count += m;
                }
            }
            (count > 0.0).then(|| (sum / count).sqrt())
        };
        let own: Vec<Option<f64>> = (0..n).map(seen).collect();
        let relative = |i: usize| own[i].map(|s| s / self.spread[i]);
        (0..n)
            .map(|i| {
                let var = self.system.states[i].var;
                let same = (0..n).filter(|j| self.system.states[*j].var == var);
                let mut part = same.filter_map(relative).fold(0.0, f64::max);
                if self.system.is_hidden(i) {
                    // The laws of hidden states hold more tightly than the others: without readings, a slip would be amplified by large
                    // coefficients into motion that explains anything.
                    let best = (0..n).filter_map(relative).fold(f64::INFINITY, f64::min);
                    part = SHOOTING.hidden_slack * best;
                }
                own[i].unwrap_or(part * self.spread[i])
            })
            .collect()
    }

    /// The mean interval between samples and the length of all records, in seconds.
    pub(crate) fn step_and_length(&self) -> (f64, f64) {
        let of = |r: &Record| Some((r.len().checked_sub(1)?, r.time.last()? - r.time.first()?));
        let (mut intervals, mut length) = (0, 0.0);
        for (count, time) in self.records.iter().filter_map(of) {
            intervals += count;
            length += time;
        }
        (length / intervals.max(1) as f64, length)
    }

    /// Length of all records, in seconds.
    pub fn length(&self) -> f64 {
        self.step_and_length().1
    }

    /// States that sensors read, without inputs.
    pub(crate) fn read_states(&self) -> impl Iterator<Item = usize> {
        let read = |i: &usize| self.readings_of(*i) > 0 && self.input_noise[*i].is_none();
        (0..self.states()).filter(read)
    }

    pub fn states(&self) -> usize {
        self.system.states.len()
    }

    /// Number of samples of all records.
    pub fn samples(&self) -> usize {
        self.records.iter().map(Record::len).sum()
    }

    /// Number of readings of one state in all records.
    pub(crate) fn readings_of(&self, state: usize) -> usize {
        let own = self.readings.iter().skip(state);
        own.step_by(self.states()).sum()
    }

    /// Number of readings of all sensors.
    pub fn measurements(&self) -> usize {
        self.readings.iter().sum()
    }

    /// The smoothed trajectories as a point without terms.
    pub(crate) fn initial_point(&self, sigma: &[f64]) -> LinearizationPoint {
        LinearizationPoint {
            support: Vec::new(),
            coefficients: Vec::new(),
            paths: self.smoothed.iter().map(|c| c.states.clone()).collect(),
            sigma: sigma.to_vec(),
            process: self.process.clone(),
        }
    }
}

pub(super) fn spread(smoothed: &[SmoothedTrajectory], state: usize, n: usize) -> f64 {
    let all = || {
        smoothed
            .iter()
            .flat_map(|c| c.states.iter().skip(state).step_by(n))
    };
    let count = all().count().max(1) as f64;
    let mean = all().sum::<f64>() / count;
    let square = all().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
    // A state that never moves has no scale: 1.
    if square > 0.0 { square.sqrt() } else { 1.0 }
}
