//! Equations as plain text. No term is left out.

use crate::text::layout::{signed_term, signed_term_with_error, sum_lines};
use sidc_lang::term::SignalNames;
use sidc_system::discovery::{Discovery, FoundTerm};

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
            sum_lines(&format!("{name}{pad} = "), &terms)
        })
        .collect()
}
