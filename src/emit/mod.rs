//! A discovery as text and code. A target is one file that implements [`Target`] and one line in [`TARGETS`].
//!
//! Emitters see only the [`Discovery`]; where parentheses go is decided once, by the printer in `term`.

mod c;
mod derived;
mod evidence;
mod identifiability;
mod infix;
mod latex;
mod latex_matrix;
mod linearization;
mod lists;
mod mathml;
mod matlab;
mod matrix;
mod names;
mod number;
mod path;
mod program;
mod python;
mod rust;
mod symbols;
mod sympy;
mod text;
mod trust;
mod units;
mod validation;
mod verification;

use crate::discover::Discovery;

pub use evidence::{answer, remarks};
pub use linearization::{bends, linearization};
pub use mathml::{MathMl, escape};
pub use number::{apart, significant};
pub use text::equations;
pub use trust::without;
pub use validation::validation;

/// A language that a discovery can be written in.
pub trait Target: Sync {
    /// What `--to` takes.
    fn name(&self) -> &'static str;
    /// One line for help texts.
    fn about(&self) -> &'static str;
    /// The whole file.
    ///
    /// # Errors
    /// A sentence that says what this target cannot express, and which equation asks for it.
    fn emit(&self, d: &Discovery) -> Result<String, String>;
}

/// Every target; the command line and "did you mean" read this.
pub static TARGETS: &[&dyn Target] = &[
    &text::Text,
    &latex::Latex,
    &rust::Rust,
    &c::C,
    &python::Python,
    &sympy::Sympy,
    &matlab::Matlab,
];

/// What follows from the equations, as plain text after a blank line: coupled ones as a matrix equation and solved, linear
/// systems as A and B. Empty for a single or uncoupled nonlinear system.
pub fn consequences(d: &Discovery) -> String {
    matrix::text(d, &derived::Derived::of(d))
}

/// The texts whose condition holds: the helpers that emitted code calls.
fn chosen(all: &[(bool, &str)]) -> String {
    let used = all.iter().filter(|(used, _)| *used);
    used.map(|(_, text)| *text).collect()
}

/// Looks a target up by name.
pub fn target(name: &str) -> Option<&'static dyn Target> {
    TARGETS.iter().copied().find(|t| t.name() == name)
}
