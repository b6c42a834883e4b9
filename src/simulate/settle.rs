//! A start from noisy sensors, moved so that the free run follows the first readings.
//!
//! In: readings with their noise, a start, a function that simulates from one. Out: the start of least squares over as long a
//! stretch as the equations follow, with standard errors. The equations are taken as they are; a stretch that they do not follow
//! is given up, and with none the start stays as it was.

use nalgebra::{DMatrix, DVector};

use super::march::Rows;

/// Rows of the first stretch for each component that is free.
const ROWS: usize = 6;
/// Part of the record that may go into its start; of a short one so many rows, but no more than half.
const SHARE: usize = 10;
const FEW: usize = 100;
/// Root mean square of the residuals, in standard deviations of the noise, up to which equations follow.
const FOLLOWS: f64 = 1.5;
/// Gauss–Newton steps for one stretch.
const STEPS: usize = 12;
/// Step of a difference quotient, relative to the component's size: far above what integration leaves.
const STEP: f64 = 1e-6;

/// Simulates so many rows from a start; `None` if that fails.
pub(super) type Trial<'a> = &'a mut dyn FnMut(&[f64], usize) -> Option<Rows>;

/// What was read.
pub(super) struct Readings {
    /// Places of the signals in a simulated row, their readings by row of the leg (NaN: none), their noise.
    pub channels: Vec<(usize, Vec<f64>, f64)>,
    pub rows: usize,
}

pub(super) struct Settled {
    pub start: Vec<f64>,
    /// Standard errors of the free components; 0 for others.
    pub error: Vec<f64>,
    /// Rows that went into it.
    pub rows: usize,
}

/// Root mean square of what a start leaves over the first stretch, in standard deviations of the noise; `None` if it fails.
pub(super) fn left_by(readings: &Readings, start: &[f64], run: Trial) -> Option<f64> {
    let rows = (2 * ROWS).max(ROWS * start.len()).min(readings.rows);
    let left = residuals(readings, &run(start, rows)?, rows);
    (!left.is_empty()).then(|| left.norm() / (left.len() as f64).sqrt())
}

/// `free`: components to be moved, each with its size. `run(start, rows)` simulates so many rows, `None` if it fails.
pub(super) fn settle(
    readings: &Readings,
    start: &[f64],
    free: &[(usize, f64)],
    run: Trial,
) -> Option<Settled> {
    let most = (readings.rows / SHARE)
        .max(readings.rows.min(2 * FEW) / 2)
        .min(1000);
    let mut rows = (ROWS * free.len()).max(ROWS * 2);
    let mut best: Option<Settled> = None;
    while rows <= most {
        let from = best.as_ref().map_or(start, |b| &b.start);
        match fit(readings, from, free, rows, run) {
            Some(found) => best = Some(found),
            None => break,
        }
        rows *= 2;
    }
    best
}

/// Levenberg–Marquardt on one stretch; `None` if the equations do not follow it.
fn fit(
    readings: &Readings,
    start: &[f64],
    free: &[(usize, f64)],
    rows: usize,
    run: Trial,
) -> Option<Settled> {
    let mut x = start.to_vec();
    let mut left = residuals(readings, &run(&x, rows)?, rows);
    let mut damping = 1e-3;
    let mut normal = DMatrix::zeros(free.len(), free.len());
    for _ in 0..STEPS {
        let slopes = slopes(readings, &x, &left, free, rows, run)?;
        normal = slopes.transpose() * &slopes;
        let right = -(slopes.transpose() * &left);
        let mut damped = normal.clone();
        (0..free.len()).for_each(|i| damped[(i, i)] *= 1.0 + damping);
        let step = damped.cholesky()?.solve(&right);
        let mut trial = x.clone();
        for ((place, size), s) in free.iter().zip(step.iter()) {
            trial[*place] += size * s;
        }
        let after = run(&trial, rows).map(|path| residuals(readings, &path, rows));
        match after.filter(|a| a.norm_squared() < left.norm_squared()) {
            Some(after) => {
                let gained = 1.0 - after.norm_squared() / left.norm_squared();
                (x, left) = (trial, after);
                damping *= 0.1;
                if gained < 1e-4 {
                    break;
                }
            }
            None if damping > 1e6 || step.amax() < 1e-9 => break,
            None => damping *= 10.0,
        }
    }
    let count = left.len().checked_sub(free.len()).filter(|n| *n > 0)?;
    let scatter = (left.norm_squared() / count as f64).sqrt();
    if scatter.is_nan() || scatter > FOLLOWS {
        return None;
    }
    let covariance = normal.try_inverse()?;
    let mut error = vec![0.0; x.len()];
    for (i, (place, size)) in free.iter().enumerate() {
        error[*place] = size * covariance[(i, i)].max(0.0).sqrt() * scatter.max(1.0);
    }
    Some(Settled {
        start: x,
        error,
        rows,
    })
}

/// Simulated less read, in standard deviations.
fn residuals(readings: &Readings, path: &Rows, rows: usize) -> DVector<f64> {
    let mut out = Vec::new();
    for (place, values, sigma) in &readings.channels {
        for (s, m) in path.column(*place).zip(values).take(rows) {
            if m.is_finite() {
                out.push((s - m) / sigma);
            }
        }
    }
    DVector::from_vec(out)
}

/// Of the residuals by each free component, in its sizes.
fn slopes(
    readings: &Readings,
    x: &[f64],
    left: &DVector<f64>,
    free: &[(usize, f64)],
    rows: usize,
    run: Trial,
) -> Option<DMatrix<f64>> {
    let mut columns = Vec::new();
    for (place, size) in free {
        let mut moved = x.to_vec();
        moved[*place] += STEP * size;
        let there = residuals(readings, &run(&moved, rows)?, rows);
        if there.len() != left.len() {
            return None;
        }
        columns.push((there - left) / STEP);
    }
    Some(DMatrix::from_columns(&columns))
}
