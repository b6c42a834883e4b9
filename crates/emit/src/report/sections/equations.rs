//! The equations, typeset, each with its proof and fit.

use crate::report::markup::{Section, lead};
use crate::report::report_contents::Subject;
use crate::report::sections::verdict::badge;
use crate::text::matrices::derived_forms;
use crate::text::{disturbance, evidence, relations};
use crate::typeset::mathml::{MathMl, escape};
use crate::unknown_constants;
use sidc_lang::term::SignalNames;
use sidc_system::discovery::{Discovery, Equation};

pub(crate) fn html(s: &Subject) -> Section {
    let d = s.discovery;
    let notation = MathMl(d);
    let mut body = String::new();
    for e in &d.equations {
        let pieces = notation.equation(e).join("");
        body.push_str(&format!(
            "<div class=\"equation\">\n<div class=\"formula\">{pieces}</div>\n{} {}\n</div>\n",
            badge(e.status),
            remarks(d, e)
        ));
    }
    for f in &d.failed {
        body.push_str(&format!(
            "<div class=\"equation\">\n<div class=\"formula\">{}</div>\n<span class=\"badge fail\">not found</span>\n</div>\n",
            notation.symbol(f.target)
        ));
    }
    let jumps = d.resets.iter().map(|r| r.text(d));
    let said = jumps.chain(unknown_constants::lines(d));
    let said = said.chain(disturbance::sentences(d));
    let of_inputs = d.delay_sentences().into_iter().chain(d.cubic_sentences());
    for said in said
        .chain(d.hidden_sentences())
        .chain(of_inputs)
        .chain(d.rest_sentences())
    {
        body.push_str(&format!("<p>{}</p>\n", escape(&said)));
    }
    for (head, laws) in relations::told(d) {
        body.push_str(&format!(
            "<p>{}</p>\n<pre tabindex=\"0\">{}</pre>\n",
            escape(&head),
            escape(laws.trim_end_matches('\n'))
        ));
    }
    let searched = relations::searched(d);
    if !searched.is_empty() {
        let lines: String = (searched.iter())
            .map(|l| format!("<li>{}</li>", escape(l)))
            .collect();
        body.push_str(&format!("<ul class=\"remarks\">{lines}</ul>\n"));
    }
    let follows = derived_forms(d);
    if !follows.trim().is_empty() {
        body.push_str(&format!(
            "<h3>What follows from them</h3>\n<pre tabindex=\"0\">{}</pre>\n",
            escape(follows.trim_matches('\n'))
        ));
    }
    Section::new("equations", "Equations and proofs", body)
}

/// Fit and proof as the terminal prints them; reasons and marks have sections of their own.
fn remarks(d: &Discovery, e: &Equation) -> String {
    let lines = evidence::remarks(d, e);
    let lines: String = (lines.iter())
        .map(|l| format!("<li>{}</li>", escape(l)))
        .collect();
    format!("<ul class=\"remarks\">{lines}</ul>")
}

/// The target as a heading. A screen reader gets its name, because it would read dots over letters as punctuation.
pub(super) fn heading(s: &Subject, e: &Equation) -> String {
    let (name, symbol) = (
        s.discovery.name(e.target),
        MathMl(s.discovery).symbol(e.target),
    );
    format!("<h3 aria-label=\"{}\">{symbol}</h3>\n", escape(&name))
}

/// A note on the units of the coefficients, if units were declared.
pub(crate) fn reading(s: &Subject) -> String {
    let has_units = s.discovery.variables.iter().any(|v| v.unit.is_some());
    match has_units {
        true => lead("Units are those that follow from the units declared in the model."),
        false => String::new(),
    }
}
