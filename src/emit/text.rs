//! Equations for people: one line where it fits, one term a line where not; never a fitted term left out.

use super::Target;
use super::number::significant;
use crate::discover::{Discovery, Equation};
use crate::term::{Language, Precedence, SignalNames, write_term};

pub(super) struct Text;

/// Widest line before terms go on lines of their own.
const WIDTH: usize = 100;

impl Target for Text {
    fn name(&self) -> &'static str {
        "text"
    }

    fn about(&self) -> &'static str {
        "equations as the terminal shows them, six significant digits"
    }

    fn emit(&self, d: &Discovery) -> Result<String, String> {
        Ok(equations(d).concat())
    }
}

/// Each equation as its line or lines, targets aligned; every text ends in a newline.
pub fn equations(d: &Discovery) -> Vec<String> {
    let names: Vec<String> = d.equations.iter().map(|e| d.name(e.target)).collect();
    let width = names.iter().map(|n| n.chars().count()).max().unwrap_or(0);
    names
        .iter()
        .zip(&d.equations)
        .map(|(name, e)| {
            let pad = " ".repeat(width - name.chars().count());
            layout(&format!("{name}{pad} = "), &signed_terms(d, e))
        })
        .collect()
}

fn layout(left: &str, terms: &[(bool, String)]) -> String {
    if terms.is_empty() {
        return format!("{left}0\n");
    }
    let line: Vec<String> = terms
        .iter()
        .enumerate()
        .map(|(i, t)| first_or_next(i, t))
        .collect();
    let line = format!("{left}{}\n", line.join(" "));
    if line.chars().count() <= WIDTH {
        return line;
    }
    let indent = " ".repeat(left.chars().count());
    terms
        .iter()
        .enumerate()
        .map(|(i, (negative, text))| {
            let start = if i == 0 { left } else { &indent };
            let sign = if *negative { '-' } else { '+' };
            format!("{start}{sign} {text}\n")
        })
        .collect()
}

fn first_or_next(i: usize, (negative, text): &(bool, String)) -> String {
    match (i, negative) {
        (0, false) => text.clone(),
        (0, true) => format!("-{text}"),
        (_, false) => format!("+ {text}"),
        (_, true) => format!("- {text}"),
    }
}

/// Sign, and `1.29032*F`, as the language has it; a coefficient that rounds to 1 is left out, the constant is its number.
fn signed_terms(d: &Discovery, e: &Equation) -> Vec<(bool, String)> {
    e.terms
        .iter()
        .map(|t| {
            let size = significant(t.coefficient.abs(), 6);
            let (term, binds) = write_term(&Language(d), &t.term);
            let text = match (t.term.is_one(), size.as_str()) {
                (true, _) => size,
                (_, "1") if binds >= Precedence::Product => term,
                _ if binds < Precedence::Product => format!("{size}*({term})"),
                _ => format!("{size}*{term}"),
            };
            (t.coefficient < 0.0, text)
        })
        .collect()
}
