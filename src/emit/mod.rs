//! A discovery as text and code. A target is one file that implements [`Target`] and one line in [`TARGETS`].
//!
//! Emitters see only the [`Discovery`]; where parentheses go is decided once, by the printer in `term`.

mod evidence;
mod identifiability;
mod latex;
mod names;
mod number;
mod path;
mod rust;
mod text;

use crate::discover::Discovery;

pub use evidence::answer;
pub use number::significant;
pub use text::equations;

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
pub static TARGETS: &[&dyn Target] = &[&text::Text, &latex::Latex, &rust::Rust];

/// Looks a target up by name.
pub fn target(name: &str) -> Option<&'static dyn Target> {
    TARGETS.iter().copied().find(|t| t.name() == name)
}
