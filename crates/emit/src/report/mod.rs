//! A result as one page: the answer on the first screen, then parts that can be folded: reasons, coefficients, predictions, free runs and
//! their errors, proofs, the data, how to reproduce it.
//!
//! In: a [`Subject`]. Out: one HTML file without network access, the same bytes for the same subject. All text is
//! escaped. Reads no files, simulates and judges nothing.

mod comparison;
mod figure;
mod markup;
mod report_contents;
mod sections;
mod summary;

pub use comparison::{MAX_MODELS, comparison};
pub use report_contents::{RecordRun, Subject, run_windows};
pub use summary::summary;

use crate::report::sections::{
    coefficients, collinearity, data_coverage, equations, error_by_terms, phase_portraits,
    prediction, reasons, reproduction, residuals, trajectories, verdict,
};
use crate::typeset::mathml::escape;
use markup::{Section, contents, counted};

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// The page.
pub fn html(s: &Subject) -> String {
    let name = s.discovery.system.as_deref().unwrap_or("system");
    let late = || {
        [
            phase_portraits::html(s),
            residuals::html(s),
            data_coverage::html(s),
        ]
    };
    // Sections that go through millions of samples are made in parallel, except in a browser, where no threads can be started.
    let (series, [portraits, residuals, coverage]) = if cfg!(target_arch = "wasm32") {
        (trajectories::html(s), late())
    } else {
        std::thread::scope(|scope| {
            let other = scope.spawn(late);
            let series = trajectories::html(s);
            (series, other.join().unwrap_or_else(|_| late()))
        })
    };
    let sections = [
        reasons::html(s),
        coefficients::html(s),
        prediction::html(s),
        series,
        residuals,
        portraits,
        equations::html(s),
        error_by_terms::html(s),
        collinearity::html(s),
        coverage,
        reproduction::html(s),
    ];
    let sections: Vec<Section> = sections
        .into_iter()
        .filter(|s| !s.body.is_empty())
        .collect();
    let parts: String = sections.iter().map(Section::html).collect();
    let body = verdict::html(s) + &contents(&sections) + &parts;
    page(&name.replace('_', " "), &about(s), &body, s.name)
}

/// A complete page. `body` is HTML, the rest plain text.
fn page(title: &str, about: &str, body: &str, file: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
         <meta name=\"color-scheme\" content=\"light dark\"/>\n<title>{title}: identified equations</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<header>\n\
         <h1>{title}</h1>\n<p>{about}</p>\n</header>\n<main>\n{body}</main>\n<footer><p>Written by sidc from {file}.</p></footer>\n\
         <script>\n{SCRIPT}</script>\n</body>\n</html>\n",
        title = escape(title),
        about = escape(about),
        file = escape(file),
    )
}

/// `2 equations, found from pendulum.csv with pendulum.sid`
fn about(s: &Subject) -> String {
    let settings = &s.document.settings;
    let all = s.discovery.equations.len() + s.discovery.failed.len();
    let mut text = counted(all, "equation");
    match settings.data.as_slice() {
        [] => {}
        [one] => text.push_str(&format!(", found from {one}")),
        many => text.push_str(&format!(", found from {}", counted(many.len(), "record"))),
    }
    let rows = s
        .discovery
        .equations
        .iter()
        .filter_map(|e| e.evidence.as_ref());
    if let Some(rows) = rows.map(|e| e.rows).max().filter(|n| *n > 0) {
        text.push_str(&format!(" ({})", counted(rows, "row")));
    }
    if !settings.model.is_empty() {
        text.push_str(&format!(" with {}", settings.model));
    }
    text
}
