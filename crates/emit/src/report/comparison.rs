//! Several results on one page: their answers side by side, their predictions, their runs along the same records in one figure.
//!
//! In: subjects that share their data files. Out: one HTML file. Signals of different models are the same if their names are.

use std::collections::BTreeSet;

use crate::report::figure::axis::Axis;
use crate::report::figure::downsampling::{dots, is_sparse, line};
use crate::report::figure::plot::{Plot, path};
use crate::report::markup::{Section, contents, counted, lead, number};
use crate::report::page;
use crate::report::report_contents::{Record, Subject};
use crate::report::sections::trajectories::{fit_text, range, shades, span};
use crate::report::sections::verdict::{badges, equations};
use crate::text::verdict::answers;
use crate::typeset::mathml::escape;
use sidc_lang::term::{Signal, SignalNames};
use sidc_system::predict::SignalPrediction;

/// Number of models that have a colour of their own.
pub const MAX_MODELS: usize = 6;
const MAX_RECORDS: usize = 4;
const MAX_FIGURES: usize = 10;
const MAX_EQUATIONS: usize = 20;

/// The page. Only the first [`MAX_MODELS`] are shown.
pub fn comparison(subjects: &[Subject]) -> String {
    let subjects = subjects
        .get(..MAX_MODELS.min(subjects.len()))
        .unwrap_or(&[]);
    let sections = [
        Section::new("answers", "The answers", answer_table(subjects)),
        Section::new("prediction", "How far ahead", predictions(subjects)),
        Section::new("series", "Runs along the records", runs(subjects)),
        Section::new("equations", "Equations", all_equations(subjects)),
    ];
    let shown: Vec<Section> = sections
        .into_iter()
        .filter(|s| !s.body.is_empty())
        .collect();
    let parts: String = shown.iter().map(Section::html).collect();
    let names: Vec<&str> = subjects.iter().map(|s| s.name).collect();
    let about = format!("{} compared", counted(subjects.len(), "result"));
    page(
        &names.join(", "),
        &about,
        &(contents(&shown) + &parts),
        &names.join(", "),
    )
}

/// The name of a model with the line that stands for it in figures.
fn head(i: usize, name: &str) -> String {
    format!("<span class=\"model-{}\">{}</span>", i + 1, escape(name))
}

fn table(columns: &[String], rows: &str, what: &str) -> String {
    let head: String = columns
        .iter()
        .map(|c| format!("<th scope=\"col\">{c}</th>"))
        .collect();
    format!(
        "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"{what}\"><table class=\"legend-table\">\n<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}</tbody></table></div>\n"
    )
}

/// A row for each model: its number of terms, and the three answers.
fn answer_table(subjects: &[Subject]) -> String {
    let rows = subjects.iter().enumerate().map(|(i, s)| {
        let terms: usize = s.discovery.equations.iter().map(|e| e.terms.len()).sum();
        let texts = s.document.verdict.as_ref().map(|v| answers(s.discovery, v));
        let cells = badges(s).into_iter().enumerate().map(|(k, (class, word))| {
            let said = texts
                .as_ref()
                .and_then(|t| t.get(k))
                .map_or("", |(_, said)| said);
            let said = said
                .strip_prefix(word)
                .unwrap_or(said)
                .trim_start_matches([',', ' ']);
            format!(
                "<td class=\"said\"><span class=\"badge {class}\">{word}</span> {}</td>",
                escape(said)
            )
        });
        let cells: String = cells.collect();
        format!(
            "<tr><th scope=\"row\">{}</th><td>{}</td><td>{terms}</td>{cells}</tr>\n",
            head(i, s.name),
            escape(&s.document.settings.model)
        )
    });
    let rows: String = rows.collect();
    let columns = ["result", "model", "terms", "law", "prediction", "run"].map(String::from);
    table(&columns, &rows, "the answers of each model")
}

