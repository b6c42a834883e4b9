//! Was a rate computed from the noisy samples of its state? Then it has their noise, filtered, and none of its own.
//!
//! In: stretches of a state and its rate, evenly sampled. Out: the length of the filter that makes the rate, or nothing. Names no filter.
//!
//! Let w be the filter of the samples x = x̄ + n that comes nearest to the rate r. If r was measured independently of n, however exactly, then
//! ‖r − w·x‖² ≥ σ²‖w‖², because w passes the noise n on. A rate that is reproduced far better than that shares the noise. σ is bounded
//! from above by differences, and by how well a sample is told by its neighbours, which noise is not.

use nalgebra::DMatrix;

use super::stretch::Stretch;
use super::thresholds::FILTERS;
use crate::derivatives::noise_level;
use crate::segmentation::Segment;
use crate::time_axis::TimeGrid;

/// Samples on either side that filters take.
const REACHES: [usize; 3] = [8, 25, 50];

/// The length, in samples, of the filter of the state's samples that gives the rate; `None` if there is none.
pub(super) fn filter_length(stretches: &[Stretch]) -> Option<usize> {
    let noise = state_noise(stretches);
    for reach in REACHES {
        let left = filter_residual(stretches, noise, reach)?;
        if left < FILTERS.shared {
            return Some(2 * reach + 1);
        }
        if left > FILTERS.hopeless {
            return None;
        }
    }
    None
}

/// Noise of the state from its differences. Medians are used, so that jumps of an input do not count as noise.
fn state_noise(stretches: &[Stretch]) -> f64 {
    let of = |s: &Stretch| {
        let end = s.state.len();
        let whole = Segment {
            start: 0,
            end,
            rows_end: end,
        };
        noise_level(&TimeGrid::new(&s.time), &s.state, &[whole])
    };
    stretches.iter().map(of).fold(f64::INFINITY, f64::min)
}

/// The residual of the rate after the best filter of the samples, over the noise that this filter passes on; `None` with too few samples.
fn filter_residual(stretches: &[Stretch], noise: f64, reach: usize) -> Option<f64> {
    let rows = windows(stretches, reach);
    let weights = 2 * reach;
    if rows.len() < FILTERS.samples_per_weight * weights {
        return None;
    }
    // Columns: the differences of the neighbouring samples to the middle one, with the next sample last; then the rate.
    let table = DMatrix::from_fn(rows.len(), weights + 1, |i, j| {
        let (s, k) = rows[i];
        match j == weights {
            true => s.rate[k],
            false => s.state[neighbour(k, reach, j)] - s.state[k],
        }
    });
    let scale: Vec<f64> = table.column_iter().map(|c| c.norm()).collect();
    if scale.iter().any(|s| !(*s > 0.0 && s.is_finite())) {
        return None;
    }
    let scaled = DMatrix::from_fn(rows.len(), weights + 1, |i, j| table[(i, j)] / scale[j]);
    let r = scaled.qr().r();
    let degrees = (rows.len() - weights) as f64;
    let residual = |column: usize| r[(column, column)].abs() * scale[column] / degrees.sqrt();
    // Prediction of the next sample from all others: its residual is a contrast that contains noise only.
    let others = solve(&r, weights - 1, &scale);
    let contrast = norm(others.iter().map(|c| -c).chain([1.0]));
    let noise = noise.min(residual(weights - 1) / contrast);
    let passed = noise * norm(solve(&r, weights, &scale).into_iter());
    (passed > 0.0).then(|| residual(weights) / passed)
}

/// The sample of column `j`: all around the middle one, the next one last.
fn neighbour(k: usize, reach: usize, j: usize) -> usize {
    match j {
        j if j < reach => k - reach + j,
        j if j + 1 < 2 * reach => k + 2 + (j - reach),
        _ => k + 1,
    }
}

/// Middles of windows all along.
fn windows(stretches: &[Stretch], reach: usize) -> Vec<(&Stretch, usize)> {
    let middles = |s: &Stretch| reach..s.time.len().saturating_sub(reach);
    let all: usize = stretches.iter().map(|s| middles(s).len()).sum();
    let most = FILTERS
        .max_samples
        .max(2 * FILTERS.samples_per_weight * reach);
    let stride = all.div_ceil(most).max(1);
    let of = |s| middles(s).step_by(stride).map(move |k| (s, k));
    stretches.iter().flat_map(of).collect()
}

/// Coefficients of the first `column` columns for that column, from the triangle of a QR decomposition of scaled columns.
fn solve(r: &DMatrix<f64>, column: usize, scale: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; column];
    for i in (0..column).rev() {
        let known: f64 = (i + 1..column).map(|j| r[(i, j)] * out[j]).sum();
        let pivot = r[(i, i)];
        // A column that the ones before it determine gets no weight.
        out[i] = match pivot.abs() > f64::EPSILON {
            true => (r[(i, column)] - known) / pivot,
            false => 0.0,
        };
    }
    out.iter_mut()
        .zip(scale)
        .for_each(|(c, s)| *c *= scale[column] / s);
    out
}

/// Norm of a filter of differences to the middle: the middle has the weight that makes the sum zero.
fn norm(weights: impl Iterator<Item = f64>) -> f64 {
    let (sum, square) = weights.fold((0.0, 0.0), |(s, q), w| (s + w, q + w * w));
    f64::sqrt(square + sum * sum)
}
