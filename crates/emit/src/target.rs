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
    fn emit(&self, d: &Discovery) -> Result<Written, String>;
}

/// The content of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Written {
    Text(String),
    /// Bytes that are not for a terminal.
    Binary {
        bytes: Vec<u8>,
        /// The extension of the file name, without the dot.
        suffix: &'static str,
    },
}

impl Written {
    pub fn into_bytes(self) -> Vec<u8> {
        match self {
            Written::Text(text) => text.into_bytes(),
            Written::Binary { bytes, .. } => bytes,
        }
    }

    /// `None` for a binary file.
    pub fn into_text(self) -> Option<String> {
        match self {
            Written::Text(text) => Some(text),
            Written::Binary { .. } => None,
        }
    }
}

impl From<String> for Written {
    fn from(text: String) -> Written {
        Written::Text(text)
    }
}