/// Prediction errors at the horizon of each result, a row for each signal; the least one in bold.
fn predictions(subjects: &[Subject]) -> String {
    let found = |s: &Subject, name: &str| -> Option<(f64, SignalPrediction)> {
        let p = &s.document.verdict.as_ref()?.prediction;
        let own = p.signals.iter().find(|x| x.signal == name)?;
        Some((p.horizon, own.clone()))
    };
    let verdicts = subjects.iter().filter_map(|s| s.document.verdict.as_ref());
    let mut names = BTreeSet::new();
    let all = verdicts.flat_map(|v| v.prediction.signals.iter().map(|p| p.signal.clone()));
    let names: Vec<String> = all.filter(|n| names.insert(n.clone())).collect();
    let rows = names.iter().map(|name| {
        let errors: Vec<Option<f64>> = subjects
            .iter()
            .map(|s| found(s, name)?.1.error.quantile_90)
            .collect();
        let horizons: Vec<Option<f64>> = subjects.iter().map(|s| Some(found(s, name)?.0)).collect();
        let same = horizons
            .iter()
            .flatten()
            .all(|h| Some(*h) == horizons.iter().flatten().next().copied());
        // Errors at different horizons cannot be compared.
        let least = errors
            .iter()
            .flatten()
            .copied()
            .reduce(f64::min)
            .filter(|_| same);
        let cells =
            subjects
                .iter()
                .zip(errors.iter().zip(&horizons))
                .map(|(s, (error, horizon))| {
                    let (Some(error), Some(horizon)) = (error, horizon) else {
                        return "<td>–</td>".to_string();
                    };
                    let text = format!(
                        "{} at {}",
                        number(*error, 3),
                        escape(&s.duration_text(*horizon))
                    );
                    match least == Some(*error) {
                        true => format!("<td><b>{text}</b></td>"),
                        false => format!("<td>{text}</td>"),
                    }
                });
        let cells: String = cells.collect();
        format!("<tr><th scope=\"row\">{}</th>{cells}</tr>\n", escape(name))
    });
    let rows: String = rows.collect();
    if rows.is_empty() {
        return rows;
    }
    let how = "The error that nine of ten predictions stay below, at the horizon of each result, on the data that each was judged by.";
    lead(how) + &table(&columns("signal", subjects), &rows, "errors of prediction")
}

/// Headings of the first column, and of one for each model.
fn columns(first: &str, subjects: &[Subject]) -> Vec<String> {
    let models = subjects.iter().enumerate().map(|(i, s)| head(i, s.name));
    std::iter::once(first.to_string()).chain(models).collect()
}

/// For each record, its role for each model, the fits, and a figure for each signal.
fn runs(subjects: &[Subject]) -> String {
    let all: Vec<Vec<Record>> = subjects.iter().map(Subject::records).collect();
    let mut places = BTreeSet::new();
    places.extend(
        subjects
            .iter()
            .flat_map(|s| s.runs.iter().map(|r| r.trajectory)),
    );
    let mut out = String::new();
    for place in places.iter().take(MAX_RECORDS) {
        let record = |i: usize| {
            let own = all.get(i)?.iter();
            let mut own = own.filter(|r| {
                let known = subjects
                    .get(i)
                    .and_then(|s| s.dataset.trajectories.get(*place));
                known.is_some_and(|t| std::ptr::eq(t, r.trajectory))
            });
            own.next()
        };
        let own: Vec<(usize, &Subject, &Record)> = subjects
            .iter()
            .enumerate()
            .filter_map(|(i, s)| Some((i, s, record(i)?)))
            .collect();
        out.push_str(&one_record(subjects, &own));
    }
    if places.len() > MAX_RECORDS {
        let all = counted(places.len(), "record");
        out.push_str(&format!(
            "<p>The first {MAX_RECORDS} of {all} are shown.</p>\n"
        ));
    }
    out
}

type Along<'a> = (usize, &'a Subject<'a>, &'a Record<'a>);

fn one_record(subjects: &[Subject], own: &[Along]) -> String {
    let Some((_, _, first)) = own.first() else {
        return String::new();
    };
    let mut out = format!(
        "<h3>{}</h3>\n{}",
        escape(&first.trajectory.name),
        roles(own)
    );
    let mut known = BTreeSet::new();
    let names = own
        .iter()
        .flat_map(|(_, s, r)| r.simulated().into_iter().map(|x| s.discovery.name(x)));
    let names: Vec<String> = names.filter(|n| known.insert(n.clone())).collect();
    let rows: String = names.iter().map(|name| fits(subjects, own, name)).collect();
    out.push_str(&table(&columns("fit", subjects), &rows, "fits of the runs"));
    for name in names.iter().take(MAX_FIGURES) {
        out.push_str(&figure(own, name).unwrap_or_default());
    }
    out
}

