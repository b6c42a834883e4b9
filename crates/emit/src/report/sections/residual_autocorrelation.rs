//! Autocorrelation of the residuals of free runs, with the band of white noise.

use crate::report::figure::axis::Axis;
use crate::report::figure::downsampling::{BOX_HEIGHT, BOX_WIDTH, height, place};
use crate::report::figure::plot::{Plot, path};
use crate::report::markup::{counted, number};
use crate::report::report_contents::{Record, Subject};
use crate::thresholds::FIGURES;
use crate::typeset::mathml::escape;
use sidc_lang::term::{Signal, SignalNames};

/// 97.5 % quantile of the normal distribution.
pub(super) const NORMAL_97_5: f64 = 1.96;
/// Autocorrelation at lags 0 to `lags` of the finite values about their mean, and their number; `None` if they do not
/// vary. Pairs with a missing value are left out; sums are divided by the number of values (the biased estimate; Box
/// and Jenkins, Time Series Analysis, 2.1).
pub(crate) fn autocorrelation(values: &[f64], lags: usize) -> Option<(Vec<f64>, usize)> {
    let finite = || values.iter().filter(|v| v.is_finite());
    let n = finite().count();
    let mean = finite().sum::<f64>() / n.max(1) as f64;
    let lags = lags.min(n.saturating_sub(1) / 4);
    // Zeros before the first value add nothing.
    let mut centred = vec![0.0; lags];
    let about_mean = |v: &f64| if v.is_finite() { v - mean } else { 0.0 };
    centred.extend(values.iter().map(about_mean));
    // All lags in one pass, the longest first, so that sums do not wait for each other.
    let mut sums = vec![0.0_f64; lags + 1];
    for past in centred.windows(lags + 1) {
        let now = past[lags];
        sums.iter_mut().zip(past).for_each(|(s, x)| *s += now * x);
    }
    sums.reverse();
    let energy = sums[0];
    if !(energy > 0.0 && energy.is_finite()) || lags < 2 {
        return None;
    }
    Some((sums.iter().map(|s| s / energy).collect(), n))
}

/// One signal.
pub(super) fn picture(s: &Subject, r: &Record, x: Signal) -> Option<String> {
    let (_, left) = r.residual(x)?;
    let (correlations, n) = autocorrelation(&left, FIGURES.lags)?;
    let band = NORMAL_97_5 / (n as f64).sqrt();
    let axis = Axis::new(0.0, (correlations.len() - 1) as f64 + 0.5);
    let y = Axis::new(-1.0, 1.0);
    let outside = correlations
        .iter()
        .skip(1)
        .filter(|c| c.abs() > band)
        .count();
    let mut d = String::new();
    for (lag, c) in correlations.iter().enumerate() {
        let (x, top, zero) = (place(&axis, lag as f64), height(&y, *c), height(&y, 0.0));
        d.push_str(&format!("M{x} {zero}V{top}"));
    }
    let (top, bottom) = (height(&y, band), height(&y, -band));
    let name = s.discovery.name(x);
    let lags = correlations.len() - 1;
    let words = format!(
        "{outside} of {} outside the band of ±{}",
        counted(lags, "lag"),
        number(band, 2)
    );
    let plot = Plot {
        x: &axis,
        y: &y,
        shape: "low",
        alt: format!("autocorrelation of the errors of {name}: {words}"),
        x_name: "lag (samples)".into(),
        y_name: String::new(),
        elements: format!(
            "<rect class=\"band\" x=\"0\" y=\"{top}\" width=\"{BOX_WIDTH}\" height=\"{}\"/>{}",
            (bottom - top).clamp(4, BOX_HEIGHT),
            path("stems", &d)
        ),
    };
    Some(format!(
        "<figure>\n<figcaption><b>{}</b> {}</figcaption>\n{}</figure>\n",
        escape(&name),
        escape(&words),
        plot.html()
    ))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

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
}
