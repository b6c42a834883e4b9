//! Measured and simulated trajectories, record by record, with residuals; inputs below.

use crate::report::figure::axis::Axis;
use crate::report::figure::downsampling::{dots, is_sparse, line};
use crate::report::figure::plot::{Plot, path, shade};
use crate::report::markup::{Section, counted, fixed, grouped, lead, number};
use crate::report::report_contents::{Record, Role, Subject};
use crate::thresholds::FIGURES;
use crate::typeset::mathml::escape;
use sidc_lang::term::{Signal, SignalNames};

/// Note on runs that leave their readings whatever the equations are.
pub(crate) const SENSITIVE: &str = "<p>Two runs whose starts differ by the error of the readings part here: a free run leaves its record whatever the equations, and says nothing of them. What they are worth is told by <a href=\"#prediction\">how far ahead they predict</a>.</p>\n";

/// Most records with figures, and most figures of one record.
const MAX_RECORDS: usize = 4;
const MAX_FIGURES: usize = 10;

pub(crate) fn html(s: &Subject) -> Section {
    let records = s.records();
    if records.is_empty() {
        return Section::default();
    }
    let how = "Each record is run freely: the equations start at its first row and are driven by its inputs; no other reading corrects them. \
         Of long records every pixel column shows the least and the greatest value in it, so that a single stray sample is seen. Rows that a noisy start was fitted to have no error.";
    let mut body = lead(how);
    if s.is_sensitive() {
        body.push_str(SENSITIVE);
    }
    let is_held = |r: &Record| r.runs.iter().any(|(held, _)| *held);
    let held = match records.iter().any(is_held) {
        true => "<span class=\"held\">held out</span>",
        false => "",
    };
    body.push_str(&format!(
        "<p class=\"legend\" aria-hidden=\"true\"><span class=\"measured\">measured</span><span class=\"simulated\">simulated</span>\
         <span class=\"residual\">simulated − measured</span>{held}</p>\n"
    ));
    for record in records.iter().take(MAX_RECORDS) {
        body.push_str(&pictures(s, record));
    }
    if records.len() > MAX_RECORDS {
        body.push_str(&format!(
            "<p>Pictures are those of the first {MAX_RECORDS} of {}; the table has all.</p>\n",
            counted(records.len(), "record")
        ));
    }
    body.push_str(&scores(s, &records));
    Section::new("series", "Measured against simulated", body)
}

fn pictures(s: &Subject, r: &Record) -> String {
    let role = s.role(r.trajectory);
    let mut out = format!(
        "<h3>{}</h3>\n<p class=\"lead\">{}; {}.</p>\n",
        escape(&r.trajectory.name),
        counted(r.trajectory.len(), "row"),
        role.description()
    );
    for fault in r.runs.iter().filter_map(|(_, run)| run.fault()) {
        out.push_str(&format!(
            "<p class=\"verdict doubt\"><span class=\"badge doubt\">ended early</span> at {}: {}. What was run up to there is shown.</p>\n",
            escape(&s.time_text(fault.time)),
            escape(&fault.text(s.discovery))
        ));
    }
    let Some(time) = span(r) else { return out };
    let signals = r.simulated();
    let (with, alone): (Vec<Signal>, Vec<Signal>) =
        signals.iter().partition(|x| r.measured(**x).is_some());
    let inputs = r.inputs();
    let shown: Vec<Signal> = with.into_iter().chain(alone).collect();
    for signal in shown.iter().take(MAX_FIGURES) {
        out.push_str(&picture(s, r, *signal, (&time, &role)).unwrap_or_default());
    }
    let left = shown.len().saturating_sub(MAX_FIGURES);
    if left > 0 {
        out.push_str(&format!(
            "<p>{} more not drawn.</p>\n",
            counted(left, "signal")
        ));
    }
    for signal in inputs.iter().take(MAX_FIGURES) {
        out.push_str(&input(s, r, *signal, (&time, &role)).unwrap_or_default());
    }
    out
}

/// The time of a record.
pub(crate) fn span(r: &Record) -> Option<Axis> {
    let (first, last) = (r.trajectory.time.first()?, r.trajectory.time.last()?);
    Some(Axis::new(*first, *last))
}

/// Shades the hold-out ranges.
pub(crate) fn shades(role: &Role, time: &Axis) -> String {
    let Role::Used(held) = role else {
        return String::new();
    };
    let one = |(from, to): &(f64, f64)| shade("held", time, *from, *to);
    held.iter().map(one).collect()
}

fn picture(s: &Subject, r: &Record, x: Signal, (time, role): (&Axis, &Role)) -> Option<String> {
    let (instants, simulated) = r.column(x)?;
    let measured = r.measured(x);
    let y = range(measured, &simulated)?;
    let mut elements = shades(role, time);
    if let Some(values) = measured {
        let axes = (time, &y);
        elements.push_str(&match is_sparse(values) {
            true => path("measured dots", &dots(&r.trajectory.time, values, axes)),
            false => path("measured", &line(&r.trajectory.time, values, axes)),
        });
    }
    elements.push_str(&path("simulated", &line(&instants, &simulated, (time, &y))));
    let name = s.discovery.name(x);
    let words = description(s, r, x);
    let main = Plot {
        x: time,
        y: &y,
        shape: if measured.is_some() { "tall" } else { "low" },
        alt: format!("{name} along {}: {words}", r.trajectory.name),
        x_name: if measured.is_some() {
            String::new()
        } else {
            escape(&s.time_label())
        },
        y_name: escape(&s.axis_label(x)),
        elements,
    };
    let mut out = format!(
        "<figure>\n<figcaption><b>{}</b> {}</figcaption>\n{}",
        escape(&name),
        escape(&words),
        main.html()
    );
    if let Some((instants, left)) = r.residual(x) {
        let most = left
            .iter()
            .filter(|e| e.is_finite())
            .fold(0.0, |m: f64, e| m.max(e.abs()));
        let y = Axis::new(-1.08 * most.max(1e-300), 1.08 * most.max(1e-300));
        let low = Plot {
            x: time,
            y: &y,
            shape: "low",
            alt: format!(
                "simulated less measured {name}, at most {}",
                number(most, 2)
            ),
            x_name: escape(&s.time_label()),
            y_name: "error".into(),
            elements: shades(role, time) + &path("residual", &line(&instants, &left, (time, &y))),
        };
        out.push_str(&low.html());
    }
    Some(out + "</figure>\n")
}

