//! Correlation of the errors of free runs with an input, and the band of errors that have nothing to do with it.

use super::residual_autocorrelation::{NORMAL_97_5, autocorrelation};
use crate::report::figure::axis::Axis;
use crate::report::figure::downsampling::{BOX_HEIGHT, BOX_WIDTH, height, place};
use crate::report::figure::plot::{Plot, path};
use crate::report::markup::{counted, number};
use crate::report::report_contents::{Record, Subject};
use crate::thresholds::FIGURES;
use crate::typeset::mathml::escape;
use sidc_lang::term::{Signal, SignalNames};

/// Correlations of `error` with `input` at 0 … `lags` rows before, and the standard error of one if the two have nothing to do with each
/// other: both have memory, so it is √(Σ ρₑ(k) ρᵤ(k) / n) over all lags k (Bartlett 1935; Box and Jenkins, 11.1.3).
fn cross_correlation(error: &[f64], input: &[f64], lags: usize) -> Option<(Vec<f64>, f64)> {
    let (own, n) = autocorrelation(error, lags)?;
    let (other, _) = autocorrelation(input, lags)?;
    let mean = |values: &[f64]| {
        let finite = || values.iter().filter(|v| v.is_finite());
        finite().sum::<f64>() / finite().count().max(1) as f64
    };
    let (e, u) = (mean(error), mean(input));
    let sum = |lag: usize| -> (f64, f64, f64) {
        let pairs = error.iter().skip(lag).zip(input);
        let there = pairs.filter(|(a, b)| a.is_finite() && b.is_finite());
        there.fold((0.0, 0.0, 0.0), |(ab, aa, bb), (a, b)| {
            let (a, b) = (a - e, b - u);
            (ab + a * b, aa + a * a, bb + b * b)
        })
    };
    let scale = |(_, aa, bb): (f64, f64, f64)| (aa * bb).sqrt();
    let whole = scale(sum(0));
    let correlations = (0..own.len()).map(|lag| sum(lag).0 / whole).collect();
    let memory: f64 = own.iter().zip(&other).skip(1).map(|(a, b)| a * b).sum();
    let variance = (1.0 + 2.0 * memory).max(1.0) / n as f64;
    (whole > 0.0 && whole.is_finite()).then_some((correlations, variance.sqrt()))
}

/// One signal with one input.
pub(super) fn picture(s: &Subject, r: &Record, x: Signal, u: Signal) -> Option<String> {
    let (time, left) = r.residual(x)?;
    let applied = r.input(u).map(|(_, values)| values);
    let input = applied.or_else(|| r.read_at(u, &time))?;
    let (correlations, error) = cross_correlation(&left, &input, FIGURES.lags)?;
    let band = NORMAL_97_5 * error;
    let axis = Axis::new(0.0, (correlations.len() - 1) as f64 + 0.5);
    let y = Axis::new(-1.0, 1.0);
    let outside = correlations.iter().filter(|c| c.abs() > band).count();
    let mut d = String::new();
    for (lag, c) in correlations.iter().enumerate() {
        let (x, top, zero) = (place(&axis, lag as f64), height(&y, *c), height(&y, 0.0));
        d.push_str(&format!("M{x} {zero}V{top}"));
    }
    let (top, bottom) = (height(&y, band.min(1.0)), height(&y, -band.min(1.0)));
    let names = (s.discovery.name(x), s.discovery.name(u));
    let words = format!(
        "{outside} of {} outside the band of ±{}",
        counted(correlations.len(), "lag"),
        number(band, 2)
    );
    let plot = Plot {
        x: &axis,
        y: &y,
        shape: "low",
        alt: format!("errors of {} with {}: {words}", names.0, names.1),
        x_name: "samples before".into(),
        y_name: String::new(),
        elements: format!(
            "<rect class=\"band\" x=\"0\" y=\"{top}\" width=\"{BOX_WIDTH}\" height=\"{}\"/>{}",
            (bottom - top).clamp(4, BOX_HEIGHT),
            path("stems", &d)
        ),
    };
    Some(format!(
        "<figure>\n<figcaption><b>{}</b> with {}: {}</figcaption>\n{}</figure>\n",
        escape(&names.0),
        escape(&names.1),
        escape(&words),
        plot.html()
    ))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use sidc_random::Numbers;

    /// Two that have nothing to do with each other stay in their band, though both have memory; what follows an input does not.
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
