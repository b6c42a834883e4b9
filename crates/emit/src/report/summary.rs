//! The first part of a report alone, for a page with other content, such as the output of a notebook cell.
//!
//! In: a discovery with its document. Out: one HTML element whose style affects nothing outside it. Shows no data.

use super::STYLE;
use super::report_contents::Subject;
use super::sections::coefficients;
use super::sections::verdict::{equations, reasons};
use crate::text::verdict;
use crate::typeset::mathml::escape;
use sidc_data::Dataset;
use sidc_system::discovery::Discovery;
use sidc_system::result::Document;

/// Equations, the three answers with the reasons against them, coefficients with their intervals.
pub fn summary(discovery: &Discovery, document: &Document) -> String {
    let subject = Subject {
        discovery,
        document,
        name: "",
        dataset: &Dataset::default(),
        runs: &[],
        files: &[],
    };
    let body = [
        equations(discovery, usize::MAX),
        answers(discovery, document),
        coefficients::tables(&subject),
    ];
    format!(
        "<div class=\"sidc\">\n<style>\n{}</style>\n{}</div>\n",
        scoped_style(),
        body.concat()
    )
}

/// The style of the page, limited to the element: its rules are nested, and those of `:root` apply to the element itself.
fn scoped_style() -> String {
    let own =
        "background: var(--paper); color: var(--ink); padding: 0.2rem 0.8rem; max-width: 66rem;";
    let rules = STYLE.replace(":root", "&");
    format!(".sidc {{\n{own}\n{rules}}}\n")
}

/// The law, the prediction, the run, a line each; then what speaks against the equations.
fn answers(d: &Discovery, document: &Document) -> String {
    let mut out = String::new();
    if let Some(answers) = &document.verdict {
        for line in verdict::sentences(d, answers) {
            out.push_str(&format!("<p>{}</p>\n", escape(&line)));
        }
    }
    out + &reasons(d, |_| String::new())
}
