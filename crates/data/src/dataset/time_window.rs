//! A window of time, kept of every trajectory.
//!
//! In: a dataset and a window. Out: the dataset with only the rows in it.

use super::trajectories::{Dataset, Trajectory};
use sidc_lang::diagnostic::Diagnostic;

/// First and last time, seconds; an absent end is open.
pub type Window = (Option<f64>, Option<f64>);

/// Keeps the rows with `from ≤ t ≤ to`. Returns `empty-window` if there are none.
pub fn keep_window(dataset: &mut Dataset, (from, to): Window) -> Option<Diagnostic> {
    let (from, to) = (
        from.unwrap_or(f64::NEG_INFINITY),
        to.unwrap_or(f64::INFINITY),
    );
    if from == f64::NEG_INFINITY && to == f64::INFINITY {
        return None;
    }
    let whole = span(dataset);
    dataset
        .trajectories
        .iter_mut()
        .for_each(|t| cut(t, from, to));
    let left: usize = dataset.trajectories.iter().map(Trajectory::len).sum();
    (left == 0).then(|| {
        let d = Diagnostic::error(
            "empty-window",
            format!("no rows have times from {from} to {to}"),
        );
        match whole {
            Some((a, b)) => d.fact(format!("the data run from t = {a} to t = {b}")),
            None => d,
        }
    })
}

fn cut(t: &mut Trajectory, from: f64, to: f64) {
    let kept: Vec<usize> = (0..t.time.len())
        .filter(|&i| from <= t.time[i] && t.time[i] <= to)
        .collect();
    let pick = |v: &mut Vec<f64>| *v = kept.iter().map(|&i| v[i]).collect();
    t.columns.iter_mut().for_each(|(_, v)| pick(v));
    pick(&mut t.time);
}

fn span(dataset: &Dataset) -> Option<(f64, f64)> {
    let times = || {
        dataset
            .trajectories
            .iter()
            .flat_map(|t| t.time.iter().copied())
    };
    Some((times().reduce(f64::min)?, times().reduce(f64::max)?))
}