/// The measured range, extended by the simulated one if that is near.
pub(crate) fn range(measured: Option<&[f64]>, simulated: &[f64]) -> Option<Axis> {
    let simulated = Axis::over(simulated.iter());
    let Some(own) = measured.and_then(|m| Axis::over(m.iter())) else {
        return simulated;
    };
    let Some(simulated) = simulated else {
        return Some(own);
    };
    let room = FIGURES.overshoot * (own.high - own.low);
    let near = Axis {
        low: simulated.low.max(own.low - room),
        high: simulated.high.min(own.high + room),
    };
    Some(match near.low < near.high {
        true => own.with(near),
        false => own,
    })
}

/// A fit in per cent; one below 0, worse than the mean of the readings, only says that.
pub(crate) fn fit_text(fit: f64) -> String {
    match fit < 0.0 {
        true => "below 0".into(),
        false => format!("{} %", fixed(fit, 2)),
    }
}

/// `fit 99.95 %, error/signal −65.5 dB, followed to the end`, then the same of data held out.
fn description(s: &Subject, r: &Record, x: Signal) -> String {
    let said: Vec<String> = r
        .scores(x)
        .map(|(held, _, score)| {
            let follows = match score.follows {
                None => "followed to the end".into(),
                Some(t) => format!("followed for {}", s.duration_text(t)),
            };
            let held = if held { "held out: " } else { "" };
            match score.fit < 0.0 {
                true => format!("{held}{follows}, then farther off than their mean"),
                false => format!(
                    "{held}fit {}, error/signal {} dB, {follows}",
                    fit_text(score.fit),
                    fixed(score.error_to_signal, 1)
                ),
            }
        })
        .collect();
    match said.is_empty() {
        true => "not measured: simulated alone".into(),
        false => said.join("; "),
    }
}

fn input(s: &Subject, r: &Record, u: Signal, (time, role): (&Axis, &Role)) -> Option<String> {
    let (instants, values) = r.input(u)?;
    let y = Axis::over(values.iter())?;
    let name = s.discovery.name(u);
    let plot = Plot {
        x: time,
        y: &y,
        shape: "low",
        alt: format!("input {name} along {}", r.trajectory.name),
        x_name: escape(&s.time_label()),
        y_name: escape(&s.axis_label(u)),
        elements: shades(role, time) + &path("input", &line(&instants, &values, (time, &y))),
    };
    Some(format!(
        "<figure>\n<figcaption><b>{}</b> input, as it was applied</figcaption>\n{}</figure>\n",
        escape(&name),
        plot.html()
    ))
}

/// All scores as a table.
fn scores(s: &Subject, records: &[Record]) -> String {
    const MAX_ROWS: usize = 200;
    let all = records.iter().flat_map(|r| {
        let runs = r.runs.iter();
        runs.flat_map(move |(held, run)| run.scores.iter().map(move |c| (r, *held, run, c)))
    });
    let rows: String = (all.clone().take(MAX_ROWS))
        .map(|(r, held, run, c)| {
            let follows = c.follows.map_or("to the end".to_string(), |t| s.duration_text(t));
            let end = |t: Option<&f64>| number(t.copied().unwrap_or(f64::NAN), 6);
            format!(
                "<tr><th scope=\"row\">{}</th><td>{}</td><td>{} to {}{}</td><td>{}</td><td>{}</td><td>{} dB</td><td>{}</td><td>{}</td></tr>\n",
                escape(&s.discovery.name(c.signal)),
                escape(&r.trajectory.name),
                end(run.time.first()),
                end(run.time.last()),
                if held { ", held out" } else { "" },
                number(c.mse.sqrt(), 3),
                fit_text(c.fit),
                fixed(c.error_to_signal, 1),
                escape(&follows),
                grouped(c.rows)
            )
        })
        .collect();
    if rows.is_empty() {
        return "<p>Nothing that is simulated was measured after the start: there are no scores.</p>\n".into();
    }
    let more = all.count().saturating_sub(MAX_ROWS);
    let more = match more {
        0 => String::new(),
        n => format!("<p>{} more not listed.</p>\n", counted(n, "score")),
    };
    format!(
        "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"scores of the free runs\"><table>\n<thead><tr><th scope=\"col\">signal</th><th scope=\"col\">record</th><th scope=\"col\">from, to</th>\
         <th scope=\"col\">rms error</th><th scope=\"col\">fit</th><th scope=\"col\">error/signal</th><th scope=\"col\">followed</th>\
         <th scope=\"col\">rows</th></tr></thead>\n<tbody>\n{rows}</tbody></table></div>\n{more}"
    )
}
