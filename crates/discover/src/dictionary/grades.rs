//! Grades of a library's columns, laid out as [`super::compile`] lays out Φ.
//!
//! In: a library, a grade for each term. Out: grades of the factors. Evaluates no term.

use sidc_lang::library::Library;
use sidc_lang::term::Term;
use sidc_solve::dictionary::Grades;

use super::compile::{factors, listed};

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
