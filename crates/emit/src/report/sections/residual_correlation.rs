//! Correlograms of the errors of free runs: with their own past, and with that of an input.

use super::correlation::Series;
use crate::report::figure::axis::Axis;
use crate::report::figure::downsampling::{BOX_HEIGHT, BOX_WIDTH, height, place};
use crate::report::figure::plot::{Plot, path};
use crate::report::markup::{counted, number};
use crate::report::report_contents::Subject;
use crate::typeset::mathml::escape;
use sidc_lang::term::{Signal, SignalNames};
use sidc_system::discovery::NORMAL_97_5;

/// Autocorrelation of the errors of one signal, with the band of white noise.
pub(super) fn with_itself(s: &Subject, x: Signal, errors: &Series) -> String {
    let name = s.discovery.name(x);
    // The correlation at lag 0 is always 1.
    correlogram(&Correlogram {
        correlations: &errors.autocorrelation,
        counted_from: 1,
        band: NORMAL_97_5 / (errors.count as f64).sqrt(),
        about: format!("autocorrelation of the errors of {name}"),
        x_name: "lag (samples)",
        caption: format!("<b>{}</b> ", escape(&name)),
    })
}

/// Correlation of the errors of one signal with the past of one input, with the band of errors that do not depend on it.
pub(super) fn with_input(
    s: &Subject,
    (x, errors): (Signal, &Series),
    (u, input): (Signal, &Series),
) -> String {
    let (correlations, error) = errors.correlation(input);
    let names = (s.discovery.name(x), s.discovery.name(u));
    correlogram(&Correlogram {
        correlations: &correlations,
        counted_from: 0,
        band: NORMAL_97_5 * error,
        about: format!("errors of {} with {}", names.0, names.1),
        x_name: "samples before",
        caption: format!("<b>{}</b> with {}: ", escape(&names.0), escape(&names.1)),
    })
}

/// Correlations by lag, and the band that 95 % of them stay in by chance.
struct Correlogram<'a> {
    correlations: &'a [f64],
    /// The first lag that can be outside the band.
    counted_from: usize,
    band: f64,
    about: String,
    x_name: &'a str,
    /// HTML before the words of the caption.
    caption: String,
}

fn correlogram(c: &Correlogram) -> String {
    let lags = c.correlations.len();
    let x = Axis::new(0.0, (lags - 1) as f64 + 0.5);
    let y = Axis::new(-1.0, 1.0);
    let zero = height(&y, 0.0);
    let stems = c.correlations.iter().enumerate();
    let stems =
        stems.map(|(lag, v)| format!("M{} {zero}V{}", place(&x, lag as f64), height(&y, *v)));
    let stems: String = stems.collect();
    let counting = c.correlations.iter().skip(c.counted_from);
    let outside = counting.filter(|v| v.abs() > c.band).count();
    let words = format!(
        "{outside} of {} outside the band of ±{}",
        counted(lags - c.counted_from, "lag"),
        number(c.band, 2)
    );
    let (top, bottom) = (height(&y, c.band.min(1.0)), height(&y, -c.band.min(1.0)));
    let plot = Plot {
        x: &x,
        y: &y,
        shape: "low",
        alt: format!("{}: {words}", c.about),
        x_name: c.x_name.into(),
        y_name: String::new(),
        elements: format!(
            "<rect class=\"band\" x=\"0\" y=\"{top}\" width=\"{BOX_WIDTH}\" height=\"{}\"/>{}",
            (bottom - top).clamp(4, BOX_HEIGHT),
            path("stems", &stems)
        ),
    };
    format!(
        "<figure>\n<figcaption>{}{}</figcaption>\n{}</figure>\n",
        c.caption,
        escape(&words),
        plot.html()
    )
}
