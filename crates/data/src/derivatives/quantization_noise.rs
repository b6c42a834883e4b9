//! The noise of rounded values: is a record rounded to multiples of a quantum?
//!
//! In: values in segments. Out: quantum/√12, the standard deviation of uniform rounding (Bennett 1948, Bell System Technical
//! Journal 27), or 0. Knows no times.

use super::thresholds::QUANTIZATION;
use crate::segmentation::Segment;
use crate::series::range;

/// Standard deviation of the rounding of a record that repeats values and otherwise moves by multiples of one quantum; 0 for
/// other records.
pub(crate) fn quantization_noise(values: &[f64], segments: &[Segment]) -> f64 {
    let steps = || {
        segments.iter().flat_map(|s| {
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
    if moving < QUANTIZATION.min_moves || still * QUANTIZATION.max_moves_per_repeat < moving {
        return 0.0;
    }
    let multiple = |d: f64| {
        let k = d / quantum;
        (k - k.round()).abs() < QUANTIZATION.tolerance * k.max(1.0)
    };
    let fits = steps().filter(|d| multiple(*d)).count();
    // Equal steps between a few levels may be those of a relay; over many levels they are those of a slow encoder.
    let (low, high) = range(values);
    let larger = steps().any(|d| d > QUANTIZATION.larger_step * quantum);
    if fits as f64 >= QUANTIZATION.multiples * (still + moving) as f64
        && (larger || high - low > QUANTIZATION.min_range * quantum)
    {
        quantum / 12f64.sqrt()
    } else {
        0.0
    }
}
