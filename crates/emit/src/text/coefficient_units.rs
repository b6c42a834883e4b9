//! Units of the coefficients, under their equation.

use crate::text::layout::LINE_WIDTH;
use sidc_lang::term::{Language, Precedence, write_term};
use sidc_system::discovery::{Discovery, Equation};

const HEAD: &str = "    units: ";

/// `units: dy 1/s, F 1/kg`: each term whose coefficient has a known unit; empty if none has.
pub(crate) fn lines(d: &Discovery, e: &Equation) -> String {
    let each = e.terms.iter().filter_map(|t| {
        let unit = d.coefficient_unit(e.target, &t.term)?;
        let name = match write_term(&Language(d), &t.term) {
            _ if t.term.is_one() => "constant".into(),
            (sum, binds) if binds < Precedence::Product => format!("({sum})"),
            (product, _) => product,
        };
        Some(format!("{name} {unit}"))
    });
    let mut out = String::new();
    let mut width = 0;
    for entry in each {
        let length = entry.chars().count() + 2;
        if out.is_empty() {
            out.push_str(HEAD);
            width = HEAD.len();
        } else if width + length > LINE_WIDTH {
            out.push_str(&format!(",\n{}", " ".repeat(HEAD.len())));
            width = HEAD.len();
        } else {
            out.push_str(", ");
        }
        out.push_str(&entry);
        width += length;
    }
    if !out.is_empty() {
        out.push('\n');
    }
    out
}
