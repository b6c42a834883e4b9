//! The 1-norms that answers are sought in: plain, and graded by how much factors vary.
//!
//! In: a library on samples, κ. Out: grades for the solver. A term's grade is κ to the sum, over its atoms, of exponent times spread; the
//! spread of an atom is its standard deviation over its root mean square on the rows: 1 about zero, 0 if it stays the same.

use std::cell::RefCell;
use std::collections::BTreeMap;

use sidc_data::Samples;
use sidc_discover::dictionary::{evaluate, grades};
use sidc_lang::library::Library;
use sidc_lang::term::{Atom, Term};
use sidc_solve::dictionary::Grades;

/// κ of the norms that are solved side by side; 1 is plain.
pub const FAMILY: [f64; 4] = [1.0, 1.25, 2.0, 4.0];

pub fn spread_grades(library: &Library, samples: &Samples, base: f64) -> Grades {
    let known: RefCell<BTreeMap<Atom, f64>> = RefCell::default();
    let spread_of = |atom: &Atom| {
        let mut known = known.borrow_mut();
        let spread = || spread(&evaluate(&Term::atom(atom.clone()), samples));
        *known.entry(atom.clone()).or_insert_with(spread)
    };
    let grade = |term: &Term| {
        let parts = term.factors().map(|(atom, power)| power * spread_of(atom));
        base.powf(parts.sum::<f64>())
    };
    grades(library, &grade)
}

/// Standard deviation over root mean square; 0 of zeros.
fn spread(values: &[f64]) -> f64 {
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square = values.iter().map(|x| x * x).sum::<f64>() / count;
    match square > 0.0 {
        true => (1.0 - mean * mean / square).max(0.0).sqrt(),
        false => 0.0,
    }
}
