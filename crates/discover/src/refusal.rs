//! Why there is no discovery at all, as opposed to an equation that was not found.
//!
//! In: what stages report. Out: the type that carries it to the caller. Never formats a message.

use crate::dictionary::BadValue;
use sidc_lang::diagnostic::Diagnostic;

/// A term without a finite value on the data: the place of its equation in the model, and where it fails.
pub type Unevaluable = (usize, Box<BadValue>);

/// Why discovery was refused.
#[derive(Clone, Debug)]
pub enum Refusal {
    Unevaluable(Unevaluable),
    /// The data contradict the constraints.
    Contradiction(Diagnostic),
}
