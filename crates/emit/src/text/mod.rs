//! Equations as plain text: one line where it fits, else a line for each term. No term is left out.

pub(crate) mod coefficient_inference;
mod coefficient_units;
pub(crate) mod evidence;
pub(crate) mod free_runs;
mod identifiability;
pub(crate) mod linearization;
pub(crate) mod matrices;
mod solution_path;
mod verification;

use crate::Target;
use sidc_lang::number::significant;
use sidc_lang::term::{Language, Precedence, SignalNames, Term, write_term};
use sidc_system::discovery::{Discovery, Equation};

pub(crate) struct Text;

/// Widest line, in characters.
pub(crate) const LINE_WIDTH: usize = 100;

impl Target for Text {
    fn name(&self) -> &'static str {
        "text"
    }

    fn about(&self) -> &'static str {
        "equations and their matrices as the terminal shows them, six significant digits"
    }

    fn emit(&self, d: &Discovery) -> Result<String, String> {
        Ok(equations(d).concat() + &super::consequences(d))
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

pub(crate) fn layout(left: &str, terms: &[(bool, String)]) -> String {
    let line = format!("{left}{}\n", in_one_line(terms));
    if terms.is_empty() || line.chars().count() <= LINE_WIDTH {
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

/// `a + b - c`; 0 if there is none.
pub(crate) fn in_one_line(terms: &[(bool, String)]) -> String {
    let parts = terms.iter().enumerate().map(|(i, t)| first_or_next(i, t));
    match terms.is_empty() {
        true => "0".into(),
        false => parts.collect::<Vec<String>>().join(" "),
    }
}

fn first_or_next(i: usize, (negative, text): &(bool, String)) -> String {
    match (i, negative) {
        (0, false) => text.clone(),
        (0, true) => format!("-{text}"),
        (_, false) => format!("+ {text}"),
        (_, true) => format!("- {text}"),
    }
}

/// The terms of an equation, in its order.
fn signed_terms(d: &Discovery, e: &Equation) -> Vec<(bool, String)> {
    let terms = e.terms.iter();
    terms.map(|t| signed(d, t.coefficient, &t.term)).collect()
}

/// Sign, and `1.29032*F`. A coefficient that rounds to 1 is omitted; a constant is its number.
pub(crate) fn signed(d: &Discovery, coefficient: f64, term: &Term) -> (bool, String) {
    let size = significant(coefficient.abs(), 6);
    let (text, binds) = write_term(&Language(d), term);
    let text = match (term.is_one(), size.as_str()) {
        (true, _) => size,
        (_, "1") if binds >= Precedence::Product => text,
        _ if binds < Precedence::Product => format!("{size}*({text})"),
        _ => format!("{size}*{text}"),
    };
    (coefficient < 0.0, text)
}