/// The role of a record for each model, said once if it is the same for all.
fn roles(own: &[Along]) -> String {
    let said = own
        .iter()
        .map(|(_, s, r)| s.role(r.trajectory).description());
    let said: Vec<&str> = said.collect();
    let first = said.first().copied().unwrap_or("");
    if said.iter().all(|role| *role == first) {
        return lead(&format!("For each model: {first}."));
    }
    let each = own.iter().zip(&said);
    let each: String = each
        .map(|((i, s, _), role)| format!("<li>{}: {role}</li>\n", head(*i, s.name)))
        .collect();
    format!("<ul>\n{each}</ul>\n")
}

/// The signal of this name, if the model simulates it.
fn signal(s: &Subject, r: &Record, name: &str) -> Option<Signal> {
    r.simulated()
        .into_iter()
        .find(|x| s.discovery.name(*x) == name)
}

/// The worst fit of a signal along the record; only of held-out data if there are any.
fn fit(s: &Subject, r: &Record, name: &str) -> Option<f64> {
    let x = signal(s, r, name)?;
    let held = r.scores(x).any(|(held, _, _)| held);
    let own = r.scores(x).filter(|(h, _, _)| *h == held);
    own.map(|(_, _, score)| score.fit).reduce(f64::min)
}

fn fits(subjects: &[Subject], own: &[Along], name: &str) -> String {
    let along = |i: usize| own.iter().find(|(k, _, _)| *k == i);
    let values: Vec<Option<f64>> = (0..subjects.len())
        .map(|i| along(i).and_then(|(_, s, r)| fit(s, r, name)))
        .collect();
    let Some(best) = values.iter().flatten().copied().reduce(f64::max) else {
        return String::new();
    };
    let cells = values.iter().map(|fit| match fit {
        None => "<td>–</td>".to_string(),
        Some(v) if best == *v => format!("<td><b>{}</b></td>", fit_text(*v)),
        Some(v) => format!("<td>{}</td>", fit_text(*v)),
    });
    let cells: String = cells.collect();
    format!("<tr><th scope=\"row\">{}</th>{cells}</tr>\n", escape(name))
}

/// The readings of a signal, and the runs of all models along them.
fn figure(own: &[Along], name: &str) -> Option<String> {
    let with: Vec<(&Along, Signal)> = own
        .iter()
        .filter_map(|a| Some((a, signal(a.1, a.2, name)?)))
        .collect();
    let ((_, s, r), x) = with.first()?;
    let time = span(r)?;
    let measured = r.measured(*x);
    let runs: Vec<(usize, &str, Vec<f64>, Vec<f64>)> = with
        .iter()
        .filter_map(|((i, s, r), x)| {
            let (time, values) = r.column(*x)?;
            Some((*i, s.name, time, values))
        })
        .collect();
    let ranges = runs
        .iter()
        .filter_map(|(_, _, _, values)| range(measured, values));
    let y: Axis = ranges.reduce(Axis::with)?;
    let axes = (&time, &y);
    let mut elements = shades(&s.role(r.trajectory), &time);
    if let Some(values) = measured {
        elements.push_str(&match is_sparse(values) {
            true => path("measured dots", &dots(&r.trajectory.time, values, axes)),
            false => path("measured", &line(&r.trajectory.time, values, axes)),
        });
    }
    for (i, model, instants, values) in &runs {
        elements.push_str(&format!(
            "<path class=\"model model-{}\" data-name=\"{}\" d=\"{}\"/>",
            i + 1,
            escape(model),
            line(instants, values, axes)
        ));
    }
    let plot = Plot {
        x: &time,
        y: &y,
        shape: "tall",
        alt: format!(
            "{name} along {}: readings and {}",
            r.trajectory.name,
            counted(runs.len(), "run")
        ),
        x_name: escape(&s.time_label()),
        y_name: escape(&s.axis_label(*x)),
        elements,
    };
    let legend = runs.iter().map(|(i, model, _, _)| head(*i, model));
    let readings = measured.map(|_| "<span class=\"measured\">measured</span>".to_string());
    let legend: String = readings.into_iter().chain(legend).collect();
    Some(format!(
        "<figure>\n<figcaption><b>{}</b></figcaption>\n<p class=\"legend\" aria-hidden=\"true\">{legend}</p>\n{}</figure>\n",
        escape(name),
        plot.html()
    ))
}

fn all_equations(subjects: &[Subject]) -> String {
    let each = subjects.iter().enumerate().map(|(i, s)| {
        format!(
            "<h3>{}</h3>\n{}",
            head(i, s.name),
            equations(s.discovery, MAX_EQUATIONS)
        )
    });
    each.collect()
}
