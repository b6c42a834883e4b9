//! Noise that grows with the signal: how noisy each reading is beside the others of its sensor.
//!
//! In: the noise of a sensor as a function of the value read, trajectories. Out: the relative noise of every reading, of geometric mean 1. With
//! that, a likelihood needs one level a sensor as before: Σ ln σ_k² is that of the level. Values are those of a trajectory, never the
//! readings: weights that follow the errors themselves bias the fit (Davidian & Carroll, J. Am. Stat. Assoc. 1987). Estimates no noise.

use super::estimation_problem::Problem;
use super::growth::Growth;
use crate::trajectory::thresholds::GROWTH;
use sidc_lang::sensor_noise::SensorNoise;

impl Problem {
    /// Root mean square of the noise of a sensor's readings over its level.
    pub(crate) fn rms_over_level(&self, sensor: usize) -> f64 {
        let growth = self.growth.get(sensor).copied().flatten();
        growth.map_or(1.0, |g| g.rms)
    }

    /// Least relative noise of each sensor's readings.
    pub(crate) fn least_relative_noise(&self) -> Vec<f64> {
        let mut least = vec![f64::INFINITY; self.sensors.count()];
        for (r, record) in self.records.iter().enumerate() {
            for (i, least) in least[self.sensors.of(r)].iter_mut().enumerate() {
                *least = least.min(record.relative_noise_range(i).0);
            }
        }
        // A sensor without records weighs nothing.
        least
            .iter()
            .map(|l| if l.is_finite() { *l } else { 1.0 })
            .collect()
    }

    /// The same problem with noise that grows by `laws`, one a state, along trajectories (samples × n).
    pub(crate) fn with_growth(&self, laws: &[Option<SensorNoise>], paths: &[Vec<f64>]) -> Problem {
        let mut problem = self.clone();
        problem.set_growth(laws, paths);
        problem
    }

    pub(crate) fn set_growth(&mut self, laws: &[Option<SensorNoise>], paths: &[Vec<f64>]) {
        let n = self.states();
        let rms = (0..self.sensors.count()).map(|s| self.noise[s] * self.rms_over_level(s));
        let rms: Vec<f64> = rms.collect();
        if laws.iter().all(Option::is_none) && self.growth.iter().all(Option::is_none) {
            return;
        }
        self.growth = vec![None; self.sensors.count()];
        for record in &mut self.records {
            record.relative_noise = vec![Vec::new(); n];
        }
        for (state, law) in laws.iter().enumerate() {
            for sensor in (state..self.sensors.count()).step_by(n) {
                let law = law.map(|law| self.bounded(law, (sensor, state), paths));
                self.growth[sensor] =
                    law.and_then(|law| self.spread_over((sensor, state), law, paths));
            }
        }
        for (sensor, rms) in rms.into_iter().enumerate() {
            self.noise[sensor] = rms / self.rms_over_level(sensor);
        }
    }

    /// A law of noise with a floor, so that no reading has zero noise: at least the rounding of an encoder, and a part of the noise at the
    /// root mean square value.
    fn bounded(
        &self,
        law: SensorNoise,
        (sensor, state): (usize, usize),
        paths: &[Vec<f64>],
    ) -> SensorNoise {
        let values = self.values_read((sensor, state), paths);
        let size = SensorNoise { floor: 0.0, ..law }.rms(&values);
        let rounding = self.quantization[state].map_or(0.0, |grid| grid.step / 12_f64.sqrt());
        SensorNoise {
            floor: law.floor.hypot(rounding).max(GROWTH.least * size),
            ..law
        }
    }

    /// Sets the relative noise of a sensor's readings; `None` where it has none.
    fn spread_over(
        &mut self,
        (sensor, state): (usize, usize),
        law: SensorNoise,
        paths: &[Vec<f64>],
    ) -> Option<Growth> {
        let values = self.values_read((sensor, state), paths);
        if values.is_empty() {
            return None;
        }
        let count = values.len() as f64;
        let logs: f64 = values.iter().map(|x| law.at(*x).ln()).sum();
        let mean = (logs / count).exp();
        if !(mean > 0.0 && mean.is_finite()) {
            return None;
        }
        let n = self.states();
        for (r, (record, path)) in self.records.iter_mut().zip(paths).enumerate() {
            if self.sensors.of(r).start + state == sensor {
                let own = path.iter().skip(state).step_by(n);
                record.relative_noise[state] = own.map(|x| law.at(*x) / mean).collect();
            }
        }
        Some(Growth {
            law,
            mean,
            rms: law.rms(&values) / mean,
        })
    }

    /// Values of trajectories where a sensor has readings.
    fn values_read(&self, (sensor, state): (usize, usize), paths: &[Vec<f64>]) -> Vec<f64> {
        let n = self.states();
        let records = self.records.iter().zip(paths).enumerate();
        let own = records.filter(|(r, _)| self.sensors.of(*r).start + state == sensor);
        let values = own.flat_map(|(_, (record, path))| {
            let values = path.iter().skip(state).step_by(n);
            let read = record.measured[state].iter().zip(values);
            read.filter(|(y, _)| y.is_finite()).map(|(_, x)| *x)
        });
        values.collect()
    }
}
