//! What was found, without how: equations with their evidence, and what follows from them.
//!
//! In: a checked model and coefficients. Out: forms, solutions in symbols, free runs, predictions, scores, the verdict, the result document. Nothing here
//! estimates a coefficient.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod algebra;
pub mod discovery;
pub mod least_squares;
pub mod predict;
pub mod ranked_reasons;
pub mod result;
pub mod simulate;
pub mod switching;
pub mod validate;
pub mod verdict;

/// Every number that decides, family by family.
pub fn thresholds() -> Vec<sidc_thresholds::Table> {
    let modules = [
        discovery::thresholds::tables(),
        algebra::thresholds::tables(),
        least_squares::thresholds::tables(),
        simulate::thresholds::tables(),
        switching::thresholds::tables(),
        predict::thresholds::tables(),
        validate::thresholds::tables(),
    ];
    modules.concat()
}
