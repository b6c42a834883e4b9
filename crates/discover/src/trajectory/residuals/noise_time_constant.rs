//! Whether the noise of a sensor lasts from sample to sample, and how long.
//!
//! In: a problem and a fit. Out: the problem whose readings have noise of that memory. The residuals are taken as an autoregression of first
//! order in continuous time; its time constant is that of the largest likelihood given the fit, with the size of each sensor's noise profiled
//! out. Fits no laws.

use super::outliers::deviation;
use crate::trajectory::golden_section::golden_section;
use crate::trajectory::likelihood::{Fit, final_floor};
use crate::trajectory::model::thresholds::NOISE_MEMORY;
use crate::trajectory::model::{Problem, Record};
use crate::trajectory::thresholds::{GAUSS_NEWTON, RESIDUALS};

/// Noise that lasts along a fit.
pub struct LastingNoise {
    pub problem: Problem,
    /// Time constants that were estimated.
    pub estimated: usize,
}

/// The problem with noise that lasts wherever that gains more than `price` along a fit and the model does not declare it; `None` where
/// nothing changes.
pub fn autocorrelated_noise(problem: &Problem, fit: &Fit, price: f64) -> Option<LastingNoise> {
    let n = problem.states();
    let read: Vec<usize> = problem.read_states().collect();
    let mut memory = vec![0.0; n];
    let mut estimated = 0;
    for state in read {
        if let Some(declared) = problem.declared_memory[state] {
            memory[state] = declared;
            continue;
        }
        let residuals = Residuals::new(problem, fit, state);
        let found = residuals.and_then(|r| r.memory(problem));
        if let Some((found, _)) = found.filter(|(_, gain)| *gain > price) {
            memory[state] = found;
            estimated += 1;
        }
    }
    let before = |i: usize| problem.noise_time_constant(i).unwrap_or(0.0);
    let step = problem.step_and_length().0;
    let correlation = |memory: f64| match memory > 0.0 {
        true => (-step / memory).exp(),
        false => 0.0,
    };
    let changed = (0..n).map(|i| (correlation(memory[i]) - correlation(before(i))).abs());
    if changed.fold(0.0, f64::max) <= NOISE_MEMORY.settled {
        return None;
    }
    Some(LastingNoise {
        problem: problem.with_noise_memory(&memory),
        estimated,
    })
}

/// Whether what is new in the noise of a sensor that lasts comes in bursts and is small otherwise, as where wrong laws leave the readings now and
/// then.
pub fn noise_comes_in_bursts(problem: &Problem, fit: &Fit) -> bool {
    let bursts = |state: usize| {
        let of_record = |(r, record): (usize, &Record)| {
            let left: Vec<f64> = fit.residuals(problem, r, state).collect();
            record.whitened(state, &left)
        };
        let new = problem.records.iter().enumerate().flat_map(of_record);
        let mut new: Vec<f64> = new.map(f64::abs).filter(|x| x.is_finite()).collect();
        let square = new.iter().map(|x| x * x).sum::<f64>() / new.len() as f64;
        deviation(&mut new) < NOISE_MEMORY.robust * square.sqrt()
    };
    let lasts = |state: &usize| problem.noise_time_constant(*state).is_some();
    problem.read_states().filter(lasts).any(bursts)
}

/// The residuals of one state, over their relative noise, with their records.
struct Residuals<'a> {
    /// By sensor.
    sensors: Vec<Vec<(&'a Record, Vec<f64>)>>,
}

impl<'a> Residuals<'a> {
    /// `None` where too few are read, or they are no noise.
    fn new(problem: &'a Problem, fit: &Fit, state: usize) -> Option<Residuals<'a>> {
        let n = problem.states();
        let mut sensors = vec![Vec::new(); problem.sensors.count() / n];
        for (r, record) in problem.records.iter().enumerate() {
            let left: Vec<f64> = fit.residuals(problem, r, state).collect();
            sensors[problem.sensors.group(r)].push((record, left));
        }
        let enough = problem.readings_of(state) >= NOISE_MEMORY.min_readings;
        // Residuals below the noise floor come from arithmetic, not from the sensor.
        let floor = final_floor(problem);
        let above = (state..problem.sensors.count()).step_by(n).all(|s| {
            let least = GAUSS_NEWTON.state_step * floor[s];
            problem.readings[s] == 0
                || fit.sigma()[s] > least.max(RESIDUALS.arithmetic * problem.spread[state])
        });
        (enough && above).then_some(Residuals { sensors })
    }

    /// The time constant of the largest likelihood, and what it gains over white noise.
    fn memory(&self, problem: &Problem) -> Option<(f64, f64)> {
        let (step, length) = problem.step_and_length();
        let longest = length / problem.records.len() as f64 / NOISE_MEMORY.errors;
        let (least, most) = ((NOISE_MEMORY.least * step).ln(), longest.ln());
        let count = 12;
        let width = (most - least) / f64::from(count);
        if !(width > 0.0 && width.is_finite()) {
            return None;
        }
        let value = |log: f64| self.deviance(log.exp());
        let tried = (0..=count).map(|i| least + f64::from(i) * width);
        let best = tried.min_by(|a, b| value(*a).total_cmp(&value(*b)))?;
        let bracket = ((best - width).max(least), (best + width).min(most));
        let best = golden_section(&value, bracket);
        let gain = self.deviance(0.0) - value(best);
        (gain > 0.0).then_some((best.exp(), gain))
    }

    /// −2 log likelihood with the noise of each sensor profiled out.
    fn deviance(&self, memory: f64) -> f64 {
        let of = |records: &Vec<(&Record, Vec<f64>)>| {
            let (mut sum, mut logs, mut count) = (0.0, 0.0, 0.0);
            for (record, left) in records {
                for (k, x) in left.iter().enumerate().filter(|(_, x)| x.is_finite()) {
                    let before = k.checked_sub(1).map_or(f64::NAN, |k| left[k]);
                    let lasting = match before.is_finite() && memory > 0.0 {
                        true => record.lasting(memory, k),
                        false => 0.0,
                    };
                    let new = 1.0 - lasting * lasting;
                    let off = if lasting > 0.0 {
                        x - lasting * before
                    } else {
                        *x
                    };
                    sum += off * off / new;
                    logs += new.ln();
                    count += 1.0;
                }
            }
            match count > 0.0 {
                true => count * (sum / count).max(f64::MIN_POSITIVE).ln() + logs,
                false => 0.0,
            }
        };
        self.sensors.iter().map(of).sum()
    }
}
