//! Grades of a library's columns, laid out as [`super::compile`] lays out Φ.
//!
//! In: a library, a grade for each term. Out: grades of the factors. Reads data only to see how much a factor varies.

use std::collections::{BTreeMap, BTreeSet};

use sidc_data::Samples;
use sidc_lang::library::Library;
use sidc_lang::term::{Atom, Term};
use sidc_solve::dictionary::Grades;

use super::compile::{evaluate, factors, listed};

/// Grades of all columns: `grade` of a term, or for products of two factors the product of their grades.
pub fn grades(library: &Library, grade: &dyn Fn(&Term) -> f64) -> Grades {
    match listed(library) {
        Some(terms) => Grades::of_columns(terms.iter().map(grade).collect()),
        None => {
            let (blocks, factors) = factors(library);
            let of = |terms: Vec<&Term>| terms.into_iter().map(grade).collect();
            Grades::of_products(blocks, factors.map(of))
        }
    }
}

/// How much each factor of a library varies over the rows: √(1 − mean²/mean of squares), which is std/rms. 0 is a constant, 1 has no
/// mean. A factor near a constant, such as the cosine of a small angle, changes a term little, so it should hardly count.
pub fn variations(library: &Library, samples: &Samples) -> BTreeMap<Atom, f64> {
    let factors = library.factors().flat_map(Term::factors);
    let atoms: BTreeSet<&Atom> = factors.map(|(atom, _)| atom).collect();
    let variation = |atom: &Atom| {
        let values = evaluate(&Term::atom(atom.clone()), samples);
        let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let (mut sum, mut squares) = (0.0, 0.0);
        for v in &values {
            let v = v / largest;
            sum += v;
            squares += v * v;
        }
        let share = 1.0 - sum * sum / (squares * values.len() as f64);
        // Where a factor is zero or not finite, it counts in full.
        match share.is_nan() {
            true => 1.0,
            false => share.max(0.0).sqrt(),
        }
    };
    atoms
        .into_iter()
        .map(|a| (a.clone(), variation(a)))
        .collect()
}
