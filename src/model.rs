//! What is known of a system, from the text of a model.

use sidc_lang::diagnostic::{Diagnostic, Severity};
use sidc_lang::includes;
use sidc_lang::library::GENERATORS;
use sidc_lang::model::{Equation, RightSide};
use sidc_lang::render;
use sidc_lang::source::Sources;
use sidc_lang::term::{FUNCTIONS, Language, SignalNames};

use crate::error::{Error, ErrorKind};
use crate::pipeline::{self, Program};

/// A checked model: variables, equations to find, libraries of candidate terms.
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
    pub(crate) name: String,
    /// Its text and those of the files that it includes.
    pub(crate) sources: Sources,
    pub(crate) program: Program,
    warnings: Vec<Diagnostic>,
}

impl Model {
    /// Parses and checks a model (docs/language.md). Libraries are not evaluated: time and memory grow with the lists in a product, not with the product.
    ///
    /// # Errors
    /// [`ErrorKind::Model`], with every fault of the text.
    pub fn parse(text: &str) -> Result<Model, Error> {
        Model::named("model.sid", text)
    }

    /// Like [`Model::parse`]; messages and the result document call the text `name`.
    ///
    /// # Errors
    /// As [`Model::parse`].
    pub fn named(name: &str, text: &str) -> Result<Model, Error> {
        Model::compiled(name, text, None)
    }

    /// Like [`Model::named`], for a model that includes others. `read` gives the text of a file by its path, relative to the folder of `name`.
    ///
    /// ```
    /// use sidc::Model;
    ///
    /// let read = |path: &str| match path {
    ///     "rig.sid" => Ok("state y : order 2\ninput u\n".to_string()),
    ///     _ => Err("no such file".to_string()),
    /// };
    /// let model = Model::with_files("model.sid", "include \"rig.sid\"\nddy ~ poly(y, dy, u; 2)\n", read)?;
    /// assert_eq!(model.targets(), ["ddy"]);
    /// # Ok::<(), sidc::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Model::parse`]; a file that `read` cannot give.
    pub fn with_files(
        name: &str,
        text: &str,
        mut read: impl FnMut(&str) -> Result<String, String>,
    ) -> Result<Model, Error> {
        Model::compiled(name, text, Some(&mut read))
    }

    fn compiled(name: &str, text: &str, read: Option<includes::Read>) -> Result<Model, Error> {
        let mut sources = Sources::default();
        let file = sources.add(name, text);
        if let Some(read) = read {
            includes::load(file, &mut sources, read);
        }
        let (program, found) = pipeline::compile(file, &sources, pipeline::MEMORY);
        let Some(program) = program else {
            return Err(Error::of(ErrorKind::Model, &found, &sources));
        };
        Ok(Model {
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

    /// The number of candidate terms of an equation; `None` if that equation is not searched for.
    pub fn candidates(&self, target: &str) -> Option<usize> {
        self.program.library(target).map(|library| library.len())
    }

    /// The candidate terms of an equation, in the order of its library; `None` if that equation is not searched for. There may be millions: see
    /// [`Model::candidates`].
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

    /// The model with the libraries of the given targets replaced by these terms, spelled as they are printed. Known parts are kept. If the statement of a
    /// target declares several equations, each gets a statement of its own with all terms listed.
    ///
    /// ```
    /// let model = sidc::Model::parse("state x, y\ndx, dy ~ poly(x, y; 3)\n")?;
    /// let narrow = model.with_terms(&[("dy", vec!["x", "x*y^2"])])?;
    /// assert_eq!((narrow.candidates("dx"), narrow.candidates("dy")), (Some(10), Some(2)));
    /// assert!(narrow.text().ends_with("\ndy ~ <x, x*y^2>\n"));
    /// # Ok::<(), sidc::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`ErrorKind::Model`]: a text that is not a term, or no terms. [`ErrorKind::Options`]: a target that is not searched for.
    pub fn with_terms<T: AsRef<str>>(&self, libraries: &[(&str, Vec<T>)]) -> Result<Model, Error> {
        if self.program.includes_files {
            return Model::named(&self.name, self.text())?.with_terms(libraries);
        }
        let model = &self.program.model;
        if let Some((target, _)) = libraries.iter().find(|(t, _)| self.candidates(t).is_none()) {
            let text = format!(
                "nothing is looked for in {target}\n  = help: the targets are {}",
                self.targets().join(", ")
            );
            return Err(Error::new(ErrorKind::Options, "unknown-target", text));
        }
        let listed = |e: &Equation| libraries.iter().any(|(t, _)| *t == model.name(e.target));
        let mut text = self.text().to_string();
        let statements = model.equations.chunk_by(|a, b| a.span == b.span);
        for statement in statements.rev().filter(|s| s.iter().any(listed)) {
            let lines = statement.iter().map(|e| self.listed(e, libraries));
            let lines: Vec<String> = lines.collect();
            let span = statement.first().map_or(0..0, |e| e.span.start..e.span.end);
            text.replace_range(span, &lines.join("\n"));
        }
        Model::named(&self.name, &text)
    }

    /// The statement of one equation with its terms listed: the given ones, or else all. Each equation of a family gets its own statement.
    fn listed<T: AsRef<str>>(&self, equation: &Equation, libraries: &[(&str, Vec<T>)]) -> String {
        let model = &self.program.model;
        let name = model.name(equation.target);
        let given = libraries.iter().find(|(target, _)| *target == name);
        let terms: Vec<String> = match given {
            Some((_, terms)) => terms.iter().map(|t| t.as_ref().to_string()).collect(),
            None => self.candidate_terms(&name).into_iter().flatten().collect(),
        };
        let known = match &equation.right {
            RightSide::Search { known, .. } => known.as_slice(),
            RightSide::Known(_) => &[],
        };
        let known = known
            .iter()
            .map(|(e, _)| format!("known({})", Language(model).expr(e)));
        let parts: Vec<String> = known.chain([format!("<{}>", terms.join(", "))]).collect();
        format!("{name} ~ {}", parts.join(" + "))
    }

    /// The model as it was written, with the files that it includes in their place.
    pub fn text(&self) -> &str {
        &self.program.text
    }

    /// The names of functions and generators that a library may use.
    pub fn vocabulary() -> Vec<&'static str> {
        let functions = FUNCTIONS.iter().map(|f| f.name);
        functions
            .chain(GENERATORS.iter().map(|g| g.name()))
            .collect()
    }

    /// The warnings about the model, as the command line prints them.
    pub fn warnings(&self) -> String {
        let mut found = self.warnings.clone();
        found.retain(|d| d.severity == Severity::Warning);
        render(&found, &self.sources, false)
    }

    pub(crate) fn findings(&self) -> &[Diagnostic] {
        &self.warnings
    }
}
