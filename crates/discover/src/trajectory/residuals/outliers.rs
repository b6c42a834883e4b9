//! Outliers: isolated readings far from the fitted trajectory, beyond anything that noise explains.
//!
//! In: a problem and a fit. Out: their number and the worst, or the problem without them. A reading whose neighbours are off as well is
//! no outlier: there the laws are wrong.

use crate::trajectory::likelihood::Fit;
use crate::trajectory::model::{LeftOut, Problem};
use crate::trajectory::thresholds::RESIDUALS;

/// Standard deviation of a normal distribution over its median absolute deviation, 1/Φ⁻¹(3/4).
const SIGMA_OVER_MAD: f64 = 1.4826;

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

/// The outliers of one state, if they are more than a normal distribution gives.
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
    found.filter(|s| s.count as f64 > readings as f64 / RESIDUALS.readings_per_chance_outlier + 0.5)
}

/// The problem with exactly the outliers of this fit left out, earlier ones taken back in if they are none; `None` if that changes nothing.
pub fn leave_out(problem: &Problem, fit: &Fit) -> Option<Problem> {
    let mut records = problem.records.clone();
    for l in &problem.left_out {
        records[l.record].measured[l.state][l.sample] = l.value;
    }
    let mut out = Vec::new();
    for state in 0..problem.states() {
        let most = RESIDUALS.max_outliers * problem.readings_of(state) as f64;
        let mut own = Vec::new();
        let sigma = robust_sigma(problem, fit, state);
        for (record, read) in records.iter().enumerate() {
            let far = distances_of(
                problem,
                fit,
                (record, state),
                &read.measured[state],
                sigma[record],
            );
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
    let sigma = robust_sigma(problem, fit, state);
    let records = problem.records.iter().enumerate();
    records
        .map(|(r, record)| {
            distances_of(problem, fit, (r, state), &record.measured[state], sigma[r])
        })
        .collect()
}

fn distances_of(
    problem: &Problem,
    fit: &Fit,
    (record, state): (usize, usize),
    read: &[f64],
    sigma: f64,
) -> Vec<f64> {
    let n = problem.states();
    let path = &fit.paths()[record];
    let distance = |(k, y): (usize, &f64)| match y.is_finite() {
        true => (y - path[k * n + state]).abs() / sigma,
        false => 0.0,
    };
    read.iter().enumerate().map(distance).collect()
}

/// Robust standard deviation of a state's sensor for every record, from the median absolute residual of its group; ∞ where that is 0.
fn robust_sigma(problem: &Problem, fit: &Fit, state: usize) -> Vec<f64> {
    let n = problem.states();
    let groups = problem.sensors.count() / n.max(1);
    let mut left: Vec<Vec<f64>> = vec![Vec::new(); groups];
    for (r, (record, path)) in problem.records.iter().zip(fit.paths()).enumerate() {
        let read = record.measured[state].iter().enumerate();
        let own = read.map(|(k, y)| (y - path[k * n + state]).abs());
        left[problem.sensors.group(r)].extend(own.filter(|x| x.is_finite()));
    }
    let sigma: Vec<f64> = left
        .iter_mut()
        .map(|l| SIGMA_OVER_MAD * median(l))
        .collect();
    let of = |r: usize| Some(sigma[problem.sensors.group(r)]).filter(|s| *s > 0.0);
    (0..problem.records.len())
        .map(|r| of(r).unwrap_or(f64::INFINITY))
        .collect()
}

fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
