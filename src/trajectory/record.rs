//! Measured trajectories → records: uninterrupted pieces with what is measured of the states, and what acts from outside.
//!
//! In: a dataset, a system. Out: [`Record`]s, or the signal that is missing. Numbers are as measured, but for states without a law:
//! nothing estimates their noise later, so they are smoothed before they act.

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

/// What is known of sensors beforehand.
pub struct Sensor<'a> {
    /// Noise as the model states it.
    pub declared: &'a dyn Fn(Signal) -> Option<f64>,
    /// Readings far from the others have no weight.
    pub robust: bool,
}

/// Fewest samples of a piece that says anything.
const FEWEST: usize = 4;

/// All pieces of all trajectories.
///
/// # Errors
/// A signal from outside, or every signal of a variable, that a trajectory does not have.
pub fn records(system: &System, dataset: &Dataset, sensor: &Sensor) -> Result<Vec<Record>, Signal> {
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
                all.push(record(system, dataset, sensor, (index, trajectory), piece)?);
            }
        }
    }
    Ok(all)
}

fn record(
    system: &System,
    dataset: &Dataset,
    sensor: &Sensor,
    (index, trajectory): (usize, &Trajectory),
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
    for (signal, driven) in system.outside.iter().zip(&system.driven) {
        let time = trajectory.time.get(piece.clone()).unwrap_or(&[]);
        let smoothed = match driven {
            true => smoothed(*signal, time, &cut, sensor),
            false => None,
        };
        let mut values = smoothed.or_else(|| cut(*signal)).ok_or(*signal)?;
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

/// A signal of a state without a law: smoothed, or the derivative of what is.
fn smoothed(
    signal: Signal,
    time: &[f64],
    cut: &dyn Fn(Signal) -> Option<Vec<f64>>,
    sensor: &Sensor,
) -> Option<Vec<f64>> {
    let lower = |steps: u8| {
        Some(Signal::derivative(
            signal.var,
            signal.der.checked_sub(steps)?,
        ))
    };
    let (steps, from, values) =
        (0..=2).find_map(|steps| Some((steps, lower(steps)?, cut(lower(steps)?)?)))?;
    let smooth = data::smooth(time, &values, (sensor.declared)(from), &[], sensor.robust)?;
    Some(match steps {
        0 => smooth.values,
        1 => smooth.slope,
        _ => smooth.curvature,
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
