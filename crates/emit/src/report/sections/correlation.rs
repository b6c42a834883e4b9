//! Correlations of series with their own past and with that of others.
//!
//! In: values in time, some of them missing. Out: correlations by lag. Draws nothing.

/// A series less its mean, missing values as the mean, and its autocorrelation.
pub(super) struct Series {
    centred: Vec<f64>,
    energy: f64,
    /// At lags 0, 1, …
    pub autocorrelation: Vec<f64>,
    /// Values that are not missing.
    pub count: usize,
}

impl Series {
    /// With the autocorrelation at lags up to `lags`; `None` if the values do not vary or are too few. Pairs with a missing value are left
    /// out; sums are divided by the number of values (the biased estimate; Box and Jenkins, Time Series Analysis, 2.1).
    pub fn new(values: &[f64], lags: usize) -> Option<Series> {
        let finite = || values.iter().filter(|v| v.is_finite());
        let count = finite().count();
        let mean = finite().sum::<f64>() / count.max(1) as f64;
        let lags = lags.min(count.saturating_sub(1) / 4);
        let about_mean = |v: &f64| if v.is_finite() { v - mean } else { 0.0 };
        let centred: Vec<f64> = values.iter().map(about_mean).collect();
        let sums = lagged_products(&centred, &centred, lags);
        let energy = sums[0];
        if !(energy > 0.0 && energy.is_finite()) || lags < 2 {
            return None;
        }
        Some(Series {
            centred,
            energy,
            autocorrelation: sums.iter().map(|s| s / energy).collect(),
            count,
        })
    }

    /// Correlations with `other` at 0, 1, … rows earlier, and the standard error of one of them if the two are independent. Both are
    /// autocorrelated, so that it is √(Σ ρ(k) ρ′(k) / n) over all lags k (Bartlett 1935; Box and Jenkins, 11.1.3).
    pub fn correlation(&self, other: &Series) -> (Vec<f64>, f64) {
        let (own, past) = (&self.autocorrelation, &other.autocorrelation);
        let sums = lagged_products(&self.centred, &other.centred, own.len() - 1);
        let whole = (self.energy * other.energy).sqrt();
        let memory: f64 = own.iter().zip(past).skip(1).map(|(a, b)| a * b).sum();
        let variance = (1.0 + 2.0 * memory).max(1.0) / self.count as f64;
        (sums.iter().map(|s| s / whole).collect(), variance.sqrt())
    }
}

/// Σ now[k] past[k − lag] at lags 0 to `lags`.
fn lagged_products(now: &[f64], past: &[f64], lags: usize) -> Vec<f64> {
    // Zeros before the first value add nothing.
    let mut padded = vec![0.0; lags];
    padded.extend(past);
    // All lags in one pass, the longest first: sums that are independent of each other can be added in parallel.
    let mut sums = vec![0.0_f64; lags + 1];
    for (past, now) in padded.windows(lags + 1).zip(now) {
        sums.iter_mut().zip(past).for_each(|(s, x)| *s += now * x);
    }
    sums.reverse();
    sums
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use sidc_random::Numbers;
    use sidc_system::discovery::NORMAL_97_5;

    fn autocorrelation(values: &[f64], lags: usize) -> Option<(Vec<f64>, usize)> {
        Series::new(values, lags).map(|s| (s.autocorrelation, s.count))
    }

    fn cross_correlation(error: &[f64], input: &[f64], lags: usize) -> Option<(Vec<f64>, f64)> {
        Some(Series::new(error, lags)?.correlation(&Series::new(input, lags)?))
    }

    #[test]
    fn noise_and_a_wave_have_different_autocorrelations() {
        let mut state = 1u64;
        let noise: Vec<f64> = (0..4000)
            .map(|_| {
                state = state
                    .wrapping_mul(6364136223846793005)
                    .wrapping_add(1442695040888963407);
                (state >> 40) as f64 / (1u64 << 24) as f64
            })
            .collect();
        let (white, n) = autocorrelation(&noise, 40).unwrap();
        let outside = |c: &&f64| c.abs() > NORMAL_97_5 / (n as f64).sqrt();
        assert!(white.iter().skip(1).filter(outside).count() <= 6);
        let wave: Vec<f64> = (0..4000).map(|k| (f64::from(k) / 50.0).sin()).collect();
        let (slow, _) = autocorrelation(&wave, 40).unwrap();
        assert!(slow[1] > 0.99);
        assert!(autocorrelation(&[1.0; 50], 40).is_none());
        let mut gaps = wave;
        gaps[77] = f64::NAN;
        assert!(autocorrelation(&gaps, 40).unwrap().0[1] > 0.98);
    }

    /// Independent series stay within their band although both are autocorrelated; a series that follows an input does not.
    #[test]
    fn the_band_holds_for_series_with_memory() {
        let slow = |random: &mut Numbers, n: usize| -> Vec<f64> {
            let mut x = 0.0;
            let mut step = |_| {
                x = 0.9 * x + random.next();
                x
            };
            (0..n).map(&mut step).collect()
        };
        let (mut outside, mut all) = (0, 0);
        for seed in 0..40 {
            let mut random = Numbers(seed + 1);
            let (a, b) = (slow(&mut random, 2000), slow(&mut random, 2000));
            let (found, error) = cross_correlation(&a, &b, 40).unwrap();
            outside += found
                .iter()
                .filter(|c| c.abs() > NORMAL_97_5 * error)
                .count();
            all += found.len();
        }
        let share = outside as f64 / all as f64;
        assert!((0.01..0.12).contains(&share), "{share}");
        let mut random = Numbers(99);
        let u = slow(&mut random, 2000);
        let late: Vec<f64> = (0..2000)
            .map(|k| if k < 7 { 0.0 } else { u[k - 7] } + random.next())
            .collect();
        let (found, error) = cross_correlation(&late, &u, 40).unwrap();
        let most = (0..found.len()).max_by(|a, b| found[*a].total_cmp(&found[*b]));
        assert_eq!(most, Some(7));
        assert!(found[7] > 5.0 * error);
    }
}
