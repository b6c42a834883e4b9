//! The only error type of the library. It reports every fault at once, each with its place, its cause and a remedy.

use std::fmt;

use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::render;
use sidc_lang::source::Sources;

/// Where the fault lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The model's text.
    Model,
    /// The arrays, or what the model reads from them; a term without a value on them; constraints that they contradict.
    Data,
    /// An option that names something unknown.
    Options,
    /// The result document.
    Document,
    /// A result that a target cannot express.
    Export,
    /// A bug in this program.
    Internal,
}

/// Why there is no result.
///
/// ```
/// use sidc::{ErrorKind, Model};
///
/// let error = Model::parse("state theta : order 2\nddtheta ~ poly(dthta; 2)\n").unwrap_err();
/// assert_eq!((error.kind(), error.codes()), (ErrorKind::Model, vec!["unknown-signal"]));
/// assert!(error.to_string().contains("did you mean `dtheta`?"));
/// ```
#[derive(Clone, Debug)]
pub struct Error {
    kind: ErrorKind,
    codes: Vec<&'static str>,
    text: String,
}

impl Error {
    /// One fault without a place.
    pub(crate) fn new(kind: ErrorKind, code: &'static str, text: impl fmt::Display) -> Error {
        Error {
            kind,
            codes: vec![code],
            text: format!("error[{code}]: {text}"),
        }
    }

    /// The errors among findings, as the command line prints them.
    pub(crate) fn of(kind: ErrorKind, found: &[Diagnostic], sources: &Sources) -> Error {
        let errors: Vec<Diagnostic> = found.iter().filter(|d| d.is_error()).cloned().collect();
        Error {
            kind,
            codes: errors.iter().map(|d| d.code).collect(),
            text: render(&errors, sources, false).trim_end().to_string(),
        }
    }

    /// What is at fault.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }

    /// The stable codes of all faults, in the order of the text; docs/diagnostics.md lists them.
    pub fn codes(&self) -> Vec<&'static str> {
        self.codes.clone()
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl std::error::Error for Error {}
