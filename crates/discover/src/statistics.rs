//! Norms, medians and autocorrelation times of series of numbers.
//!
//! In: slices. Out: numbers. Knows no units.

use crate::thresholds::AUTOCORRELATION;
use sidc_solve::linalg::dot_in_lanes;
use sidc_solve::simd::wide;

/// Running sums side by side: decides nothing but speed.
const LANES: usize = 16;

/// Integrated autocorrelation time 1 + 2 Σ ρ_k in rows, summed up to five times itself (Sokal 1997, section 3).
///
/// Longer series are averaged in pairs first (Flyvbjerg & Petersen 1989): a drifting residual of a million rows would otherwise
/// need a sum over all rows for each of many lags.
pub(crate) fn autocorrelation_time(series: &[f64]) -> f64 {
    let square: f64 = series.iter().map(|x| x * x).sum();
    if square == 0.0 {
        return 1.0;
    }
    if series.len() > AUTOCORRELATION.direct_length {
        let pairs = series.chunks_exact(2);
        let means: Vec<f64> = pairs.map(|p| 0.5 * (p[0] + p[1])).collect();
        let kept = means.iter().map(|x| x * x).sum::<f64>() / square;
        return (4.0 * kept * autocorrelation_time(&means)).max(1.0);
    }
    let mut time = 1.0;
    for k in 1..series.len() / 4 {
        let (earlier, later) = (&series[..series.len() - k], &series[k..]);
        let product = wide(|| dot_in_lanes::<LANES, f64>(earlier, later));
        time += 2.0 * product / square;
        if k as f64 >= AUTOCORRELATION.window * time {
            break;
        }
    }
    time.max(1.0)
}

/// Euclidean norm.
pub(crate) fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Root mean square.
pub(crate) fn rms(v: &[f64]) -> f64 {
    norm(v) / (v.len().max(1) as f64).sqrt()
}

/// Whether numbers agree pairwise to this part of the larger of two.
pub(crate) fn agree(a: &[f64], b: &[f64], part: f64) -> bool {
    let near = |(a, b): (&f64, &f64)| (a - b).abs() <= part * a.abs().max(b.abs());
    a.iter().zip(b).all(near)
}

/// The elementwise product.
pub(crate) fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a * b).collect()
}

#[cfg(test)]
mod tests {
    use super::autocorrelation_time;
    use sidc_random::Numbers;

    /// x_i = 0.9 x_{i−1} + noise has autocorrelation time (1 + 0.9)/(1 − 0.9) = 19 rows.
    fn autoregressive(n: usize) -> Vec<f64> {
        let (mut numbers, mut x) = (Numbers(7), 0.0);
        let step = |_| {
            x = 0.9 * x + numbers.next();
            x
        };
        (0..n).map(step).collect()
    }

    #[test]
    fn correlation_is_the_same_for_long_series_and_short_ones() {
        for n in [10_000, 19_999, 50_000, 300_000] {
            let time = autocorrelation_time(&autoregressive(n));
            assert!((14.0..25.0).contains(&time), "{n}: {time}");
        }
    }

    #[test]
    fn uncorrelated_series_count_every_row() {
        let alternating: Vec<f64> = (0..50_000).map(|i| f64::from(1 - 2 * (i % 2))).collect();
        assert_eq!(autocorrelation_time(&alternating), 1.0);
        assert_eq!(autocorrelation_time(&[0.0; 10]), 1.0);
    }
}
