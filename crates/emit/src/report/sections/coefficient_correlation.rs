//! Correlations between the errors of coefficients that were estimated together: a matrix if it is small enough to read, else the strongest
//! pairs.

use crate::report::markup::{counted, lead, number};
use crate::report::report_contents::Subject;
use crate::typeset::mathml::{MathMl, escape};
use sidc_lang::term::{Language, SignalNames};
use sidc_system::discovery::Correlations;

/// Most coefficients that are shown as a matrix.
const MAX_COEFFICIENTS: usize = 16;
/// Pairs that are listed if there are more coefficients.
const MAX_PAIRS: usize = 12;

/// Empty if no fit has two coefficients.
pub(crate) fn html(s: &Subject) -> String {
    let fits = s.discovery.correlations.iter().filter(|c| c.of.len() > 1);
    let each: String = fits.map(|c| one_fit(s, c)).collect();
    if each.is_empty() {
        return each;
    }
    let how = "Errors of numbers that were estimated together. Near 1 or −1 the data tell one combination of the two and not each.";
    format!("<h3>Correlation of the errors</h3>\n{}{each}", lead(how))
}

fn one_fit(s: &Subject, c: &Correlations) -> String {
    match c.of.len() <= MAX_COEFFICIENTS {
        true => matrix(s, c),
        false => pairs(s, c),
    }
}

/// The part below the diagonal; columns have the numbers of the rows.
fn matrix(s: &Subject, c: &Correlations) -> String {
    let head: String = (1..c.of.len())
        .map(|k| format!("<th scope=\"col\">{k}</th>"))
        .collect();
    let rows = (0..c.of.len()).map(|i| {
        let cells: String = (0..i).map(|j| cell(c, i, j)).collect();
        format!(
            "<tr><th scope=\"row\">{} {}</th>{cells}</tr>\n",
            i + 1,
            name(s, c, i)
        )
    });
    let rows: String = rows.collect();
    format!(
        "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"correlation of the errors\"><table class=\"correlations\">\n<thead><tr><td></td>{head}</tr></thead>\n<tbody>\n{rows}</tbody></table></div>\n"
    )
}

/// The stronger the correlation, the stronger the colour.
fn cell(c: &Correlations, i: usize, j: usize) -> String {
    let r = c.between(i, j).unwrap_or(f64::NAN);
    let sign = if r < 0.0 { "against" } else { "with" };
    format!(
        "<td class=\"{sign}\" style=\"--r:{:.2}\">{}</td>",
        r.abs(),
        number((r * 100.0).round() / 100.0, 2)
    )
}

fn pairs(s: &Subject, c: &Correlations) -> String {
    let all = (0..c.of.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    let mut strong: Vec<(f64, usize, usize)> = all
        .filter_map(|(i, j)| Some((c.between(i, j)?, i, j)))
        .collect();
    strong.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    let rows = strong.iter().take(MAX_PAIRS).map(|(r, i, j)| {
        format!(
            "<tr><td>{}</td><td>{}</td><td>{}</td></tr>\n",
            name(s, c, *j),
            name(s, c, *i),
            number(*r, 3)
        )
    });
    let rows: String = rows.collect();
    format!(
        "<p>The strongest of {}:</p>\n<table>\n<tbody>\n{rows}</tbody></table>\n",
        counted(strong.len(), "pair")
    )
}

/// The term, after its target if the fit has several equations.
fn name(s: &Subject, c: &Correlations, place: usize) -> String {
    let Some((target, term)) = c.of.get(place) else {
        return String::new();
    };
    let d = s.discovery;
    let equation = d.equations.iter().find(|e| d.name(e.target) == *target);
    let found = equation.and_then(|e| {
        let mut terms = e.terms.iter();
        terms.find(|t| Language(d).term(&t.term) == *term)
    });
    let term = found.map_or_else(|| escape(term), |t| MathMl(d).term(&t.term));
    // Constants stand in no equation.
    let mut equations = c.of.iter().filter(|(other, _)| !other.is_empty());
    let several = equations.any(|(other, _)| other != target);
    match (several, equation) {
        (true, Some(e)) => format!("{}: {term}", MathMl(d).symbol(e.target)),
        _ => term,
    }
}
