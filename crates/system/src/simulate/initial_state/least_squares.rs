//! Initial states by least squares: the start from which a free run follows the first noisy readings best.
//!
//! In: readings with their noise, a first estimate, a function that simulates. The estimate may contain more than the state: samples
//! before it, each with its own reading. Out: the estimate over the longest stretch that the equations follow, with standard errors. The
//! equations stay as they are. If they follow no stretch to within the noise, the shortest is used: its readings together still tell more
//! than the first alone.

use crate::simulate::thresholds::INITIAL_STATE;
use nalgebra::{DMatrix, DVector};

use crate::least_squares::{Descent, LeastSquares, difference_equations, levenberg_marquardt};
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

/// Least squares on one stretch; `None` if the equations cannot be run along it.
fn fit(
    readings: &Readings,
    start: &[f64],
    free: &[(usize, f64)],
    rows: usize,
    run: Trial,
) -> Option<FittedStart> {
    let mut stretch = Stretch {
        readings,
        free,
        rows,
        run,
    };
    let descent = Descent {
        steps: INITIAL_STATE.iterations,
        converged: INITIAL_STATE.converged,
        still: INITIAL_STATE.still,
    };
    let found = levenberg_marquardt(&mut stretch, start.to_vec(), descent)?;
    let (x, left) = (found.point, found.fit);
    let count = left.len().checked_sub(free.len()).filter(|n| *n > 0)?;
    let scatter = (left.norm_squared() / count as f64).sqrt();
    if !scatter.is_finite() {
        return None;
    }
    let covariance = found.normal?.try_inverse()?;
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

/// The first rows of a run, as a function of its start.
struct Stretch<'a, 'r> {
    readings: &'a Readings,
    /// Components that are estimated, each with its typical size.
    free: &'a [(usize, f64)],
    rows: usize,
    run: &'a mut (dyn FnMut(&[f64], usize) -> Option<Rows> + 'r),
}

impl LeastSquares for Stretch<'_, '_> {
    type Point = Vec<f64>;
    /// Residuals in standard deviations of the noise.
    type Fit = DVector<f64>;

    fn fit(&mut self, x: &Vec<f64>) -> Option<DVector<f64>> {
        let path = (self.run)(x, self.rows)?;
        Some(residuals(self.readings, x, &path, self.rows))
    }

    fn value(&self, left: &DVector<f64>) -> f64 {
        left.norm_squared()
    }

    fn normal_equations(
        &mut self,
        x: &Vec<f64>,
        left: &DVector<f64>,
    ) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let by = INITIAL_STATE.difference;
        difference_equations(self, x, left, (self.free.len(), by), |left| left)
    }

    fn moved(&self, x: &Vec<f64>, step: &DVector<f64>) -> Vec<f64> {
        let mut moved = x.clone();
        for ((place, size), s) in self.free.iter().zip(step.iter()) {
            moved[*place] += size * s;
        }
        moved
    }
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
