//! A continuum of columns: the terms of a library over the values of their constants.
//!
//! In: a library, rows. Out: plain data. Computes nothing.

use super::searched_constant::SearchedConstant;
use sidc_data::Samples;
use sidc_lang::library::{Grading, Library};

/// What the continuum is made of.
#[derive(Clone, Copy)]
pub(super) struct Family<'a> {
    pub library: &'a Library,
    /// The constants that vary.
    pub sought: &'a [SearchedConstant],
    /// Every signal on the rows; constants that do not vary have their present values.
    pub samples: &'a Samples,
    /// Factors of the rows.
    pub row: &'a [f64],
    /// Weights of terms beyond the length of their columns.
    pub grading: &'a Grading,
}
