//! Unknown constants inside terms, from rows of samples: where they are likeliest, the terms chosen anew at each value that is tried.
//!
//! In: a model, libraries, samples. Out: a value for each constant, with its standard error once the terms are known. Judges no equation.
//!
//! Coefficients are linear and constants are not, so the coefficients are eliminated (variable projection, Golub and Pereyra 1973): `profile`
//! gives the criterion of the best terms as a function of the constants alone, `search_points` says where it is looked at, and
//! `variable_projection` goes downhill from the best of these with the terms kept.

mod all_terms;
mod effects;
mod family;
mod fewer_terms;
mod greedy_points;
mod maxima;
mod profile;
mod proposals;
mod pursuit;
mod range_proof;
mod rivals;
mod search;
mod search_points;
mod searched_constant;
pub(crate) mod thresholds;
mod variable_projection;

pub(crate) use effects::{ConstantEffect, constant_effects};
pub use range_proof::range_certificates;
pub(crate) use rivals::rivals;
pub use search::{ConstantErrors, MinimaSought, constant_errors, minima, points, refine};
pub(crate) use search_points::alike;
pub use searched_constant::{SearchedConstant, named_values, sought, values_of, with_values};
