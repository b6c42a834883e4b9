//! Phase portraits: each state against its rate, or states of first order against each other.

use crate::report::figure::axis::Axis;
use crate::report::figure::density_grid::{CurvePath, curve};
use crate::report::figure::downsampling::{dots, is_sparse};
use crate::report::figure::plot::{Plot, path};
use crate::report::markup::{Section, lead};
use crate::report::report_contents::{Record, Subject};
use crate::typeset::mathml::escape;
use sidc_lang::model::VarKind;
use sidc_lang::term::{Signal, SignalNames, VarId};

/// Most portraits of one record.
const MAX_PORTRAITS: usize = 4;

pub(crate) fn html(s: &Subject) -> Section {
    let records = s.records();
    let Some(record) = records.first() else {
        return Section::default();
    };
    let portraits: String = (pairs(s).into_iter())
        .filter_map(|pair| portrait(s, record, pair))
        .take(MAX_PORTRAITS)
        .collect();
    if portraits.is_empty() {
        return Section::default();
    }
    let how = format!(
        "{}: measured where both signals were measured, and as simulated.",
        record.trajectory.name
    );
    Section::new(
        "phase",
        "Phase portraits",
        format!("{}<div class=\"squares\">\n{portraits}</div>\n", lead(&how)),
    )
}

/// Pairs of signals that are plotted.
fn pairs(s: &Subject) -> Vec<(Signal, Signal)> {
    let all = (0u16..).zip(&s.discovery.variables);
    let states: Vec<(Signal, u8)> = all
        .filter(|(_, v)| v.kind == VarKind::State)
        .map(|(id, v)| (Signal::new(VarId(id)), v.order))
        .collect();
    let rate = |x: &Signal| Signal { der: 1, ..*x };
    let second = states
        .iter()
        .filter(|(_, order)| *order >= 2 && !s.discovery.discrete);
    let mut pairs: Vec<(Signal, Signal)> = second.map(|(x, _)| (*x, rate(x))).collect();
    let first: Vec<Signal> = (states.iter())
        .filter(|(_, order)| *order < 2 || s.discovery.discrete)
        .map(|(x, _)| *x)
        .collect();
    for (i, a) in first.iter().enumerate() {
        pairs.extend(first.iter().skip(i + 1).map(|b| (*a, *b)));
    }
    if let ([x], true) = (first.as_slice(), pairs.is_empty()) {
        pairs.push((*x, rate(x)));
    }
    pairs
}

fn portrait(s: &Subject, r: &Record, (x, y): (Signal, Signal)) -> Option<String> {
    let simulated = r.column(x).zip(r.column(y));
    let simulated = simulated.map(|((_, xs), (_, ys))| (xs, ys));
    let measured = r.measured(x).zip(r.measured(y));
    // The axes fit the readings: a run that diverged would squeeze them.
    let run = simulated.as_ref().map(|(xs, ys)| (&xs[..], &ys[..]));
    let (xs, ys) = measured.or(run)?;
    let (ax, ay) = (Axis::over(xs.iter())?, Axis::over(ys.iter())?);
    let mut elements = String::new();
    if let Some((xs, ys)) = measured {
        elements.push_str(&match is_sparse(xs) {
            true => path("measured dots", &dots(xs, ys, (&ax, &ay))),
            false => drawn("measured", curve(xs, ys, (&ax, &ay))),
        });
    }
    if let Some((xs, ys)) = run {
        elements.push_str(&drawn("simulated", curve(xs, ys, (&ax, &ay))));
    }
    let (a, b) = (s.axis_label(x), s.axis_label(y));
    let plot = Plot {
        x: &ax,
        y: &ay,
        shape: "square",
        alt: format!("phase portrait of {b} against {a}"),
        x_name: escape(&a),
        y_name: escape(&b),
        elements,
    };
    let names = (s.discovery.name(x), s.discovery.name(y));
    Some(format!(
        "<figure>\n<figcaption><b>{}</b> against {}</figcaption>\n{}</figure>\n",
        escape(&names.1),
        escape(&names.0),
        plot.html()
    ))
}

/// A path with its class, filled if it consists of cells.
fn drawn(class: &str, d: CurvePath) -> String {
    match d.filled {
        true => path(&format!("{class} filled"), &d.d),
        false => path(class, &d.d),
    }
}
