//! The periodogram of a signal under a Hann window: its peak, and the band that holds nearly all of its power.
//!
//! In: values at even times. Out: frequencies and shares of the power, as precise as a report needs.

use std::f64::consts::{PI, TAU};

use super::thresholds::EXCITATION;

/// Frequencies in cycles a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Periodogram {
    pub peak_frequency: f64,
    /// Share of the power within two bins of the peak.
    pub peak_share: f64,
    pub bandwidth: f64,
}

/// `None` for short or constant signals.
pub(super) fn periodogram(values: &[f64]) -> Option<Periodogram> {
    let group = values.len().div_ceil(EXCITATION.max_samples).max(1);
    let means: Vec<f64> = values
        .chunks_exact(group)
        .map(|g| g.iter().sum::<f64>() / group as f64)
        .collect();
    let n = means.len();
    if n < EXCITATION.min_samples {
        return None;
    }
    let mean = means.iter().sum::<f64>() / n as f64;
    let length = (2 * n).next_power_of_two();
    let mut real = vec![0.0; length];
    for (k, (out, x)) in real.iter_mut().zip(&means).enumerate() {
        let window = 0.5 - 0.5 * (TAU * (k as f64 + 0.5) / n as f64).cos();
        *out = (x - mean) * window;
    }
    let mut imaginary = vec![0.0; length];
    fft(&mut real, &mut imaginary);
    let power = real.iter().zip(&imaginary).take(length / 2);
    let power: Vec<f64> = power.map(|(a, b)| a * a + b * b).collect();
    let total: f64 = power.iter().sum();
    let at = (0..power.len()).max_by(|a, b| power[*a].total_cmp(&power[*b]))?;
    if !(total > 0.0 && total.is_finite()) {
        return None;
    }
    // The main lobe of the window extends two bins of the record to each side.
    let reach = 2 * length / n + 1;
    let lobe = at.saturating_sub(reach)..(at + reach + 1).min(power.len());
    let mut sum = 0.0;
    let below = power.iter().position(|p| {
        sum += p;
        sum >= EXCITATION.band_power * total
    })?;
    let unit = 1.0 / (length * group) as f64;
    Some(Periodogram {
        peak_frequency: at as f64 * unit,
        peak_share: power[lobe].iter().sum::<f64>() / total,
        bandwidth: below as f64 * unit,
    })
}

/// The fast Fourier transform in place, for a length that is a power of two (Cooley & Tukey 1965).
fn fft(real: &mut [f64], imaginary: &mut [f64]) {
    let n = real.len();
    let bits = n.trailing_zeros();
    for i in 0..n {
        let j = i.reverse_bits() >> (usize::BITS - bits);
        if i < j {
            real.swap(i, j);
            imaginary.swap(i, j);
        }
    }
    let mut half = 1;
    while half < n {
        let step = -PI / half as f64;
        for start in (0..n).step_by(2 * half) {
            for k in 0..half {
                let (s, c) = (step * k as f64).sin_cos();
                let (i, j) = (start + k, start + k + half);
                let (a, b) = (
                    real[j] * c - imaginary[j] * s,
                    real[j] * s + imaginary[j] * c,
                );
                (real[j], imaginary[j]) = (real[i] - a, imaginary[i] - b);
                real[i] += a;
                imaginary[i] += b;
            }
        }
        half *= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_sine_is_one_peak() {
        let wave: Vec<f64> = (0..1000)
            .map(|k| 3.0 + (0.05 * TAU * f64::from(k)).sin())
            .collect();
        let s = periodogram(&wave).unwrap();
        assert!(
            (s.peak_frequency - 0.05).abs() < 1e-3 && s.peak_share > 0.999,
            "{s:?}"
        );
        let two: Vec<f64> = (wave.iter().enumerate())
            .map(|(k, x)| x + (0.2 * TAU * k as f64).cos())
            .collect();
        let s = periodogram(&two).unwrap();
        assert!(
            (s.peak_share - 0.5).abs() < 0.02 && (s.bandwidth - 0.2).abs() < 0.01,
            "{s:?}"
        );
        assert!(periodogram(&[1.0; 100]).is_none());
    }
}
