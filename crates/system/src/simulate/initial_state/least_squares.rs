//! Initial states by least squares: the start from which a free run follows the first noisy readings best.
//!
//! In: readings with their noise, a first estimate, a function that simulates. The estimate may contain more than the state: samples
//! before it, each with its own reading. Out: the estimate over the longest stretch that the equations follow, with standard errors. The
//! equations stay as they are. If they follow no stretch to within the noise, the shortest is used: its readings together still tell more
//! than the first alone.

use crate::simulate::thresholds::INITIAL_STATE;
use nalgebra::{DMatrix, DVector};

use crate::simulate::integrate::trajectory::Rows;

/// Simulates so many rows from an initial state; `None` if that fails.
pub(crate) type Trial<'a> = &'a mut dyn FnMut(&[f64], usize) -> Option<Rows>;

/// The readings to be followed.
pub(crate) struct Readings {
    /// Column in a simulated row, readings by row of the leg (NaN: none), standard deviation of the noise.
    pub channels: Vec<(usize, Vec<f64>, f64)>,
    /// Estimated components that no simulated row shows, each with a reading or prior of its own: index, value, standard deviation.
    pub before: Vec<(usize, f64, f64)>,
    pub rows: usize,
}

impl Readings {
    /// Multiplies the noise of all readings by a factor.
    pub fn scale_noise(&mut self, factor: f64) {
        self.channels.iter_mut().for_each(|c| c.2 *= factor);
        self.before.iter_mut().for_each(|b| b.2 *= factor);
    }
}

/// Rows of the shortest stretch for so many components.
pub(crate) fn shortest(components: usize) -> usize {
    INITIAL_STATE.rows_a_component * components.max(2)
}

pub(crate) struct FittedStart {
    pub start: Vec<f64>,
    /// Standard errors of the free components; 0 for the others.
    pub error: Vec<f64>,
    /// Rows that were fitted.
    pub rows: usize,
    /// Whether the equations follow these to within the noise.
    followed: bool,
}

/// Root mean square of the residuals over the first stretch, in standard deviations of the noise; `None` if the run
/// fails.
pub(crate) fn rms_residual(readings: &Readings, start: &[f64], run: Trial) -> Option<f64> {
    let rows = shortest(start.len()).min(readings.rows);
    let left = residuals(readings, start, &run(start, rows)?, rows);
    (!left.is_empty()).then(|| left.norm() / (left.len() as f64).sqrt())
}

/// Fits over stretches that double in length. `free`: components to be estimated, each with its typical size.
pub(crate) fn fit_initial_state(
    readings: &Readings,
    start: &[f64],
    free: &[(usize, f64)],
    run: Trial,
) -> Option<FittedStart> {
    let most = (readings.rows / INITIAL_STATE.record_part)
        .max(readings.rows.min(2 * INITIAL_STATE.short_record) / 2)
        .min(INITIAL_STATE.longest_stretch);
    let mut rows = shortest(free.len());
    let mut best: Option<FittedStart> = None;
    while rows <= most {
        let from = best.as_ref().map_or(start, |b| &b.start);
        match fit(readings, from, free, rows, run) {
            Some(found) if found.followed => best = Some(found),
            found => {
                best = best.or(found);
                break;
            }
        }
        rows *= 2;
    }
    best
}

/// Levenberg–Marquardt on one stretch; `None` if the equations cannot be run along it.
fn fit(
    readings: &Readings,
    start: &[f64],
    free: &[(usize, f64)],
    rows: usize,
    run: Trial,
) -> Option<FittedStart> {
    let mut x = start.to_vec();
    let mut left = residuals(readings, &x, &run(&x, rows)?, rows);
    let mut damping = 1e-3;
    let mut normal = DMatrix::zeros(free.len(), free.len());
    for _ in 0..INITIAL_STATE.iterations {
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
        let after = run(&trial, rows).map(|path| residuals(readings, &trial, &path, rows));
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
    if !scatter.is_finite() {
        return None;
    }
    let covariance = normal.try_inverse()?;
    let mut error = vec![0.0; x.len()];
    for (i, (place, size)) in free.iter().enumerate() {
        error[*place] = size * covariance[(i, i)].max(0.0).sqrt() * scatter.max(1.0);
    }
    Some(FittedStart {
        start: x,
        error,
        rows,
        followed: scatter <= INITIAL_STATE.follows,
    })
}

/// Simulated minus measured, in standard deviations of the noise.
fn residuals(readings: &Readings, x: &[f64], path: &Rows, rows: usize) -> DVector<f64> {
    let before = readings.before.iter();
    let off =
        |(place, reading, sigma): &(usize, f64, f64)| Some((x.get(*place)? - reading) / sigma);
    let mut out: Vec<f64> = before.filter_map(off).collect();
    for (place, values, sigma) in &readings.channels {
        for (s, m) in path.column(*place).zip(values).take(rows) {
            if m.is_finite() {
                out.push((s - m) / sigma);
            }
        }
    }
    DVector::from_vec(out)
}

/// Jacobian of the residuals by difference quotients, components in units of their size.
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
        moved[*place] += INITIAL_STATE.difference * size;
        let there = residuals(readings, &moved, &run(&moved, rows)?, rows);
        if there.len() != left.len() {
            return None;
        }
        columns.push((there - left) / INITIAL_STATE.difference);
    }
    Some(DMatrix::from_columns(&columns))
}
