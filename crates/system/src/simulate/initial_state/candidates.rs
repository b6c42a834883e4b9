//! Candidates for the initial state: readings, smoothed where sensors are noisy, derivatives estimated where none were
//! read.
//!
//! In: a model, one leg's trajectory, the components of the state. Out: candidates for every row; the first row at
//! which all are known becomes the start. Knows no equations.

use crate::simulate::thresholds::INITIAL_STATE;

use crate::discovery::Discovery;
use crate::simulate::run::{Origin, Start};
use crate::simulate::scores::goodness_of_fit::deviation;
use sidc_data as data;
use sidc_data::{Dataset, Trajectory};
use sidc_lang::model::Model;
use sidc_lang::term::Signal;
use sidc_progress::Unwatched;

/// One component of the state: its value at every row of a leg.
#[derive(Clone, Debug)]
pub(crate) struct Component {
    pub signal: Signal,
    pub origin: Origin,
    /// NaN where unknown.
    values: Vec<f64>,
    error: Option<Vec<f64>>,
}

/// A sensor whose noise is more than rounding.
#[derive(Clone, Debug)]
pub(crate) struct Noise {
    pub signal: Signal,
    pub sigma: f64,
    /// Rows whose readings are outliers.
    pub outliers: Vec<usize>,
}

/// Candidates for the initial state of a leg.
#[derive(Clone, Debug, Default)]
pub(crate) struct Candidates {
    /// As read; derivatives by differentiation.
    pub raw: Vec<Component>,
    /// The same with noisy signals smoothed; empty if no sensor is noisy.
    pub smooth: Vec<Component>,
    pub noise: Vec<Noise>,
}

/// All components. `Err` is one that was not measured and cannot be estimated.
pub(crate) fn candidates(
    (d, model): (&Discovery, &Model),
    leg: &Dataset,
    state: &[Signal],
    given: &[(Signal, f64)],
) -> Result<Candidates, Signal> {
    let mut out = Candidates::default();
    let Some(trajectory) = leg.trajectories.first() else {
        return Ok(out);
    };
    for signal in state {
        if let Some((_, value)) = given.iter().find(|(s, _)| s == signal) {
            out.raw.push(Component {
                signal: *signal,
                origin: Origin::Given,
                values: vec![*value; trajectory.len()],
                error: None,
            });
            out.smooth.extend(out.raw.last().cloned());
            continue;
        }
        if let Some((mean, deviation)) = d.hidden_course(*signal) {
            out.raw.push(Component {
                signal: *signal,
                origin: Origin::Hidden,
                values: vec![mean; trajectory.len()],
                error: Some(vec![deviation; trajectory.len()]),
            });
            out.smooth.extend(out.raw.last().cloned());
            continue;
        }
        let raw = raw(model, leg, trajectory, *signal).ok_or(*signal)?;
        let smooth = smooth(model, leg, trajectory, *signal, &mut out.noise);
        out.smooth.push(smooth.unwrap_or_else(|| raw.clone()));
        out.raw.push(raw);
    }
    if out.raw.iter().any(|c| c.origin == Origin::Hidden) {
        let clean = clean_readings(trajectory, &out.raw, &out.noise);
        out.noise.extend(clean);
    }
    if out.noise.is_empty() {
        out.smooth.clear();
    }
    Ok(out)
}

/// Channels of readings without noise: they determine hidden states, too, and count with the least noise that is
/// distinguished from none.
fn clean_readings(trajectory: &Trajectory, raw: &[Component], noise: &[Noise]) -> Vec<Noise> {
    let read = raw.iter().filter(|c| c.origin == Origin::Measured);
    let clean = read.filter(|c| noise.iter().all(|n| n.signal != c.signal));
    let noise = clean.filter_map(|c| {
        let spread = deviation(trajectory.column(c.signal)?);
        let sigma = INITIAL_STATE.clean * spread;
        (sigma > 0.0).then(|| Noise {
            signal: c.signal,
            sigma,
            outliers: Vec::new(),
        })
    });
    noise.collect()
}

fn raw(model: &Model, leg: &Dataset, trajectory: &Trajectory, signal: Signal) -> Option<Component> {
    let finite = |v: &&[f64]| v.iter().any(|v| v.is_finite());
    if let Some(values) = trajectory.column(signal).filter(finite) {
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

/// A component from smoothing the signal itself or the nearest lower derivative, if that is noisy.
fn smooth(
    model: &Model,
    leg: &Dataset,
    trajectory: &Trajectory,
    signal: Signal,
    noise: &mut Vec<Noise>,
) -> Option<Component> {
    if model.discrete {
        return None;
    }
    let mut below = (0..=signal.der).rev().map(|der| Signal { der, ..signal });
    let (below, values) = below.find_map(|b| {
        let values = trajectory.column(b)?;
        let known = values.iter().any(|v| v.is_finite());
        known.then_some((b, values))
    })?;
    let order = usize::from(signal.der - below.der);
    let s = smoothed(model, leg, trajectory, below, values)?;
    if !noise.iter().any(|n| n.signal == below) {
        noise.push(Noise {
            signal: below,
            sigma: s.sigma,
            outliers: s.outliers.clone(),
        });
    }
    let rows = [&s.values, &s.slope, &s.curvature];
    let (found, error) = rows.get(order).zip(s.error.get(order))?;
    // Before the first reading smoothing extrapolates, which is no estimate.
    let first = values.iter().position(|v| v.is_finite()).unwrap_or(0);
    let known = found.iter().enumerate();
    Some(Component {
        signal,
        origin: Origin::Smoothed,
        values: known
            .map(|(i, v)| if i < first { f64::NAN } else { *v })
            .collect(),
        error: Some(error.clone()),
    })
}

/// The smoothed signal, if its noise matters.
fn smoothed(
    model: &Model,
    leg: &Dataset,
    trajectory: &Trajectory,
    signal: Signal,
    values: &[f64],
) -> Option<data::Smoothed> {
    let breaks = data::breaks(model, leg, trajectory, signal);
    let sigma = model.noise(signal).map(|noise| noise.rms(values));
    let found = data::smooth(&trajectory.time, values, sigma, &breaks, true)?;
    let spread = deviation(values);
    let size = values.iter().filter(|v| v.is_finite());
    let size = size.fold(0.0, |m: f64, v| m.max(v.abs()));
    // The residual of a signal that does not move is rounding.
    let moves = spread > 1e-12 * size;
    (moves && found.lambda > 0.0 && found.sigma > INITIAL_STATE.clean * spread).then_some(found)
}

/// A signal along a leg as `identify` estimates it, with its errors; NaN where unknown.
pub(crate) fn series(model: &Model, leg: &Dataset, signal: Signal) -> Option<(Vec<f64>, Vec<f64>)> {
    let trajectory = leg.trajectories.first()?;
    let (samples, _, _) = data::samples(model, leg, &[signal], &mut Unwatched);
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
pub(crate) fn first_row(components: &[Component], rows: usize, from: usize) -> Option<usize> {
    let known = |c: &Component, i: usize| c.values.get(i).is_some_and(|v| v.is_finite());
    (from..rows).find(|i| components.iter().all(|c| known(c, *i)))
}

/// The components at a row.
pub(crate) fn at_row(components: &[Component], row: usize) -> Vec<Start> {
    let each = components.iter().map(|c| Start {
        signal: c.signal,
        value: c.values.get(row).copied().unwrap_or(f64::NAN),
        origin: c.origin,
        error: c.error.as_ref().and_then(|e| e.get(row)).copied(),
    });
    each.collect()
}
