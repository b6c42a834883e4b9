//! Equations as plain text. No term is left out.

use crate::text::layout::{signed_term, sum_lines};
use sidc_lang::term::SignalNames;
use sidc_system::discovery::Discovery;

/// Each equation as its line or lines, targets aligned; every text ends in a newline.
pub fn equations(d: &Discovery) -> Vec<String> {
    let names: Vec<String> = d.equations.iter().map(|e| d.name(e.target)).collect();
    let width = names.iter().map(|n| n.chars().count()).max().unwrap_or(0);
    names
        .iter()
        .zip(&d.equations)
        .map(|(name, e)| {
            let pad = " ".repeat(width - name.chars().count());
            let terms = e.terms.iter();
            let terms: Vec<_> = terms
                .map(|t| signed_term(d, t.coefficient, &t.term))
                .collect();
            sum_lines(&format!("{name}{pad} = "), &terms)
        })
        .collect()
}
