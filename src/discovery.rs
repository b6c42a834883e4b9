//! The result of an identification.

use std::fmt;

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use sidc_emit as emit;
use sidc_emit::Written;
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::source::Sources;
use sidc_system::discovery::{Notice, Reason};
use sidc_system::result::{self, Document, EquationEntry, FailedEntry, Opened};
use sidc_system::validate::Validation;
use sidc_system::verdict::Verdict;

use crate::error::{Error, ErrorKind};
use crate::target::Target;

/// The equations of a system with their evidence.
///
/// Serde and [`Discovery::to_json`] write it as the result document (docs/command-line.md, the result document) that `sidc identify -o` writes and `sidc
/// simulate`, `export` and `report` read. `Display` prints the equations, one a line.
#[derive(Clone, Debug)]
pub struct Discovery {
    pub(crate) opened: Opened,
}

impl Discovery {
    fn new(opened: Result<Opened, Diagnostic>) -> Result<Discovery, Error> {
        match opened {
            Ok(opened) => Ok(Discovery { opened }),
            Err(fault) => Err(Error::of(
                ErrorKind::Document,
                &[fault],
                &Sources::default(),
            )),
        }
    }

    pub(crate) fn from_document(document: Document) -> Result<Discovery, Error> {
        Discovery::new(result::open_document("result", document))
    }

    /// Reads a result document.
    ///
    /// # Errors
    /// [`ErrorKind::Document`]: not a result of this program, a newer version, or terms that do not parse.
    pub fn from_json(text: &str) -> Result<Discovery, Error> {
        Discovery::new(result::open("result", text))
    }

    /// The result document as text.
    ///
    /// # Errors
    /// [`ErrorKind::Internal`]: a bug in this program.
    pub fn to_json(&self) -> Result<String, Error> {
        result::text(&self.opened.document)
            .map_err(|e| Error::new(ErrorKind::Internal, "internal", e))
    }

    /// The equations found and those that the model states, in the model's order. Each is target = Σ coefficient · term.
    pub fn equations(&self) -> &[EquationEntry] {
        &self.opened.document.equations
    }

    /// The equations that were asked for but not found, with the reasons.
    pub fn failed(&self) -> &[FailedEntry] {
        &self.opened.document.failed
    }

    /// True if every equation was found and none has a doubt.
    pub fn passes(&self) -> bool {
        self.opened.discovery.passes()
    }

    /// Every doubt with the target of its equation.
    pub fn doubts(&self) -> impl Iterator<Item = (&str, &Reason)> {
        let equations = self.equations().iter();
        equations.flat_map(|e| e.reasons.iter().map(|r| (e.target.as_str(), r)))
    }

    /// Warnings about model and data that bear on the result.
    pub fn warnings(&self) -> &[Notice] {
        &self.opened.document.warnings
    }

    /// Free runs of the equations on the data used and on the data held out; `None` if nothing was held out.
    pub fn validation(&self) -> Option<&Validation> {
        self.opened.document.validation.as_ref()
    }

    /// Whether the equations are the law, how far ahead they predict, and whether they run freely. `None` in documents of earlier versions.
    pub fn verdict(&self) -> Option<&Verdict> {
        self.opened.document.verdict.as_ref()
    }

    /// Whether prediction errors on the held-out data stay within the limits set by [`Options::good`](crate::Options::good); `None` if no limit was set.
    pub fn is_good(&self) -> Option<bool> {
        self.verdict()?.prediction.good
    }

    /// The answer as the program prints it: equations rounded to their precision, the verdict, the main reasons and what to do about them. Documents of
    /// earlier versions give only the equations.
    pub fn answer(&self) -> String {
        match self.verdict() {
            Some(verdict) => emit::answer(&self.opened.discovery, verdict),
            None => self.to_string(),
        }
    }

    /// The equations in another language, with their Jacobians if it is a programming language.
    ///
    /// # Errors
    /// [`ErrorKind::Export`]: an equation that the target cannot express, or a target with binary files, for which use
    /// [`export_bytes`](Discovery::export_bytes).
    pub fn export(&self, target: Target) -> Result<String, Error> {
        self.written(target)?.into_text().ok_or_else(|| {
            let name = target.name();
            let why = format!("a file of {name} is binary; `export_bytes` gives its bytes");
            Error::new(ErrorKind::Export, "binary-export", why)
        })
    }

    /// Like [`Discovery::export`], as the bytes of a file; also for targets with binary files. Text is in UTF-8.
    ///
    /// # Errors
    /// [`ErrorKind::Export`]: an equation that the target cannot express.
    pub fn export_bytes(&self, target: Target) -> Result<Vec<u8>, Error> {
        self.written(target).map(Written::into_bytes)
    }

    fn written(&self, target: Target) -> Result<Written, Error> {
        let emitted = target.emitter().emit(&self.opened.discovery);
        emitted.map_err(|why| Error::new(ErrorKind::Export, "not-exported", why))
    }
}

impl fmt::Display for Discovery {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(emit::equations(&self.opened.discovery).concat().trim_end())
    }
}

impl Serialize for Discovery {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.opened.document.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Discovery {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let document = Document::deserialize(deserializer)?;
        Discovery::from_document(document).map_err(serde::de::Error::custom)
    }
}
