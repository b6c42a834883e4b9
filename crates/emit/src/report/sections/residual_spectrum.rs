//! Power of the errors of free runs by frequency, and whether a peak is more than chance.

use std::f64::consts::PI;

use crate::report::figure::axis::Axis;
use crate::report::figure::downsampling::line;
use crate::report::figure::plot::{Plot, path};
use crate::report::markup::number;
use crate::report::report_contents::Subject;
use crate::thresholds::FIGURES;
use crate::typeset::mathml::escape;
use sidc_lang::term::{Signal, SignalNames};

/// The periodogram of evenly spaced values: power at k/n cycles per sample, k = 1 … n/2, divided by the total. Missing values count as the
/// mean. `None` if the values are too few or do not vary.
fn periodogram(values: &[f64]) -> Option<Vec<f64>> {
    let finite = || values.iter().filter(|v| v.is_finite());
    let mean = finite().sum::<f64>() / finite().count().max(1) as f64;
    let n = values.len();
    let power = |k: usize| {
        // A rotation by a fixed angle in place of a sine and a cosine for each sample.
        let (sin, cos) = (2.0 * PI * k as f64 / n as f64).sin_cos();
        let (mut re, mut im, mut c, mut s) = (0.0, 0.0, 1.0, 0.0);
        for v in values {
            let left = if v.is_finite() { v - mean } else { 0.0 };
            re += left * c;
            im += left * s;
            (c, s) = (c * cos - s * sin, s * cos + c * sin);
        }
        re * re + im * im
    };
    let powers: Vec<f64> = (1..=n / 2).map(power).collect();
    let sum: f64 = powers.iter().sum();
    let varies = powers.len() >= FIGURES.least_frequencies && sum > 0.0 && sum.is_finite();
    varies.then(|| powers.iter().map(|p| p / sum).collect())
}

/// The share of the power that the strongest of K frequencies exceeds in one of a thousand series of white noise (Fisher, Proc. R. Soc. A
/// 125, 1929: P(share > g) ≤ K (1 − g)^(K−1)).
fn largest_by_chance(frequencies: usize) -> f64 {
    let k = frequencies as f64;
    1.0 - (1e-3 / k).powf(1.0 / (k - 1.0))
}

/// The step and the values of the longest evenly spaced run of samples, cut to its middle if it is long.
fn even_rows<'a>(time: &[f64], values: &'a [f64]) -> Option<(f64, &'a [f64])> {
    let mut stretches: Vec<_> = std::iter::once(0..1).collect();
    for k in 1..time.len() {
        let last = stretches.last_mut()?;
        let step = time[last.end - 1] - time[last.end.saturating_sub(2).max(last.start)];
        let next = time[k] - time[k - 1];
        let even = next > 0.0 && (step == 0.0 || (next / step - 1.0).abs() < FIGURES.uneven_step);
        match even {
            true => last.end = k + 1,
            false if next > 0.0 => stretches.push(k - 1..k + 1),
            false => stretches.push(k..k + 1),
        }
    }
    let longest = stretches.into_iter().max_by_key(|s| s.len())?;
    let rows = longest.len().min(FIGURES.spectrum_rows);
    let from = longest.start + (longest.len() - rows) / 2;
    let step = (time.get(from + rows - 1)? - time.get(from)?) / (rows.max(2) - 1) as f64;
    Some((step, values.get(from..from + rows)?)).filter(|(step, _)| *step > 0.0)
}

/// The spectrum of one signal, if its samples are evenly spaced.
pub(super) fn picture(s: &Subject, x: Signal, (time, left): (&[f64], &[f64])) -> Option<String> {
    let (step, left) = even_rows(time, left)?;
    let shares = periodogram(left)?;
    let frequency = |k: usize| (k + 1) as f64 / (left.len() as f64 * step);
    let (peak, share) = (shares.iter().copied().enumerate()).max_by(|a, b| a.1.total_cmp(&b.1))?;
    // Neighbouring frequencies are summed, so that the figure stays readable.
    let width = shares.len().div_ceil(FIGURES.spectrum_points);
    let means = shares.chunks(width).map(|c| c.iter().sum::<f64>());
    let means: Vec<f64> = means.map(|share| 100.0 * share).collect();
    let middles: Vec<f64> = (0..means.len())
        .map(|i| frequency(i * width + width / 2))
        .collect();
    let axes = (
        &Axis::new(0.0, frequency(shares.len() - 1)),
        &Axis::over(means.iter().chain(&[0.0]))?,
    );
    let unit = s.discovery.frequency_unit();
    let said = match share > largest_by_chance(shares.len()) {
        true => format!(
            "{} % of the power of the errors at {} {unit}",
            number(100.0 * share, 2),
            number(frequency(peak), 3)
        ),
        false => "no peak that chance would not make".into(),
    };
    let name = s.discovery.name(x);
    let plot = Plot {
        x: axes.0,
        y: axes.1,
        shape: "low",
        alt: format!("spectrum of the errors of {name}: {said}"),
        x_name: escape(&format!("frequency ({unit})")),
        y_name: "power (%)".into(),
        elements: path("residual", &line(&middles, &means, axes)),
    };
    Some(format!(
        "<figure>\n<figcaption><b>{}</b> {}</figcaption>\n{}</figure>\n",
        escape(&name),
        escape(&said),
        plot.html()
    ))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use sidc_random::Numbers;

    #[test]
    fn the_longest_even_stretch_is_taken() {
        let time = [0.0, 1.0, 2.0, 2.0, 5.0, 5.5, 6.0, 6.5, 7.0, 9.0];
        let values: Vec<f64> = (0..10).map(f64::from).collect();
        assert_eq!(even_rows(&time, &values), Some((0.5, &values[4..9])));
        assert_eq!(even_rows(&[], &[]), None);
    }

    #[test]
    fn a_sine_in_noise_is_a_peak_and_noise_is_none() {
        let mut found = 0;
        for seed in 0..200 {
            let mut random = Numbers(seed + 1);
            let noise: Vec<f64> = (0..500).map(|_| random.next()).collect();
            let shares = periodogram(&noise).unwrap();
            let largest = shares.iter().copied().fold(0.0, f64::max);
            found += usize::from(largest > largest_by_chance(shares.len()));
        }
        // 0.2 of 200 are expected.
        assert!(found <= 3, "{found}");
        let mut random = Numbers(7);
        let wave = |k: usize| 0.5 * (2.0 * PI * 0.06 * k as f64).sin();
        let heard: Vec<f64> = (0..500).map(|k| wave(k) + random.next()).collect();
        let shares = periodogram(&heard).unwrap();
        let peak = (0..shares.len()).max_by(|a, b| shares[*a].total_cmp(&shares[*b]));
        assert_eq!(peak, Some(29));
        assert!(shares[29] > largest_by_chance(shares.len()));
        assert!(periodogram(&[1.0; 500]).is_none());
    }
}
