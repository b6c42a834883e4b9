//! What was found, as a program uses it.

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
/// By serde, and by [`Discovery::to_json`], it is the result document (docs/command-line.md, the result document), the same that `sidc identify -o` writes and
/// that `sidc simulate`, `export` and `report` read. It displays as the equations, one a line.
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
    /// [`ErrorKind::Document`]: no result of this program, a newer version, terms that do not parse.
    pub fn from_json(text: &str) -> Result<Discovery, Error> {
        Discovery::new(result::open("result", text))
    }

    /// The result document as text.
    ///
    /// # Errors
    /// [`ErrorKind::Internal`], which would be a fault of this program.
    pub fn to_json(&self) -> Result<String, Error> {
        result::text(&self.opened.document)
            .map_err(|e| Error::new(ErrorKind::Internal, "internal", e))
    }

    /// The equations found and those that the model states, in the model's order: target = Σ coefficient · term.
    pub fn equations(&self) -> &[EquationEntry] {
        &self.opened.document.equations
    }

    /// The equations that were asked for and not found, each with its reasons.
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

    /// How the equations run on the data used and on those held out; `None` if nothing was held out.
    pub fn validation(&self) -> Option<&Validation> {
        self.opened.document.validation.as_ref()
    }

    /// Whether it is the law, how far ahead it predicts, whether it runs freely; `None` in documents of earlier programs.
    pub fn verdict(&self) -> Option<&Verdict> {
        self.opened.document.verdict.as_ref()
    }

    /// Whether predictions on data held out have the errors asked for by [`Options::good`](crate::Options::good); `None` if nothing
    /// was asked.
    pub fn is_good(&self) -> Option<bool> {
        self.verdict()?.prediction.good
    }

    /// The answer as the program prints it: equations to their precision, the three answers, the foremost reasons with what to do.
    /// Documents of earlier programs have the equations alone.
    pub fn answer(&self) -> String {
        match self.verdict() {
            Some(verdict) => emit::answer(&self.opened.discovery, verdict),
            None => self.to_string(),
        }
    }

    /// The equations in another language, with their Jacobians where the language is one of code.
    ///
    /// # Errors
    /// [`ErrorKind::Export`]: which equation the target cannot express, and why.
    /// A target whose files are binary: [`export_bytes`](Discovery::export_bytes) gives them.
    pub fn export(&self, target: Target) -> Result<String, Error> {
        self.written(target)?.into_text().ok_or_else(|| {
            let name = target.name();
            let why = format!("a file of {name} is binary; `export_bytes` gives its bytes");
            Error::new(ErrorKind::Export, "binary-export", why)
        })
    }

    /// The same as the bytes of a file: texts in UTF-8, and the targets whose files are binary.
    ///
    /// # Errors
    /// [`ErrorKind::Export`]: which equation the target cannot express, and why.
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
