//! Readings that are no measurements: single ones far from what the laws say, beyond anything that noise explains.
//!
//! In: a problem and a fit, or the records alone. Out: how many there are and the worst; or the problem without them. A reading
//! whose neighbours are off as well is no stray: there the laws are wrong.

use super::fit::Fit;
use super::problem::Problem;
use super::record::Record;
use crate::data;

/// Robust standard deviations beyond which a reading is none.
const FAR: f64 = 5.0;
/// Its neighbours are nearer than this part of it.
const ALONE: f64 = 0.6;
/// Strays are few. A channel with more has another kind of noise.
const MOST: f64 = 0.2;
/// Standard deviation of a normal distribution over the median of its absolute value.
const NORMAL: f64 = 1.4826;
/// Readings beyond FAR that are so by chance: one of so many.
const CHANCE: f64 = 1.7e6;

/// A reading that was given no weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftOut {
    pub record: usize,
    pub state: usize,
    pub sample: usize,
    pub value: f64,
}

/// Strays among the readings of one state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strays {
    pub count: usize,
    /// The largest, in robust standard deviations.
    pub worst: f64,
    /// Where that is.
    pub trajectory: usize,
    /// Seconds.
    pub time: f64,
}

/// Takes readings out that a smooth curve through the others does not explain.
pub(super) fn leave_out_first(records: &mut [Record], declared: &[Option<f64>]) -> Vec<LeftOut> {
    let mut out = Vec::new();
    for (r, record) in records.iter_mut().enumerate() {
        let time = &record.time;
        for (state, column) in record.measured.iter_mut().enumerate() {
            let Some(smooth) = data::smooth(time, column, declared[state], &[], true) else {
                continue;
            };
            for sample in smooth.outliers {
                out.push(LeftOut {
                    record: r,
                    state,
                    sample,
                    value: std::mem::replace(&mut column[sample], f64::NAN),
                });
            }
        }
    }
    out
}

/// Strays of one state beyond what a normal distribution gives.
pub(super) fn strays(problem: &Problem, fit: &Fit, state: usize) -> Option<Strays> {
    let mut found: Option<Strays> = None;
    let readings = count(problem, state);
    for (r, far) in distances(problem, fit, state).into_iter().enumerate() {
        let record = &problem.records[r];
        for k in (0..far.len()).filter(|k| stray(&far, *k)) {
            let strays = found.get_or_insert(Strays {
                count: 0,
                worst: 0.0,
                trajectory: 0,
                time: 0.0,
            });
            strays.count += 1;
            if far[k] > strays.worst {
                strays.worst = far[k];
                strays.trajectory = record.trajectory;
                strays.time = record.time[k];
            }
        }
    }
    found.filter(|s| s.count as f64 > readings as f64 / CHANCE + 0.5)
}

/// The problem with exactly those readings left out that a fit does not explain; `None` if they are those left out already.
pub fn leave_out(problem: &Problem, fit: &Fit) -> Option<Problem> {
    let mut records = problem.records.clone();
    for l in &problem.left_out {
        records[l.record].measured[l.state][l.sample] = l.value;
    }
    let mut out = Vec::new();
    for state in 0..problem.states() {
        let most = MOST * count(problem, state) as f64;
        let mut own = Vec::new();
        let sigma = robust(problem, fit, state);
        for (record, read) in records.iter().enumerate() {
            let far = along(
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
            let gone = |k: &usize| stray(&far, *k) || (far[*k] > FAR && before(*k));
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
    Some(problem.anew(records, out))
}

fn count(problem: &Problem, state: usize) -> usize {
    let own = problem.readings.iter().skip(state);
    own.step_by(problem.states().max(1)).sum()
}

fn stray(far: &[f64], k: usize) -> bool {
    let near = |i: Option<usize>| i.and_then(|i| far.get(i)).copied().unwrap_or(0.0);
    far[k] > FAR && near(k.checked_sub(1)).max(near(Some(k + 1))) < ALONE * far[k]
}

/// Distances of all readings of a state from the fit in robust standard deviations, record by record; 0 where there is none.
fn distances(problem: &Problem, fit: &Fit, state: usize) -> Vec<Vec<f64>> {
    let sigma = robust(problem, fit, state);
    let records = problem.records.iter().enumerate();
    records
        .map(|(r, record)| along(problem, fit, (r, state), &record.measured[state], sigma[r]))
        .collect()
}

fn along(
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

/// Robust noise of a state's sensor in every record: from the median of what a fit leaves in its group. ∞ where that is nothing.
fn robust(problem: &Problem, fit: &Fit, state: usize) -> Vec<f64> {
    let n = problem.states();
    let groups = problem.sensors.count() / n.max(1);
    let mut left: Vec<Vec<f64>> = vec![Vec::new(); groups];
    for (r, (record, path)) in problem.records.iter().zip(fit.paths()).enumerate() {
        let read = record.measured[state].iter().enumerate();
        let own = read.map(|(k, y)| (y - path[k * n + state]).abs());
        left[problem.sensors.group(r)].extend(own.filter(|x| x.is_finite()));
    }
    let sigma: Vec<f64> = left.iter_mut().map(|l| NORMAL * median(l)).collect();
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
