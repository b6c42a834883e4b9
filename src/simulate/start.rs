//! Where a leg starts: what was read there, smoothed where sensors are noisy, estimated where nothing was read.
//!
//! In: a model, one leg's trajectory, the components of the state. Out: candidates for every row, of which the first row that
//! has them all becomes the start. Knows no equations.

use std::ops::ControlFlow;

use super::run::{Origin, Start};
use super::score::deviation;
use crate::data::{self, Dataset, Trajectory};
use crate::lang::model::Model;
use crate::term::Signal;

/// Noise over spread below which readings count as clean, as in `identify`.
const CLEAN: f64 = 1e-6;

/// One component of the state along a leg: what its value would be if the leg started there.
#[derive(Clone, Debug)]
pub(super) struct Component {
    pub signal: Signal,
    pub origin: Origin,
    /// NaN where unknown.
    values: Vec<f64>,
    error: Option<Vec<f64>>,
}

/// A sensor's noise, as far as it is more than rounding.
#[derive(Clone, Debug)]
pub(super) struct Noise {
    pub signal: Signal,
    pub sigma: f64,
    /// Rows whose readings are no measurements.
    pub outliers: Vec<usize>,
}

/// All components; `Err` is one that nobody measured and that cannot be estimated.
pub(super) fn components(
    model: &Model,
    leg: &Dataset,
    state: &[Signal],
    given: &[(Signal, f64)],
) -> Result<(Vec<Component>, Vec<Noise>), Signal> {
    let Some(trajectory) = leg.trajectories.first() else {
        return Ok(Default::default());
    };
    let mut noise = Vec::new();
    let mut out = Vec::new();
    for signal in state {
        if let Some((_, value)) = given.iter().find(|(s, _)| s == signal) {
            out.push(Component {
                signal: *signal,
                origin: Origin::Given,
                values: vec![*value; trajectory.len()],
                error: None,
            });
            continue;
        }
        out.push(component(model, leg, trajectory, *signal, &mut noise).ok_or(*signal)?);
    }
    Ok((out, noise))
}

fn component(
    model: &Model,
    leg: &Dataset,
    trajectory: &Trajectory,
    signal: Signal,
    noise: &mut Vec<Noise>,
) -> Option<Component> {
    let read = (0..=signal.der).rev().find_map(|der| {
        let below = Signal { der, ..signal };
        let values = trajectory.column(below)?;
        values
            .iter()
            .any(|v| v.is_finite())
            .then_some((below, values))
    });
    let (below, values) = read?;
    let order = usize::from(signal.der - below.der);
    let smooth = match model.discrete {
        true => None,
        false => smoothed(model, leg, trajectory, below, values),
    };
    if let Some(s) = smooth {
        if !noise.iter().any(|n| n.signal == below) {
            noise.push(Noise {
                signal: below,
                sigma: s.sigma,
                outliers: s.outliers.clone(),
            });
        }
        let rows = [&s.values, &s.slope, &s.curvature];
        if let (Some(found), Some(error)) = (rows.get(order), s.error.get(order)) {
            // Before its first reading a smoothed signal is a guess.
            let first = values.iter().position(|v| v.is_finite()).unwrap_or(0);
            let known = found.iter().enumerate();
            return Some(Component {
                signal,
                origin: Origin::Smoothed,
                values: known
                    .map(|(i, v)| if i < first { f64::NAN } else { *v })
                    .collect(),
                error: Some(error.clone()),
            });
        }
    }
    if order == 0 {
        return Some(Component {
            signal,
            origin: Origin::Measured,
            values: values.to_vec(),
            error: None,
        });
    }
    let (values, error) = series(model, leg, signal)?;
    Some(Component {
        signal,
        origin: Origin::Differentiated,
        values,
        error: Some(error),
    })
}

/// The smoothed signal, if its noise is material.
fn smoothed(
    model: &Model,
    leg: &Dataset,
    trajectory: &Trajectory,
    signal: Signal,
    values: &[f64],
) -> Option<data::Smoothed> {
    let breaks = data::breaks(model, leg, trajectory, signal);
    let sigma = model.noise(signal);
    let found = data::smooth(&trajectory.time, values, sigma, &breaks, true)?;
    (found.lambda > 0.0 && found.sigma > CLEAN * deviation(values)).then_some(found)
}

/// A signal along a leg as `identify` would have it, measured or differentiated, with its errors; NaN where unknown.
pub(super) fn series(model: &Model, leg: &Dataset, signal: Signal) -> Option<(Vec<f64>, Vec<f64>)> {
    let trajectory = leg.trajectories.first()?;
    let go_on = &mut |_| ControlFlow::Continue(());
    let (samples, _, _) = data::samples(model, leg, &[signal], go_on);
    let column = samples.column(signal)?;
    let mut values = vec![f64::NAN; trajectory.len()];
    let mut errors = vec![0.0; trajectory.len()];
    for (k, t) in samples.time.iter().enumerate() {
        let row = trajectory.time.partition_point(|s| s < t);
        let (Some(value), Some(error)) = (values.get_mut(row), errors.get_mut(row)) else {
            continue;
        };
        *value = column.values.get(k).copied().unwrap_or(f64::NAN);
        if let data::Origin::Estimated { error: all, .. } = &column.origin {
            *error = all.get(k).copied().unwrap_or(f64::NAN);
        }
    }
    Some((values, errors))
}

/// The first row from `from` on at which every component is known.
pub(super) fn first_row(components: &[Component], rows: usize, from: usize) -> Option<usize> {
    let known = |c: &Component, i: usize| c.values.get(i).is_some_and(|v| v.is_finite());
    (from..rows).find(|i| components.iter().all(|c| known(c, *i)))
}

/// The start at a row.
pub(super) fn at_row(components: &[Component], row: usize) -> Vec<Start> {
    let each = components.iter().map(|c| Start {
        signal: c.signal,
        value: c.values.get(row).copied().unwrap_or(f64::NAN),
        origin: c.origin,
        error: c.error.as_ref().and_then(|e| e.get(row)).copied(),
    });
    each.collect()
}
