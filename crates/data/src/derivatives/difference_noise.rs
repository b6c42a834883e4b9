//! The noise of a channel from its high differences, in which smooth motion vanishes and white noise does not.
//!
//! In: times and values in segments. Out: one standard deviation; rounding in print counts as noise. Beside it, whether there is
//! anything at all that differences do not remove. Fits nothing.
//!
//! The method of Gasser, Sroka and Jennen-Steinmetz 1986, Biometrika 73, with medians for means and several orders.

use super::orthonormal_polynomials::{divided_difference, dot};
use super::quantization_noise::quantization_noise;
use super::thresholds::NOISE;
use crate::order_statistics::{MEDIAN_OF_ABS_NORMAL, median};
use crate::segmentation::{Segment, breaks_at, segments};
use crate::series::range;
use crate::time_axis::{TimeGrid, gaps};

/// Standard deviation of white noise on `values`, never below their rounding in memory.
///
/// For each order k the median of the absolute k-th differences, as unit contrasts, over 0.6745; the least over k, because no
/// order shows less than the noise.
pub(crate) fn noise_level(grid: &TimeGrid, values: &[f64], segments: &[Segment]) -> f64 {
    let largest = values.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let floor = largest * f64::EPSILON;
    let mut least: Option<f64> = None;
    for k in NOISE.min_order..=NOISE.max_order {
        let mut left: Vec<f64> = contrasts(grid, values, segments, k);
        if left.len() < NOISE.min_differences {
            continue;
        }
        let Some(median) = median(&mut left) else {
            continue;
        };
        let sigma = median / MEDIAN_OF_ABS_NORMAL;
        least = Some(least.map_or(sigma, |l| l.min(sigma)));
    }
    let seen = least.unwrap_or(0.0);
    seen.max(quantization_noise(values, segments)).max(floor)
}

/// Whether all of `values` (NaN: missing) are smooth to `part` of their range: differences of some order vanish to that size
/// everywhere, not only in the median. The residual of a smoother is then motion, as on records that are at rest most of the time.
/// False for records too short to decide.
pub fn is_smooth(time: &[f64], values: &[f64], part: f64) -> bool {
    let missing: Vec<bool> = values.iter().map(|x| !x.is_finite()).collect();
    let within = segments(&missing, &breaks_at(&gaps(time), &[], 1));
    let (least, largest) = range(values);
    let most = part * (largest - least);
    let grid = TimeGrid::new(time);
    let long = |s: &Segment| s.len() > NOISE.max_order + NOISE.min_differences;
    let vanish = |k| contrasts_at(&grid, values, &within, k, 1).all(|r| r <= most);
    !within.is_empty()
        && within.iter().all(long)
        && (NOISE.min_order..=NOISE.max_order).rev().any(vanish)
}

/// Standard deviation of white noise in series with even steps, from the median of their third differences; NaN counts as missing.
/// Zero without differences. Jumps and motion within four samples count as noise if they affect more than half of the differences.
pub fn difference_noise<'a>(series: impl Iterator<Item = &'a [f64]>) -> f64 {
    let third = |w: &[f64]| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).abs();
    let all = series.flat_map(|c| c.windows(4).map(third));
    let mut all: Vec<f64> = all.filter(|v| v.is_finite()).collect();
    // 1² + 3² + 3² + 1² = 20.
    median(&mut all).unwrap_or(0.0) / (20_f64.sqrt() * MEDIAN_OF_ABS_NORMAL)
}

fn contrasts(grid: &TimeGrid, values: &[f64], segments: &[Segment], k: usize) -> Vec<f64> {
    let total: usize = segments.iter().map(|s| s.len().saturating_sub(k)).sum();
    let stride = total.div_ceil(NOISE.max_places).max(1);
    contrasts_at(grid, values, segments, k, stride).collect()
}

/// Absolute unit contrasts of order `k` that begin at every so-many-th row of a segment.
fn contrasts_at(
    grid: &TimeGrid,
    values: &[f64],
    segments: &[Segment],
    k: usize,
    stride: usize,
) -> impl Iterator<Item = f64> {
    let even = grid.is_even().then(|| {
        let tau: Vec<f64> = (0..=k).map(|j| 2.0 * j as f64 / k as f64 - 1.0).collect();
        divided_difference(&tau)
    });
    let places = segments
        .iter()
        .flat_map(move |s| (s.start..s.end.saturating_sub(k)).step_by(stride));
    places.map(move |i| {
        let window = values.get(i..=i + k).unwrap_or(&[]);
        let contrast = match &even {
            Some(c) => dot(c, window),
            None => {
                let t = grid.time().get(i..=i + k).unwrap_or(&[]);
                let (a, b) = (t.first().unwrap_or(&0.0), t.last().unwrap_or(&1.0));
                let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
                let tau: Vec<f64> = t.iter().map(|t| (t - middle) / half).collect();
                dot(&divided_difference(&tau), window)
            }
        };
        contrast.abs()
    })
}
