//! Measured trajectories → records: uninterrupted pieces with what is measured of the states, and what acts from outside.
//!
//! In: a dataset, a system. Out: [`Record`]s, or the signal that is missing. Numbers are as measured; nothing is smoothed here.

use super::system::System;
use crate::data::{self, Dataset, Trajectory};
use crate::lang::model::Between;
use crate::term::Signal;

/// One uninterrupted piece of a trajectory, M samples.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// Which trajectory it is of.
    pub trajectory: usize,
    /// Seconds. Length M.
    pub time: Vec<f64>,
    /// One column a state, each of length M; NaN where it was not measured.
    pub measured: Vec<Vec<f64>>,
    /// What acts from outside, by signal, each of length M.
    pub outside: Vec<Outside>,
}

/// A signal that acts from outside.
#[derive(Clone, Debug)]
pub struct Outside {
    pub values: Vec<f64>,
    /// A sample's value lasts until the next; otherwise it moves on a straight line.
    pub held: bool,
}

impl Record {
    pub fn len(&self) -> usize {
        self.time.len()
    }

    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// Value of an outside signal, a part of the way from sample `k` to the next.
    pub fn outside_at(&self, signal: usize, k: usize, part: f64) -> f64 {
        let Some(o) = self.outside.get(signal) else {
            return f64::NAN;
        };
        let here = o.values.get(k).copied().unwrap_or(f64::NAN);
        if o.held {
            return here;
        }
        let next = o.values.get(k + 1).copied().unwrap_or(here);
        here + part * (next - here)
    }
}

/// Fewest samples of a piece that says anything.
const FEWEST: usize = 4;

/// All pieces of all trajectories.
///
/// # Errors
/// A signal from outside, or every signal of a variable, that a trajectory does not have.
pub fn records(system: &System, dataset: &Dataset) -> Result<Vec<Record>, Signal> {
    let mut all = Vec::new();
    for (index, trajectory) in dataset.trajectories.iter().enumerate() {
        for law in &system.laws {
            let chain = system.states.iter().filter(|s| s.var == law.target.var);
            if !chain.clone().any(|s| trajectory.column(*s).is_some()) {
                return Err(Signal::new(law.target.var));
            }
        }
        for piece in data::pieces(&trajectory.time) {
            if piece.len() >= FEWEST {
                all.push(record(system, dataset, trajectory, index, piece)?);
            }
        }
    }
    Ok(all)
}

fn record(
    system: &System,
    dataset: &Dataset,
    trajectory: &Trajectory,
    index: usize,
    piece: std::ops::Range<usize>,
) -> Result<Record, Signal> {
    let cut = |s: Signal| -> Option<Vec<f64>> {
        if s == Signal::TIME {
            return trajectory.time.get(piece.clone()).map(<[f64]>::to_vec);
        }
        Some(trajectory.column(s)?.get(piece.clone())?.to_vec())
    };
    let length = piece.len();
    let mut outside = Vec::new();
    for signal in &system.outside {
        let mut values = cut(*signal).ok_or(*signal)?;
        let held = dataset.between(signal.var) == Some(Between::Hold) && signal.der == 0;
        if !bridge(&mut values, held) {
            return Err(*signal);
        }
        outside.push(Outside { values, held });
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
        outside,
    })
}

/// Fills missing values: with the last one if held, else on a straight line. False if there is none at all.
fn bridge(values: &mut [f64], held: bool) -> bool {
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
        let (a, b) = (pair[0], pair[1]);
        let (x, y) = (values[a], values[b]);
        for (i, value) in values[a + 1..b].iter_mut().enumerate() {
            let part = (i + 1) as f64 / (b - a) as f64;
            *value = if held { x } else { x + part * (y - x) };
        }
    }
    true
}
