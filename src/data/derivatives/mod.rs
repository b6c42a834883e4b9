//! Derivatives of a sampled signal, each with an estimate of its error.
//!
//! In: instants, values, and the stretches that no window may leave. Out: a derivative and its standard error at every
//! sample. One rule for clean and noisy records: among local polynomials of many widths and degrees, interpolating ones
//! included, take the one of least estimated mean squared error, σ²‖w‖² + bias². Never sees names or trajectories.

mod choose;
pub(super) mod noise;
mod stencil;

use super::instants;

/// Samples `start..end` that a window may span; derivatives are wanted at `start..rows_end`.
///
/// Where an input jumps, the sample of the jump closes one stretch and opens the next: its derivative is that of the right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Stretch {
    pub start: usize,
    pub end: usize,
    pub rows_end: usize,
}

impl Stretch {
    pub(super) fn len(&self) -> usize {
        self.end - self.start
    }
}

/// Instants, and the step if they are even.
pub(super) struct Grid {
    time: Vec<f64>,
    step: Option<f64>,
}

impl Grid {
    /// Even if the times are an even grid but for their printed digits, and those matter to 1e-4 of a step at most.
    pub(super) fn new(time: &[f64]) -> Self {
        if let Some((even, worst)) = instants::even_grid(time) {
            let step = even.get(1).zip(even.first()).map_or(0.0, |(b, a)| b - a);
            if worst <= 1e-4 * step {
                return Grid {
                    time: even,
                    step: Some(step),
                };
            }
        }
        Grid {
            time: time.to_vec(),
            step: None,
        }
    }

    /// The instants, repaired where only their printed digits were uneven.
    pub(super) fn time(&self) -> &[f64] {
        &self.time
    }
}

/// Somebody asked the work to end; there is no estimate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stopped;

/// A derivative at every sample; NaN where its stretch has too few samples, and outside the stretches.
#[derive(Clone, Debug)]
pub(super) struct Estimate {
    pub values: Vec<f64>,
    /// Standard error of each value: noise and truncation.
    pub error: Vec<f64>,
    /// The window used most: points and degree.
    pub points: usize,
    pub degree: usize,
}

impl Estimate {
    /// Rows over which errors are alike. Interpolating windows share nearly all of their samples and their truncation;
    /// wider ones average noise down to about half a window for each coefficient.
    pub(super) fn correlation(&self) -> f64 {
        if self.points <= self.degree + 1 {
            self.points.clamp(1, 9) as f64
        } else {
            2.0 * self.points as f64 / (self.degree + 1) as f64
        }
    }
}

/// Derivative `order` (1 to 3) of `values`, all finite within the stretches.
///
/// `noise`: the sensor's standard deviation if it is known, else it is measured. Time linear in the samples on even grids.
///
/// # Errors
/// `go_on`, asked every few thousand samples, said no.
pub(super) fn differentiate(
    grid: &Grid,
    values: &[f64],
    stretches: &[Stretch],
    order: usize,
    noise: Option<f64>,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Estimate, Stopped> {
    let sigma = noise.unwrap_or_else(|| noise::estimate(grid, values, stretches));
    choose::least_error(grid, values, stretches, order, sigma, go_on)
}

#[cfg(test)]
mod tests;
