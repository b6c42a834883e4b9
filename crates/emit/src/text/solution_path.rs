//! The solution path of an equation as a table: how it grows term by term as the penalty falls.

use crate::text::layout::column_widths;
use crate::thresholds::PRINTED;
use sidc_lang::number::significant;
use sidc_lang::term::Language;
use sidc_system::discovery::{Discovery, Equation, PathKnot};

const HEAD: [&str; 5] = ["", "penalty", "residual", "terms", "gap"];
const DIGITS: usize = 3;
/// Only the order of magnitude of a gap matters.
const GAP_DIGITS: usize = 1;

/// A line for each knot, with the terms that enter (+) and leave (-); empty without a path.
pub(crate) fn table(d: &Discovery, e: &Equation) -> String {
    let (Some(last), Some(evidence)) = (e.path.last(), &e.evidence) else {
        return String::new();
    };
    let rows: Vec<[String; 5]> = std::iter::once(HEAD.map(String::from))
        .chain(e.path.iter().map(figures))
        .collect();
    let widths = column_widths(rows.iter().map(<[String; 5]>::as_slice));
    let tolerance = evidence.certificate.tolerance;
    let met = last.residual <= tolerance * (1.0 + PRINTED.path_tolerance) + PRINTED.path_rounding;
    let mut changes = vec!["change".to_string()];
    changes.extend(e.path.iter().map(|k| change(d, k)));
    if let Some(end) = changes.last_mut().filter(|_| met) {
        *end = "within the tolerance".into();
    }
    let mut out = format!("    path: {}\n", knots(last.number));
    let mut before = 0;
    for (i, (row, change)) in rows.iter().zip(changes).enumerate() {
        let number = i.checked_sub(1).and_then(|k| e.path.get(k));
        let number = number.map_or(0, |k| k.number);
        if number > before + 1 {
            out.push_str(&format!("    … {} more\n", knots(number - before - 1)));
        }
        before = number;
        let cells = row.iter().zip(&widths);
        let cells: Vec<String> = cells.map(|(text, w)| format!("{text:>w$}")).collect();
        out.push_str(format!("    {}  {change}", cells.join("  ")).trim_end());
        out.push('\n');
    }
    if !met {
        out.push_str(&format!(
            "    the path ends here, short of the tolerance {}\n",
            significant(tolerance, DIGITS)
        ));
    }
    out
}

fn knots(count: usize) -> String {
    match count {
        1 => "1 knot".into(),
        n => format!("{n} knots"),
    }
}

fn figures(k: &PathKnot) -> [String; 5] {
    [
        k.number.to_string(),
        significant(k.penalty, DIGITS),
        significant(k.residual, DIGITS),
        k.terms.len().to_string(),
        // A negative gap is rounding.
        significant(k.gap.abs(), GAP_DIGITS),
    ]
}

fn change(d: &Discovery, k: &PathKnot) -> String {
    let signed = |sign: char, term: &Option<_>| -> String {
        let term = term.as_ref().map(|t| Language(d).term(t));
        term.map_or_else(String::new, |t| format!("{sign} {t}"))
    };
    format!("{}{}", signed('+', &k.enters), signed('-', &k.leaves))
}
