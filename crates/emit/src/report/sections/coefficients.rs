//! Coefficients: interval, stability, mark, and the best equation without the term.

use crate::report::markup::{Section, lead, number};
use crate::report::report_contents::Subject;
use crate::report::sections::coefficient_correlation;
use crate::report::sections::equations::{heading, reading};
use crate::text::coefficient_inference::without;
use crate::thresholds::FIGURES;
use crate::typeset::mathml::{MathMl, escape};
use sidc_lang::number::distinguishing_digits;
use sidc_lang::term::Language;
use sidc_system::discovery::{Equation, FoundTerm, Mark, TermEvidence};

/// Width of a row's box.
const ROW_WIDTH: f64 = 1000.0;

pub(crate) fn html(s: &Subject) -> Section {
    let body = tables(s);
    if body.is_empty() {
        return Section::default();
    }
    let how = "The dot is the coefficient, the bar its 95 % interval, as deviation from the coefficient in per cent of it; bars of one equation share a scale. \
         Stability is the share of half records in which the term was found again. A loss says what the criterion loses without the term: 6 are odds of 20 to 1, 20 of 22,000 to 1.";
    Section::new(
        "coefficients",
        "Coefficients",
        lead(how) + &reading(s) + &body + &coefficient_correlation::html(s),
    )
}

/// A table for each equation that has terms.
pub(crate) fn tables(s: &Subject) -> String {
    let found = s.discovery.equations.iter();
    let with_terms = found.filter(|e| !e.terms.is_empty());
    with_terms.map(|e| table(s, e)).collect()
}

fn table(s: &Subject, e: &Equation) -> String {
    let widest = e.terms.iter().filter_map(deviation);
    let widest = widest
        .flat_map(|(a, b)| [a.abs(), b.abs()])
        .fold(0.0, f64::max);
    let scale = if widest > FIGURES.interval_rounding {
        widest.min(FIGURES.deviation)
    } else {
        0.0
    };
    let rows: String = e.terms.iter().map(|t| row(s, e, t, scale)).collect();
    let axis = match scale > 0.0 {
        true => format!(
            "<div class=\"scale\" aria-hidden=\"true\"><span>−{0} %</span><span>0</span><span>+{0} %</span></div>",
            number(100.0 * scale, 2)
        ),
        false => String::new(),
    };
    let target = heading(s, e);
    format!(
        "{target}<table class=\"terms\">\n<thead><tr><th scope=\"col\">term</th><th scope=\"col\">coefficient</th>\
         <th scope=\"col\">95 % interval{axis}</th><th scope=\"col\">stability</th><th scope=\"col\">mark</th><th scope=\"col\">without it</th></tr></thead>\n\
         <tbody>\n{rows}</tbody>\n</table>\n"
    )
}

fn row(s: &Subject, e: &Equation, t: &FoundTerm, scale: f64) -> String {
    let d = s.discovery;
    let unit = d.coefficient_unit(e.target, &t.term).map(|u| u.to_string());
    let unit = unit.filter(|u| u != "1").map_or_else(String::new, |u| {
        format!(" <span class=\"unit\">{}</span>", escape(&u))
    });
    let trust = t.evidence.as_deref();
    let figure = match t.fixed {
        true => "<span class=\"muted\">stated by the model</span>".into(),
        false => interval(d, t, scale),
    };
    let stability = trust.and_then(|t| t.stability).map_or_else(
        || "<span class=\"muted\">–</span>".to_string(),
        |share| {
            let percent = number(100.0 * share, 3);
            format!(
                "<span class=\"share\" aria-hidden=\"true\"><i style=\"width:{:.1}%\"></i></span> {percent} %",
                100.0 * share.clamp(0.0, 1.0)
            )
        },
    );
    let cell = |class: &str, head: &str, inner: &str| {
        format!("<td class=\"{class}\" data-head=\"{head}\">{inner}</td>")
    };
    format!(
        "<tr><th scope=\"row\">{}</th>{}{}{}{}{}</tr>\n",
        MathMl(d).term(&t.term),
        cell(
            "figure",
            "coefficient",
            &format!("{}{unit}", number(t.coefficient, 6))
        ),
        cell("interval", "95 % interval", &figure),
        cell("stability", "stability", &stability),
        cell("mark", "mark", &trust.map_or_else(String::new, mark)),
        cell(
            "without",
            "without it",
            &trust
                .and_then(|t| t.without.as_ref())
                .map_or_else(String::new, |w| escape(&without(w)))
        ),
    )
}

/// Distances of the interval's ends from the coefficient, relative to it.
fn deviation(t: &FoundTerm) -> Option<(f64, f64)> {
    let (low, high) = t.evidence.as_ref()?.interval?;
    let c = t.coefficient;
    let (a, b) = ((low - c) / c.abs(), (high - c) / c.abs());
    (a.is_finite() && b.is_finite()).then_some((a, b))
}

fn interval(d: &sidc_system::discovery::Discovery, t: &FoundTerm, scale: f64) -> String {
    let (Some((a, b)), Some((low, high))) =
        (deviation(t), t.evidence.as_ref().and_then(|t| t.interval))
    else {
        return "<span class=\"muted\">none</span>".into();
    };
    let x = |share: f64| (ROW_WIDTH * (0.5 + 0.46 * (share / scale).clamp(-1.08, 1.08))).round();
    // Zero lies at −100 % or +100 %, depending on the sign of the coefficient.
    let zero = if t.coefficient > 0.0 { -1.0 } else { 1.0 };
    let zero = match scale >= 1.0 {
        true => format!("<path class=\"zero\" d=\"M{0} 0v100\"/>", x(zero)),
        false => String::new(),
    };
    let digits = distinguishing_digits(low, high);
    let words = match high - low > 2.0 * FIGURES.interval_rounding * t.coefficient.abs() {
        true => format!("{} to {}", number(low, digits), number(high, digits)),
        false => "no wider than rounding".into(),
    };
    let drawn = match scale > 0.0 {
        true => format!(
            "<svg role=\"img\" aria-label=\"95 % interval of {}: {words}\" viewBox=\"0 0 1000 100\" preserveAspectRatio=\"none\">\
             <path class=\"grid\" d=\"M500 0v100\"/>{zero}<path class=\"bar\" d=\"M{} 50H{}\"/><path class=\"point\" d=\"M500 50h0\"/></svg>",
            escape(&Language(d).term(&t.term)),
            x(a),
            x(b)
        ),
        false => String::new(),
    };
    format!("{drawn}<span class=\"ends\">{words}</span>")
}

fn mark(trust: &TermEvidence) -> String {
    let class = match trust.mark {
        Mark::Firm => "pass",
        Mark::Likely => "known",
        Mark::Doubtful => "doubt",
    };
    format!("<span class=\"badge {class}\">{}</span>", trust.mark.name())
}
