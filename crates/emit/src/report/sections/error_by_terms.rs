//! Error against number of terms: of several models on data held out, and along the solution path of one.

use crate::report::figure::axis::{Axis, extremes};
use crate::report::figure::downsampling::{height, place};
use crate::report::figure::plot::{Plot, path};
use crate::report::markup::{Section, lead, number};
use crate::report::report_contents::Subject;
use crate::thresholds::FIGURES;
use crate::typeset::mathml::escape;
use sidc_system::result::{CandidateEntry, EquationEntry};

pub(crate) fn html(s: &Subject) -> Section {
    let mut body = candidates(&s.document.candidates);
    let paths: String = s.document.equations.iter().filter_map(knots).collect();
    if !paths.is_empty() {
        body.push_str(&lead(
            "The path to each answer: what the smallest 1-norm leaves of the target as terms come in, on the rows that the equation was found from.",
        ));
        body.push_str(&format!("<div class=\"thirds\">\n{paths}</div>\n"));
    }
    Section::new("growth", "Error against number of terms", body)
}

fn candidates(all: &[CandidateEntry]) -> String {
    let errors: Vec<f64> = all.iter().filter_map(|c| c.error_db).collect();
    let most = all.iter().map(|c| c.terms).max();
    let (Some((low, high)), Some(most)) = (extremes(errors.iter()), most) else {
        return String::new();
    };
    // A difference of a decibel must not look large.
    let room = (0.04 * (high - low)).max(0.5 * (FIGURES.error_span - (high - low)));
    let y = Axis::new(low - room, high + room);
    let x = Axis::new(0.0, most as f64 * 1.1 + 1.0);
    let dot = |c: &CandidateEntry| -> Option<String> {
        let (x, y) = (place(&x, c.terms as f64), height(&y, c.error_db?));
        let class = match (c.best, c.front) {
            (true, _) => "best",
            (_, true) => "front",
            _ => "other",
        };
        Some(path(&format!("spot {class}"), &format!("M{x} {y}h0")))
    };
    let plot = Plot {
        x: &x,
        y: &y,
        shape: "tall",
        alt: "error on data held out against number of terms, a dot for each model".into(),
        x_name: "terms in all equations".into(),
        y_name: "error/signal (dB)".into(),
        elements: all.iter().filter_map(dot).collect(),
    };
    let rows: String = all.iter().map(row).collect();
    format!(
        "{}<figure>\n<figcaption>models by the error of their free runs on data held out; the best is filled, the Pareto front ringed</figcaption>\n{}</figure>\n\
         <div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"models compared\"><table>\n<thead><tr><th scope=\"col\">model</th><th scope=\"col\">terms</th><th scope=\"col\">error (dB)</th>\
         <th scope=\"col\">runs of</th><th scope=\"col\"></th></tr></thead>\n<tbody>\n{rows}</tbody></table></div>\n",
        lead("Every model was found from the same data and run on what was held out."),
        plot.html()
    )
}

fn row(c: &CandidateEntry) -> String {
    let error = c
        .error_db
        .map_or("ended early".to_string(), |e| number(e, 4));
    let mut words = Vec::new();
    if c.best {
        words.push("best");
    } else if c.front {
        words.push("on the Pareto front");
    }
    if !c.passes {
        words.push("doubted");
    }
    format!(
        "<tr><th scope=\"row\">{}</th><td>{}</td><td>{error}</td><td>{}</td><td>{}</td></tr>\n",
        escape(&c.model),
        c.terms,
        number(c.seconds, 4),
        words.join(", ")
    )
}

/// The solution path of one equation, if it has one.
fn knots(e: &EquationEntry) -> Option<String> {
    let floor = 1e-17;
    let points: Vec<(f64, f64)> = (e.path.iter())
        .map(|k| (k.terms.len() as f64, k.residual.max(floor).log10()))
        .filter(|p| p.1.is_finite())
        .collect();
    let heights: Vec<f64> = points.iter().map(|p| p.1).collect();
    let widths: Vec<f64> = points.iter().map(|p| p.0).collect();
    let (low, high) = extremes(heights.iter())?;
    let y = Axis::new(low.floor() - 0.2, high.ceil() + 0.2);
    let x = Axis::new(-0.4, extremes(widths.iter())?.1 + 0.6);
    let mut d = String::new();
    for (terms, residual) in &points {
        d.push_str(&format!(
            "M{} {}h0",
            place(&x, *terms),
            height(&y, *residual)
        ));
    }
    let answer = e.path.last()?;
    let plot = Plot {
        x: &x,
        y: &y,
        shape: "low",
        alt: format!(
            "path of {}: from no term to {} terms, which leave {} of the target",
            e.target,
            answer.terms.len(),
            number(answer.residual, 2)
        ),
        x_name: "terms".into(),
        y_name: "log₁₀ residual".into(),
        elements: path("measured dots", &d),
    };
    Some(format!(
        "<figure>\n<figcaption><b>{}</b> residual, parts of the target</figcaption>\n{}</figure>\n",
        escape(&e.target),
        plot.html()
    ))
}
