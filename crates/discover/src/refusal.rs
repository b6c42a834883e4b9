//! Why there is no discovery at all, as opposed to an equation that was not found.
//!
//! In: what stages report. Out: the type that carries it to the caller. Never formats a message.

use crate::dictionary::BadValue;
use sidc_lang::diagnostic::Diagnostic;

/// A term that the data cannot evaluate: which equation contains it, and where it fails.
pub type Unevaluable = (usize, Box<BadValue>);

/// Why there is no discovery at all.
#[derive(Clone, Debug)]
pub enum Refusal {
    Unevaluable(Unevaluable),
    /// The data contradict the constraints.
    Contradiction(Diagnostic),
}
