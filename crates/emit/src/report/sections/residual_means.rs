//! The errors of free runs along the values of a state: a curve points to a missing term.

use crate::report::figure::axis::Axis;
use crate::report::figure::downsampling::{height, place};
use crate::report::figure::plot::{Plot, path};
use crate::report::report_contents::Subject;
use crate::thresholds::FIGURES;
use crate::typeset::mathml::escape;
use sidc_lang::term::{Signal, SignalNames};

/// The mean of a group of errors, the mean of the state there, and the standard error as if the errors were independent.
struct Mean {
    at: f64,
    error: f64,
    deviation: f64,
}

/// Means over groups of equally many readings, by the value of the state.
fn means(state: &[f64], errors: &[f64]) -> Vec<Mean> {
    let step = errors.len().div_ceil(FIGURES.means_rows).max(1);
    let pairs = state
        .iter()
        .copied()
        .zip(errors.iter().copied())
        .step_by(step);
    let mut pairs: Vec<(f64, f64)> = pairs
        .filter(|(x, e)| x.is_finite() && e.is_finite())
        .collect();
    pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let size = (pairs.len() / FIGURES.error_groups).max(FIGURES.group_readings);
    let full = pairs.chunks(size).filter(|group| group.len() == size);
    let one = |group: &[(f64, f64)]| {
        let n = group.len() as f64;
        let (at, error) = group
            .iter()
            .fold((0.0, 0.0), |(x, e), g| (x + g.0, e + g.1));
        let (at, error) = (at / n, error / n);
        let variance = group.iter().map(|g| (g.1 - error).powi(2)).sum::<f64>() / (n - 1.0);
        Mean {
            at,
            error,
            deviation: (variance / n).sqrt(),
        }
    };
    full.map(one).collect()
}

/// The errors of `x` along `state`, if there are enough of them.
pub(super) fn picture(
    s: &Subject,
    (x, errors): (Signal, &[f64]),
    (state, values): (Signal, &[f64]),
) -> Option<String> {
    let means = means(values, errors);
    if means.len() < FIGURES.error_groups / 2 {
        return None;
    }
    let ends: Vec<f64> = (means.iter())
        .flat_map(|m| {
            [
                m.error - 2.0 * m.deviation,
                m.error + 2.0 * m.deviation,
                0.0,
            ]
        })
        .collect();
    let places: Vec<f64> = means.iter().map(|m| m.at).collect();
    let (a, b) = (Axis::over(places.iter())?, Axis::over(ends.iter())?);
    let (mut bars, mut points) = (String::new(), String::new());
    for m in &means {
        let x = place(&a, m.at);
        let [top, bottom] = [2.0, -2.0].map(|k| height(&b, m.error + k * m.deviation));
        bars.push_str(&format!("M{x} {top}V{bottom}"));
        points.push_str(&format!("M{x} {}h0", height(&b, m.error)));
    }
    let zero = height(&b, 0.0);
    let zero = path("zero", &format!("M0 {zero}H{}", place(&a, a.high)));
    let names = (s.discovery.name(x), s.discovery.name(state));
    let plot = Plot {
        x: &a,
        y: &b,
        shape: "low",
        alt: format!("mean errors of {} along {}", names.0, names.1),
        x_name: escape(&s.axis_label(state)),
        y_name: "error".into(),
        elements: zero + &path("bar", &bars) + &path("point", &points),
    };
    Some(format!(
        "<figure>\n<figcaption><b>{}</b> along {}</figcaption>\n{}</figure>\n",
        escape(&names.0),
        escape(&names.1),
        plot.html()
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_seen_in_the_means() {
        let state: Vec<f64> = (0..1000).map(|k| f64::from(k) / 500.0 - 1.0).collect();
        let errors: Vec<f64> = state
            .iter()
            .map(|x| x * x + 1e-3 * (1e4 * x).sin())
            .collect();
        let found = means(&state, &errors);
        assert_eq!(found.len(), FIGURES.error_groups);
        for m in &found {
            assert!((m.error - m.at * m.at).abs() < 0.01, "{}", m.at);
        }
        assert!(means(&state[..5], &errors[..5]).is_empty());
    }
}
