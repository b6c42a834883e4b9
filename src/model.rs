//! What is known of a system, from a model's text.

use sidc_lang::diagnostic::{Diagnostic, Severity};
use sidc_lang::library::GENERATORS;
use sidc_lang::render;
use sidc_lang::source::Sources;
use sidc_lang::term::{FUNCTIONS, Language, SignalNames};

use crate::error::{Error, ErrorKind};
use crate::pipeline::{self, Program};

/// A checked model: variables, equations asked for, libraries of candidate terms.
///
/// ```
/// use sidc::Model;
///
/// let model = Model::parse("state y : order 2\ninput u\nddy ~ poly(y, dy, u; 2)\n")?;
/// assert_eq!(model.targets(), ["ddy"]);
/// assert_eq!(model.candidates("ddy"), Some(10));
/// # Ok::<(), sidc::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Model {
    pub(crate) text: String,
    pub(crate) name: String,
    pub(crate) sources: Sources,
    pub(crate) program: Program,
    warnings: Vec<Diagnostic>,
}

impl Model {
    /// Parses and checks a model, docs/language.md. Libraries are laid out, not evaluated: time and memory grow with the
    /// lists that they are products of.
    ///
    /// # Errors
    /// [`ErrorKind::Model`], every fault of the text at once.
    pub fn parse(text: &str) -> Result<Model, Error> {
        Model::named("model.sid", text)
    }

    /// The same; `name` stands for the text in messages and in the result document.
    ///
    /// # Errors
    /// As [`Model::parse`].
    pub fn named(name: &str, text: &str) -> Result<Model, Error> {
        let mut sources = Sources::default();
        let file = sources.add(name, text);
        let (program, found) = pipeline::compile(file, &sources, pipeline::MEMORY);
        let Some(program) = program else {
            return Err(Error::of(ErrorKind::Model, &found, &sources));
        };
        Ok(Model {
            text: text.into(),
            name: name.into(),
            sources,
            program,
            warnings: found,
        })
    }

    /// The derivatives, next values and outputs that have an equation, in the model's order.
    pub fn targets(&self) -> Vec<String> {
        let model = &self.program.model;
        let targets = model.equations.iter().map(|e| model.name(e.target));
        targets.collect()
    }

    /// How many terms are candidates for an equation; `None` if nothing is looked for there.
    pub fn candidates(&self, target: &str) -> Option<usize> {
        self.program.library(target).map(|library| library.len())
    }

    /// The terms that are candidates for an equation, in the order of its library; `None` if nothing is looked for there. A library
    /// may have millions of them: see [`Model::candidates`].
    ///
    /// ```
    /// let model = sidc::Model::parse("state x\ndx ~ poly(x; 2)\n")?;
    /// let terms: Vec<String> = model.candidate_terms("dx").into_iter().flatten().collect();
    /// assert_eq!(terms, ["1", "x", "x^2"]);
    /// # Ok::<(), sidc::Error>(())
    /// ```
    pub fn candidate_terms(&self, target: &str) -> Option<impl Iterator<Item = String>> {
        let terms = self.program.library(target)?.terms();
        Some(terms.map(|(_, term)| Language(&self.program.model).term(&term)))
    }

    /// The words that libraries are written with, beside names of signals: functions and generators.
    pub fn vocabulary() -> Vec<&'static str> {
        let functions = FUNCTIONS.iter().map(|f| f.name);
        functions
            .chain(GENERATORS.iter().map(|g| g.name()))
            .collect()
    }

    /// The warnings about the model, as the command line prints them; empty if there are none.
    pub fn warnings(&self) -> String {
        let mut found = self.warnings.clone();
        found.retain(|d| d.severity == Severity::Warning);
        render(&found, &self.sources, false)
    }

    pub(crate) fn findings(&self) -> &[Diagnostic] {
        &self.warnings
    }
}
