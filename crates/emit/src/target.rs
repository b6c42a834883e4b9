//! What an export target is.

use sidc_system::discovery::Discovery;

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
