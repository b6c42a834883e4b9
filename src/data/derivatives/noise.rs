//! How noisy is a channel? Measured from its high differences, where smooth motion vanishes and noise does not.
//!
//! In: times and values in uninterrupted stretches. Out: one standard deviation. Rounding in print counts as noise.

use super::stencil::{difference, dot};
use super::{Grid, Stretch};

/// Differences tried; the one that leaves least is the most that can be noise.
const DEGREES: std::ops::RangeInclusive<usize> = 2..=10;
/// Places at which they are taken, at most.
const PLACES: usize = 20_000;

/// Levels that a relay does not have.
const LEVELS: f64 = 4.5;

/// Standard deviation of white noise on `values`, never below their rounding in memory.
///
/// The median absolute k-th difference, as a unit contrast, over 0.6745 (the normal distribution's), least over k.
pub(in crate::data) fn estimate(grid: &Grid, values: &[f64], stretches: &[Stretch]) -> f64 {
    let largest = values.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let floor = largest * f64::EPSILON;
    let mut least: Option<f64> = None;
    for k in DEGREES {
        let mut left: Vec<f64> = contrasts(grid, values, stretches, k);
        if left.len() < 6 {
            continue;
        }
        let middle = left.len() / 2;
        let (_, median, _) = left.select_nth_unstable_by(middle, f64::total_cmp);
        let sigma = *median / 0.6745;
        least = Some(least.map_or(sigma, |l| l.min(sigma)));
    }
    let seen = least.unwrap_or(0.0);
    seen.max(rounding(values, stretches)).max(floor)
}

fn range(values: &[f64]) -> f64 {
    let finite = || values.iter().filter(|x| x.is_finite());
    let most = finite().fold(f64::NEG_INFINITY, |m, x| m.max(*x));
    most - finite().fold(f64::INFINITY, |m, x| m.min(*x))
}

fn contrasts(grid: &Grid, values: &[f64], stretches: &[Stretch], k: usize) -> Vec<f64> {
    let even = grid.step.map(|_| {
        let tau: Vec<f64> = (0..=k).map(|j| 2.0 * j as f64 / k as f64 - 1.0).collect();
        difference(&tau)
    });
    let total: usize = stretches.iter().map(|s| s.len().saturating_sub(k)).sum();
    let stride = total.div_ceil(PLACES).max(1);
    let mut out = Vec::with_capacity(total.min(PLACES) + 1);
    for s in stretches {
        for i in (s.start..s.end.saturating_sub(k)).step_by(stride) {
            let window = values.get(i..=i + k).unwrap_or(&[]);
            let r = match &even {
                Some(c) => dot(c, window),
                None => {
                    let t = grid.time.get(i..=i + k).unwrap_or(&[]);
                    let (a, b) = (t.first().unwrap_or(&0.0), t.last().unwrap_or(&1.0));
                    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
                    let tau: Vec<f64> = t.iter().map(|t| (t - middle) / half).collect();
                    dot(&difference(&tau), window)
                }
            };
            out.push(r.abs());
        }
    }
    out
}

/// Coarse digits: a record that repeats values and moves only by multiples of one quantum q has noise q/√12.
pub(in crate::data) fn rounding(values: &[f64], stretches: &[Stretch]) -> f64 {
    let steps = || {
        stretches.iter().flat_map(|s| {
            let v = values.get(s.start..s.end).unwrap_or(&[]);
            v.windows(2).map(|w| (w[1] - w[0]).abs())
        })
    };
    let (mut still, mut moving, mut quantum) = (0usize, 0usize, f64::INFINITY);
    let largest = values.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    for d in steps() {
        if d <= 1e-12 * largest {
            still += 1;
        } else {
            moving += 1;
            quantum = quantum.min(d);
        }
    }
    if moving < 8 || still * 20 < moving {
        return 0.0;
    }
    let multiple = |d: f64| {
        let k = d / quantum;
        (k - k.round()).abs() < 1e-3 * k.max(1.0)
    };
    let fits = steps().filter(|d| multiple(*d)).count();
    // Steps that all are the quantum say nothing between few levels, as those of a relay: they do on a slow coder's stairs.
    let larger = steps().any(|d| d > 1.5 * quantum);
    if fits * 20 >= (still + moving) * 19 && (larger || range(values) > LEVELS * quantum) {
        quantum / 12f64.sqrt()
    } else {
        0.0
    }
}
