//! Predictions of held-out readings with their bands: for each signal the record that has most of them.
//!
//! In: a prediction. Out: HTML, empty without data held out.

use crate::report::figure::axis::{Axis, extremes};
use crate::report::figure::downsampling::{Pen, dots, height, line, place};
use crate::report::figure::plot::{Plot, path};
use crate::report::markup::{lead, number};
use crate::typeset::mathml::escape;
use sidc_system::predict::{PredictedReading, Prediction, SignalPrediction};

/// Figures of the first `signals` signals.
pub(super) fn html(p: &Prediction, signals: usize) -> String {
    let pictures: String = (p.signals.iter().take(signals))
        .filter_map(|s| picture(p, s))
        .collect();
    if pictures.is_empty() {
        return String::new();
    }
    let how = format!(
        "Every reading held out was predicted {} {} before. The band is to hold 90 % of them: its width is that of the errors on the data used, \
         and follows those of the predictions that have come true since.",
        number(p.horizon, 3),
        escape(&p.unit)
    );
    format!("{}{pictures}", lead(&how))
}

/// One signal; `None` without readings held out.
pub(super) fn picture(p: &Prediction, s: &SignalPrediction) -> Option<String> {
    let band = s.band.as_ref()?;
    let held = band.held_out.as_ref()?;
    let records = held.course.chunk_by(|a, b| a.record == b.record);
    let course = records.max_by_key(|course| course.len())?;
    let of = |value: &dyn Fn(&PredictedReading) -> f64| -> Vec<f64> {
        course.iter().map(value).collect()
    };
    let (time, read, predicted) = (of(&|c| c.time), of(&|c| c.read), of(&|c| c.predicted));
    let low = of(&|c| c.predicted - c.half_width);
    let high = of(&|c| c.predicted + c.half_width);
    let (from, to) = extremes(time.iter())?;
    let (bottom, top) = extremes(read.iter().chain(&predicted))?;
    let widest = held.course.iter().map(|c| c.half_width).fold(0.0, f64::max);
    // A band far wider than the readings would leave nothing else to be seen.
    let margin = widest.min(0.5 * (top - bottom));
    let axes = (
        &Axis::new(from, to),
        &Axis::new(bottom - margin, top + margin),
    );
    let elements = [
        path("prediction-band", &outline(&time, &low, &high, axes)),
        path("simulated", &line(&time, &predicted, axes)),
        path("measured dots", &dots(&time, &read, axes)),
    ];
    let share = |share: f64| number(100.0 * share, 3);
    let said = format!(
        "{} {} ahead on data held out: {} % of {} readings within the band, {} % within the {} of the data used",
        number(p.horizon, 3),
        p.unit,
        share(held.following),
        held.course.len(),
        share(held.fixed),
        number(band.half_width, 2)
    );
    let plot = Plot {
        x: axes.0,
        y: axes.1,
        shape: "low",
        alt: format!("{} predicted: {said}", s.signal),
        x_name: format!("time ({})", escape(&p.unit)),
        y_name: s.unit.as_deref().map(escape).unwrap_or_default(),
        elements: elements.concat(),
    };
    Some(format!(
        "<figure>\n<figcaption><b>{}</b> {}</figcaption>\n{}</figure>\n",
        escape(&s.signal),
        escape(&said),
        plot.html()
    ))
}

/// Along the upper edge and back along the lower.
fn outline(time: &[f64], low: &[f64], high: &[f64], (x, y): (&Axis, &Axis)) -> String {
    let mut pen = Pen::default();
    let there = time.iter().zip(high);
    for (t, v) in there.chain(time.iter().zip(low).rev()) {
        pen.to(place(x, *t), height(y, *v));
    }
    pen.text.push('Z');
    pen.text
}
