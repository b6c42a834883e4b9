//! Reduces the rows of one part of a large table, and refits equations on all rows.
//!
//! In: a program, and the signals of one part or of the rows that equations were found from. Out: factors; the changed equations.

use sidc_discover::{self as discover, Factor};
use sidc_lang::diagnostic::Diagnostic;
use sidc_progress::Observer;
use sidc_system::discovery::Discovery;

use super::identify::diagnostics;
use super::measure::Measured;
use super::program::Program;
use crate::options::Options;

/// Reduces the rows of every equation to its factor; see [`Factor`].
///
/// # Errors
/// Terms without a finite value.
pub fn reduce(program: &Program, part: &Measured) -> Result<Vec<Option<Factor>>, Vec<Diagnostic>> {
    let reduced = discover::reduce(&program.model, &program.libraries, &part.samples);
    reduced.map_err(|refused| diagnostics(program, part, refused))
}

/// Gives equations found on some of the rows the coefficients of all rows.
pub fn refit_all_rows(
    program: &Program,
    measured: &Measured,
    factors: &[Option<Factor>],
    options: &Options,
    discovery: &mut Discovery,
    observer: &mut dyn Observer,
) {
    let data = (measured.acting(), &measured.samples);
    discover::refit_all_rows(
        (&program.model, &program.libraries),
        data,
        factors,
        &options.search,
        discovery,
        observer,
    );
}
