//! How far ahead the equations predict: for each signal the growth of the error, compared with no change and with a linear model.

use crate::report::figure::axis::{Axis, extremes};
use crate::report::figure::downsampling::{height, place};
use crate::report::figure::plot::{Plot, path};
use crate::report::markup::{Section, lead, number};
use crate::report::report_contents::Subject;
use crate::report::sections::prediction_bands;
use crate::text::verdict::verdict;
use crate::typeset::mathml::escape;
use sidc_system::predict::{AheadFigures, ErrorFigures, Prediction, SignalPrediction};

/// Most signals that are plotted.
const MAX_FIGURES: usize = 6;
/// Smallest error that is plotted, relative to the spread; smaller ones are rounding.
const FLOOR: f64 = 1e-6;

/// Empty for results of earlier versions.
pub(crate) fn html(s: &Subject) -> Section {
    let Some(found) = &s.document.verdict else {
        return Section::default();
    };
    let lines = verdict(s.discovery, found);
    let lines: String = lines.lines().map(|l| format!("{}\n", escape(l))).collect();
    let pictures = found.prediction.signals.iter().take(MAX_FIGURES);
    let pictures: String = pictures
        .filter_map(|p| picture(&found.prediction, p))
        .collect();
    let how = "The state at each start is fitted with the equations to the readings before it; inputs are as recorded. Solid: the equations. \
               Dashed: a linear model of the same state. Dotted: no change. Root mean square over all starts, on a logarithmic scale.";
    let figures = match pictures.is_empty() {
        true => String::new(),
        false => format!("{}<div class=\"thirds\">\n{pictures}</div>\n", lead(how)),
    };
    Section::new(
        "prediction",
        "How far ahead",
        format!(
            "<pre>{lines}</pre>\n{figures}{}",
            prediction_bands::html(&found.prediction, MAX_FIGURES)
        ),
    )
}

/// How the error of one signal grows.
pub(super) fn picture(p: &Prediction, s: &SignalPrediction) -> Option<String> {
    let curve = |of: &dyn Fn(&AheadFigures) -> Option<ErrorFigures>| -> Vec<(f64, f64)> {
        let point = |a: &AheadFigures| {
            let error = of(a)?.rms?.max(FLOOR * s.spread);
            Some((a.ahead.log10(), (error / s.spread).log10()))
        };
        s.curve.iter().filter_map(point).collect()
    };
    let all = [
        ("simulated", curve(&|a| Some(a.error))),
        ("prediction-linear", curve(&|a| a.linear)),
        ("prediction-kept", curve(&|a| Some(a.no_change))),
    ];
    let points = || all.iter().flat_map(|(_, c)| c);
    let times: Vec<f64> = s.curve.iter().map(|a| a.ahead.log10()).collect();
    let heights: Vec<f64> = points().map(|p| p.1).collect();
    let (x, y) = (extremes(times.iter())?, extremes(heights.iter())?);
    let (x, y) = (Axis::new(x.0, x.1), Axis::new(y.0 - 0.1, y.1 + 0.1));
    let line = |points: &[(f64, f64)]| -> String {
        let step = |(i, (t, e)): (usize, &(f64, f64))| {
            let letter = if i == 0 { 'M' } else { 'L' };
            format!("{letter}{} {}", place(&x, *t), height(&y, *e))
        };
        points.iter().enumerate().map(step).collect()
    };
    let elements = all.iter().map(|(class, points)| path(class, &line(points)));
    let error = s.error.rms.map_or("no finite error".into(), |e| {
        format!("an error of {}", number(e, 2))
    });
    let plot = Plot {
        x: &x,
        y: &y,
        shape: "low",
        alt: format!(
            "{} ahead: {error} at {} {}",
            s.signal,
            number(p.horizon, 3),
            p.unit
        ),
        x_name: format!("log₁₀ ahead ({})", escape(&p.unit)),
        y_name: "log₁₀ error".into(),
        elements: elements.collect(),
    };
    Some(format!(
        "<figure>\n<figcaption><b>{}</b> error, parts of its spread</figcaption>\n{}</figure>\n",
        escape(&s.signal),
        plot.html()
    ))
}
