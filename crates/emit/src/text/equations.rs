//! Equations as plain text. No term is left out.

use crate::text::layout::{TEXT_WIDTH, signed_term, signed_term_with_error, sum_lines, wrapped};
use sidc_lang::term::{Language, SignalNames};
use sidc_system::discovery::{Discovery, Equation, FoundTerm, RunCoefficient};

/// Each equation as its line or lines, targets aligned; every text ends in a newline.
pub fn equations(d: &Discovery) -> Vec<String> {
    written(d, &|t| signed_term(d, t.coefficient, &t.term))
}

/// The same, each coefficient with its standard error in the last digits.
pub(crate) fn equations_with_errors(d: &Discovery) -> Vec<String> {
    written(d, &|t| signed_term_with_error(d, t))
}

fn written(d: &Discovery, term: &dyn Fn(&FoundTerm) -> (bool, String)) -> Vec<String> {
    let names: Vec<String> = d.equations.iter().map(|e| d.name(e.target)).collect();
    let width = names.iter().map(|n| n.chars().count()).max().unwrap_or(0);
    names
        .iter()
        .zip(&d.equations)
        .map(|(name, e)| {
            let pad = " ".repeat(width - name.chars().count());
            let terms: Vec<_> = e.terms.iter().map(term).collect();
            sum_lines(&format!("{name}{pad} = "), &terms) + &by_run(d, e)
        })
        .collect()
}

/// A line for each coefficient that has a value in each run.
fn by_run(d: &Discovery, e: &Equation) -> String {
    let mut out = String::new();
    for t in e.terms.iter().filter(|t| !t.runs.is_empty()) {
        let value = |r: &RunCoefficient| format!("{} in {}", r.figure(), r.run);
        let values: Vec<String> = t.runs.iter().map(value).collect();
        let term = Language(d).term(&t.term);
        let line = format!("coefficient of {term} by run: {}", values.join(", "));
        let lines = wrapped(&line, TEXT_WIDTH, "    ", "        ");
        lines.iter().for_each(|l| out.push_str(&format!("{l}\n")));
    }
    out
}
