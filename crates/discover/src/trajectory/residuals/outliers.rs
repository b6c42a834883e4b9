//! Outliers: isolated readings far from the fitted trajectory, beyond anything that noise explains.
//!
//! In: a problem and a fit. Out: their number and the worst, or the problem without them. A reading whose neighbours are off as well is
//! no outlier: there the laws are wrong.

use sidc_data::{MEDIAN_OF_ABS_NORMAL, median};
use std::f64::consts::PI;

use crate::trajectory::likelihood::{Fit, final_floor};
use crate::trajectory::model::{LeftOut, Problem};
use crate::trajectory::thresholds::RESIDUALS;

/// Outliers among the readings of one state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outliers {
    pub count: usize,
    /// The largest, in robust standard deviations.
    pub worst: f64,
    /// The trajectory of the largest.
    pub trajectory: usize,
    /// Its instant, seconds.
    pub time: f64,
}

/// The outliers of one state, if they are more, or one is farther, than a normal distribution gives.
pub(crate) fn outliers(problem: &Problem, fit: &Fit, state: usize) -> Option<Outliers> {
    let mut found: Option<Outliers> = None;
    let readings = problem.readings_of(state);
    for (r, far) in distances(problem, fit, state).into_iter().enumerate() {
        let record = &problem.records[r];
        for k in (0..far.len()).filter(|k| is_outlier(&far, *k)) {
            let outliers = found.get_or_insert(Outliers {
                count: 0,
                worst: 0.0,
                trajectory: 0,
                time: 0.0,
            });
            outliers.count += 1;
            if far[k] > outliers.worst {
                outliers.worst = far[k];
                outliers.trajectory = record.trajectory;
                outliers.time = record.time[k];
            }
        }
    }
    found.filter(|o| by_chance(readings as f64, o) < RESIDUALS.outliers_by_chance)
}

/// Bounds of the probability that a normal distribution gives as many outliers, by the terms of Poisson's, and one as far, by Mills' ratio:
/// the smaller of the two.
fn by_chance(readings: f64, found: &Outliers) -> f64 {
    let beyond = |d: f64| readings * (-0.5 * d * d).exp() / (d * (0.5 * PI).sqrt());
    let expected = beyond(RESIDUALS.outlier);
    let as_many: f64 = (1..=found.count).map(|k| expected / k as f64).product();
    as_many.min(beyond(found.worst))
}

/// Whether each reading of a state is an outlier: far from the fit, while its neighbours are not. By record and sample.
pub(super) fn far_alone(problem: &Problem, fit: &Fit, state: usize) -> Vec<Vec<bool>> {
    let all = distances(problem, fit, state).into_iter();
    all.map(|far| (0..far.len()).map(|k| is_outlier(&far, k)).collect())
        .collect()
}

/// The problem without the outliers of this fit. Readings left out before are taken back in unless they are still far from the fit; none
/// are left out of a state with too many outliers. `None` if nothing changes.
pub fn leave_out(problem: &Problem, fit: &Fit) -> Option<Problem> {
    let mut records = problem.records.clone();
    for l in &problem.left_out {
        records[l.record].measured[l.state][l.sample] = l.value;
    }
    let mut out = Vec::new();
    for state in 0..problem.states() {
        let most = RESIDUALS.max_outliers * problem.readings_of(state) as f64;
        let mut own = Vec::new();
        let scale = Scale::new(problem, fit, state);
        for (record, read) in records.iter().enumerate() {
            let far = scale.distances(problem, fit, (record, state), &read.measured[state]);
            let before = |k: usize| {
                let same = |l: &&LeftOut| (l.record, l.state, l.sample) == (record, state, k);
                problem.left_out.iter().any(|l| same(&l))
            };
            let gone =
                |k: &usize| is_outlier(&far, *k) || (far[*k] > RESIDUALS.outlier && before(*k));
            own.extend((0..far.len()).filter(gone).map(|sample| LeftOut {
                record,
                state,
                sample,
                value: read.measured[state][sample],
            }));
        }
        if own.len() as f64 <= most {
            out.extend(own);
        }
    }
    let place = |l: &LeftOut| (l.record, l.state, l.sample);
    let mut known: Vec<_> = problem.left_out.iter().map(place).collect();
    let mut new: Vec<_> = out.iter().map(place).collect();
    known.sort_unstable();
    new.sort_unstable();
    if known == new {
        return None;
    }
    for l in &out {
        records[l.record].measured[l.state][l.sample] = f64::NAN;
    }
    Some(problem.with_records(records, out))
}

fn is_outlier(far: &[f64], k: usize) -> bool {
    let near = |i: Option<usize>| i.and_then(|i| far.get(i)).copied().unwrap_or(0.0);
    far[k] > RESIDUALS.outlier
        && near(k.checked_sub(1)).max(near(Some(k + 1))) < RESIDUALS.neighbours * far[k]
}

/// Distances of all readings of a state from the fit in robust standard deviations, record by record; 0 where there is no reading.
fn distances(problem: &Problem, fit: &Fit, state: usize) -> Vec<Vec<f64>> {
    let scale = Scale::new(problem, fit, state);
    let records = problem.records.iter().enumerate();
    records
        .map(|(r, record)| scale.distances(problem, fit, (r, state), &record.measured[state]))
        .collect()
}

