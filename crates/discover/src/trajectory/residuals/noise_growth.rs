//! Whether the noise of a sensor grows with the signal, and how.
//!
//! In: a problem and a fit. Out: the noise at each value, by state, or the problem with readings weighed by it. The residuals are taken as
//! normal with variance a² + (b y)², y the fitted value (Rocke & Lorenzato, Technometrics 1995); b/a is that of the largest likelihood
//! given the fit, with the level of each sensor profiled out: the pseudo-likelihood of Davidian & Carroll (J. Am. Stat. Assoc. 1987). Fits no
//! laws.

use super::outliers::far_alone;
use crate::trajectory::golden_section::golden_section;
use crate::trajectory::likelihood::{Fit, final_floor};
use crate::trajectory::model::Problem;
use crate::trajectory::thresholds::{GAUSS_NEWTON, GROWTH, RESIDUALS};
use sidc_lang::sensor_noise::SensorNoise;

/// Noise that grows along a fit.
pub struct GrownNoise {
    /// The problem with its readings weighed.
    pub problem: Problem,
    /// Growths that were estimated, not declared.
    pub estimated: usize,
}

/// The problem with readings weighed by noise that grows along a fit, or along the smoothed trajectories, where the model declares it or
/// where it gains more than `price`; `None` where weights stay as they are.
pub fn grow_noise(problem: &Problem, fit: Option<&Fit>, price: f64) -> Option<GrownNoise> {
    let mut estimated = 0;
    let smoothed = || problem.smoothed.iter().map(|c| c.states.clone()).collect();
    let paths: Vec<Vec<f64>> = fit.map_or_else(smoothed, |fit| fit.paths().to_vec());
    let law = |state: usize| match problem.declared[state] {
        Some(declared) => Some(declared).filter(SensorNoise::grows),
        None => {
            let alone = fit.map(|fit| far_alone(problem, fit, state));
            let readings = Readings::new(problem, &paths, alone.as_deref(), state)?;
            let (law, _) = readings.growth().filter(|(_, gain)| *gain > price)?;
            estimated += 1;
            Some(law)
        }
    };
    let laws: Vec<Option<SensorNoise>> = (0..problem.states()).map(law).collect();
    let weighed = problem.with_growth(&laws, &paths);
    (change(problem, &weighed) > GROWTH.settled).then_some(GrownNoise {
        problem: weighed,
        estimated,
    })
}

/// Root mean square change of the logarithms of all relative noises.
fn change(before: &Problem, after: &Problem) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (a, b) in before.records.iter().zip(&after.records) {
        for (state, column) in a.measured.iter().enumerate() {
            let read = (0..column.len()).filter(|k| column[*k].is_finite());
            for k in read {
                let ratio = a.relative_noise_at(state, k) / b.relative_noise_at(state, k);
                sum += ratio.ln().powi(2);
                count += 1.0;
            }
        }
    }
    f64::sqrt(sum / f64::max(count, 1.0))
}

/// Readings of one state, sensor by sensor: squared residuals, with the squares of the fitted values.
struct Readings {
    sensors: Vec<Vec<(f64, f64)>>,
    /// Mean square of the fitted values.
    size: f64,
}

impl Readings {
    /// Readings with residuals from the given trajectories, without isolated outliers. `None` where there are too few readings, or the
    /// residuals are below the noise floor.
    fn new(
        problem: &Problem,
        paths: &[Vec<f64>],
        alone: Option<&[Vec<bool>]>,
        state: usize,
    ) -> Option<Readings> {
        let n = problem.states();
        let mut sensors = vec![Vec::new(); problem.sensors.count() / n.max(1)];
        for (r, (record, path)) in problem.records.iter().zip(paths).enumerate() {
            let outlier = |k: usize| alone.is_some_and(|alone| alone[r][k]);
            let read = record.measured[state].iter().enumerate();
            let used = read.filter(|(k, y)| y.is_finite() && !outlier(*k));
            let squares = used.map(|(k, y)| {
                let x = path[k * n + state];
                ((y - x).powi(2), x * x)
            });
            sensors[problem.sensors.group(r)].extend(squares);
        }
        // Residuals below the noise floor come from arithmetic, not from the sensor.
        let floor = final_floor(problem);
        for (group, readings) in sensors.iter_mut().enumerate() {
            let mean = mean(readings.iter().map(|(square, _)| *square));
            let least = GAUSS_NEWTON.state_step * floor[group * n + state];
            let least = least.max(RESIDUALS.arithmetic * problem.spread[state]);
            if readings.len() < GROWTH.min_readings || mean.sqrt() <= least {
                readings.clear();
            }
        }
        let size = mean(sensors.iter().flatten().map(|(_, value)| *value));
        (size > 0.0).then_some(Readings { sensors, size })
    }

    /// The law of noise of the largest likelihood, up to its level, and its gain over constant noise.
    fn growth(&self) -> Option<(SensorNoise, f64)> {
        let (least, most) = GROWTH.tried;
        let step = std::f64::consts::LN_10 / GROWTH.per_decade as f64;
        let steps = ((most / least).ln() / step).round() as usize;
        let tried = (0..=steps).map(|i| least.ln() + i as f64 * step);
        let value = |log: f64| self.deviance(log.exp());
        let best = tried.min_by(|a, b| value(*a).total_cmp(&value(*b)))?;
        let best = golden_section(&value, (best - step, best + step));
        let gain = self.deviance(0.0) - value(best);
        let share = best.exp() / self.size.sqrt();
        let law = SensorNoise { floor: 1.0, share };
        (gain > 0.0).then_some((law, gain))
    }

    /// −2 log likelihood with the level of each sensor profiled out; `growth` is the share at the root mean square value over the floor.
    fn deviance(&self, growth: f64) -> f64 {
        let scale = growth * growth / self.size;
        let of = |readings: &Vec<(f64, f64)>| {
            if readings.is_empty() {
                return 0.0;
            }
            let (mut sum, mut logs) = (0.0, 0.0);
            for (square, value) in readings {
                let variance = 1.0 + scale * value;
                sum += square / variance;
                logs += variance.ln();
            }
            let count = readings.len() as f64;
            count * (sum / count).max(f64::MIN_POSITIVE).ln() + logs
        };
        self.sensors.iter().map(of).sum()
    }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(s, n), x| (s + x, n + 1.0));
    sum / f64::max(count, 1.0)
}
