//! The 1-norms that answers are sought in: plain, and graded by how much factors vary.
//!
//! In: a library on samples, κ. Out: grades for the solver, as `sidc identify` has them.

use std::sync::Arc;

use sidc_data::Samples;
use sidc_discover::dictionary::{grades, variations};
use sidc_lang::library::{Grading, Library};
use sidc_solve::dictionary::Grades;

/// κ of the norms that are solved side by side; 1 is plain.
pub const FAMILY: [f64; 3] = [1.0, 1.5, 4.0];

/// κ^d, where d adds up exponent times variation over a term's factors.
pub fn by_variation(library: &Library, samples: &Samples, base: f64) -> Grades {
    let counts = Some(Arc::new(variations(library, samples)));
    let grading = Grading {
        base,
        counts,
        dear: None,
    };
    grades(library, &|term| grading.of(term))
}
