//! Unknown constants inside terms, from rows of samples: where they are likeliest, the terms chosen anew at each value that is tried.
//!
//! In: a model, libraries, samples. Out: a value for each constant, with its standard error once the terms are known. Judges no equation.
//!
//! Coefficients are linear and constants are not, so the coefficients are eliminated (variable projection, Golub and Pereyra 1973): `profile`
//! gives the criterion of the best terms as a function of the constants alone, `search_points` says where it is looked at, and
//! `variable_projection` goes downhill from the best of these with the terms kept.

mod fewer_terms;
mod profile;
mod search;
mod search_points;
pub(crate) mod thresholds;
mod variable_projection;

pub(crate) use search::alike;
pub use search::{ConstantErrors, constant_errors, refine, settle};

use sidc_data::Samples;
use sidc_lang::model::UnknownConstant;
use sidc_lang::term::Signal;

/// The samples with these values of the constants.
pub fn with_values(samples: &Samples, unknowns: &[UnknownConstant], values: &[f64]) -> Samples {
    let mut samples = samples.clone();
    set_values(&mut samples, unknowns, values);
    samples
}

fn set_values(samples: &mut Samples, unknowns: &[UnknownConstant], values: &[f64]) {
    for (unknown, value) in unknowns.iter().zip(values) {
        let signal = Signal::new(unknown.var);
        let own = samples.columns.iter_mut().find(|c| c.signal == signal);
        own.into_iter().for_each(|c| c.values.fill(*value));
    }
}