/// The usual distance of one state's readings from the fit.
struct Scale {
    /// Robust standard deviation of every record's sensor.
    records: Vec<f64>,
    /// Deviations of readings over their relative noise, each with the value of the trajectory there, rising by that value.
    by_value: Vec<(f64, f64)>,
}

impl Scale {
    fn new(problem: &Problem, fit: &Fit, state: usize) -> Scale {
        let n = problem.states();
        let mut by_value = Vec::new();
        for (record, path) in problem.records.iter().zip(fit.paths()) {
            let values = path.iter().skip(state).step_by(n);
            let read = record.measured[state].iter().zip(values).enumerate();
            let own =
                read.map(|(k, (y, x))| (*x, (y - x).abs() / record.relative_noise_at(state, k)));
            by_value.extend(own.filter(|(_, d)| d.is_finite()));
        }
        by_value.sort_by(|a, b| a.0.total_cmp(&b.0));
        Scale {
            records: robust_sigma(problem, fit, state),
            by_value,
        }
    }

    /// Distances of a record's readings in standard deviations: those of its sensor, or, where these are larger, of the readings around it
    /// in time or in value, since noise may change along a record and grow with the signal.
    fn distances(
        &self,
        problem: &Problem,
        fit: &Fit,
        (record, state): (usize, usize),
        read: &[f64],
    ) -> Vec<f64> {
        let n = problem.states();
        let (path, noise) = (&fit.paths()[record], &problem.records[record]);
        let left: Vec<f64> = read
            .iter()
            .enumerate()
            .map(|(k, y)| (y - path[k * n + state]).abs() / noise.relative_noise_at(state, k))
            .collect();
        let distance = |(k, d): (usize, &f64)| {
            if !d.is_finite() {
                return 0.0;
            }
            let far = d / self.records[record];
            // Only distant readings are compared with those around them, which takes time.
            match far > RESIDUALS.outlier {
                true => {
                    d / self
                        .around(&left, k, path[k * n + state])
                        .max(self.records[record])
                }
                false => far,
            }
        };
        left.iter().enumerate().map(distance).collect()
    }

    /// The larger of the robust standard deviations of the nearest readings in time and in value.
    fn around(&self, left: &[f64], k: usize, value: f64) -> f64 {
        let near = RESIDUALS.around / 2;
        let times = k.saturating_sub(near)..(k + near + 1).min(left.len());
        let mut in_time: Vec<f64> = left[times]
            .iter()
            .copied()
            .filter(|x| x.is_finite())
            .collect();
        let at = self.by_value.partition_point(|(x, _)| *x < value);
        let values = at.saturating_sub(near)..(at + near + 1).min(self.by_value.len());
        let mut in_value: Vec<f64> = self.by_value[values].iter().map(|(_, d)| *d).collect();
        deviation(&mut in_time).max(deviation(&mut in_value))
    }
}

/// Robust standard deviation of a state's sensor for every record, from the median absolute residual of its group; ∞ where that is 0. Never
/// below the noise under which a closer fit is no evidence: the trajectory was not held to the readings more closely than that.
fn robust_sigma(problem: &Problem, fit: &Fit, state: usize) -> Vec<f64> {
    let n = problem.states();
    let groups = problem.sensors.count() / n.max(1);
    let mut left: Vec<Vec<f64>> = vec![Vec::new(); groups];
    for (r, (record, path)) in problem.records.iter().zip(fit.paths()).enumerate() {
        let read = record.measured[state].iter().enumerate();
        let own =
            read.map(|(k, y)| (y - path[k * n + state]).abs() / record.relative_noise_at(state, k));
        left[problem.sensors.group(r)].extend(own.filter(|x| x.is_finite()));
    }
    let floor = final_floor(problem);
    let sigma: Vec<f64> = left
        .iter_mut()
        .enumerate()
        .map(|(group, l)| {
            let least = floor.get(group * n + state).copied().unwrap_or(0.0);
            deviation(l).max(least)
        })
        .collect();
    let of = |r: usize| Some(sigma[problem.sensors.group(r)]).filter(|s| *s > 0.0);
    (0..problem.records.len())
        .map(|r| of(r).unwrap_or(f64::INFINITY))
        .collect()
}

/// The standard deviation that distances tell of, fewer than half of them outliers; 0 without any.
pub(super) fn deviation(distances: &mut [f64]) -> f64 {
    median(distances).unwrap_or(0.0) / MEDIAN_OF_ABS_NORMAL
}

#[cfg(test)]
mod tests {
    use super::{Outliers, by_chance};

    #[test]
    fn chance_is_that_of_a_normal_distribution() {
        let found = |count, worst| Outliers {
            count,
            worst,
            trajectory: 0,
            time: 0.0,
        };
        // 2 Φ(−5) = 5.733e-7; the bound is 4 % higher.
        let one = by_chance(2000.0, &found(1, 5.0));
        assert!((1.0..1.05).contains(&(one / 1.1466e-3)), "{one}");
        // 2 Φ(−6) = 1.973e-9
        let far = by_chance(2000.0, &found(1, 6.0));
        assert!((1.0..1.05).contains(&(far / 3.946e-6)), "{far}");
        // At 1.74 million readings one is expected, and four come by chance in one of 53 records.
        let four = by_chance(1.744e6, &found(4, 5.2));
        assert!((0.019..0.06).contains(&four), "{four}");
    }
}
