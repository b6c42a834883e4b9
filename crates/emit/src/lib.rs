//! A discovery as text and code. A target is a type that implements [`Target`], listed in [`TARGETS`].
//!
//! Emitters see only the [`Discovery`]. Where parentheses go is decided once, by the printer of terms in `sidc_lang`.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod code;
mod consequences;
pub mod report;
mod text;
mod typeset;

use sidc_system::discovery::Discovery;

pub use text::coefficient_inference::without;
pub use text::equations;
pub use text::evidence::{answer, remarks};
pub use text::free_runs::validation;
pub use text::linearization::{kink_warnings, linearization};
pub use typeset::mathml::{MathMl, escape};

/// A language that a discovery can be written in.
pub trait Target: Sync {
    /// The value of `--to`.
    fn name(&self) -> &'static str;
    /// One line for help texts.
    fn about(&self) -> &'static str;
    /// The whole file.
    ///
    /// # Errors
    /// A sentence that says what this target cannot express, and in which equation.
    fn emit(&self, d: &Discovery) -> Result<String, String>;
}

/// Every target, for the command line and its suggestions.
pub static TARGETS: &[&dyn Target] = &[
    &text::Text,
    &typeset::latex::Latex,
    &code::rust::Rust,
    &code::c::C,
    &code::python::Python,
    &code::sympy::Sympy,
    &code::matlab::Matlab,
];

/// What follows from the equations, as plain text: coupled equations as a matrix equation and solved, linear systems
/// as A and B. Empty for a single or uncoupled nonlinear system.
pub fn consequences(d: &Discovery) -> String {
    text::matrices::text(d, &consequences::Consequences::of(d))
}

/// Looks a target up by name.
pub fn target(name: &str) -> Option<&'static dyn Target> {
    TARGETS.iter().copied().find(|t| t.name() == name)
}
