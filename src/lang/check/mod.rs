//! ast → model: names resolved, statements understood, libraries kept factored.
//!
//! In: one parsed file and the names of the generators. Out: the model, or none if anything is wrong, and every
//! finding. Expands no library and judges no generator's numbers: that is the library's business.

mod arithmetic;
mod complain;
mod constraint;
mod data;
mod declare;
mod discrete;
mod equation;
mod lets;
mod library;
mod measure;
mod restrict;
mod scope;
mod sets;
mod units;
mod unknown;

use std::collections::BTreeSet;

use crate::lang::ast::{File, Keyword, Statement, StatementKind};
use crate::lang::diagnostic::Diagnostic;
use crate::lang::model::{DataBlock, Model};
use crate::lang::source::Span;
pub(in crate::lang) use declare::KEYS;
use scope::Scope;

/// What the checker must know of a generator; the rest is its own business.
#[derive(Clone, Copy, Debug)]
pub struct GeneratorSignature {
    pub name: &'static str,
    /// Shown in messages: `poly(atoms; degree)`.
    pub usage: &'static str,
    /// Only for models with `next`.
    pub discrete_only: bool,
    /// Its atoms become angles: pure numbers.
    pub of_angles: bool,
}

/// The names the language takes from outside.
#[derive(Clone, Debug, Default)]
pub struct Vocabulary {
    pub generators: Vec<GeneratorSignature>,
}

impl Vocabulary {
    pub fn generator(&self, name: &str) -> Option<&GeneratorSignature> {
        self.generators.iter().find(|g| g.name == name)
    }
}

/// Checks one file. The model is `None` only if there are errors, here or in the text (`file.broken`).
pub fn check(file: &File, vocabulary: &Vocabulary) -> (Option<Model>, Vec<Diagnostic>) {
    let mut c = Checker {
        file,
        vocabulary,
        scope: Scope::default(),
        found: Vec::new(),
        reported: BTreeSet::new(),
        written: 0,
    };
    c.headers();
    c.find_time_kind();
    c.number_lets();
    c.declarations();
    c.lets();
    let mut model = c.equations();
    model.system = c.system();
    model.discrete = c.scope.discrete.is_some();
    model.constraints = c.constraints(&model.equations);
    model.symmetries = c.symmetries();
    model.degree = c.degree_limit();
    model.data = c.data_blocks();
    c.units();
    model.vars = std::mem::take(&mut c.scope.vars);
    c.notes(&model);
    let failed = !file.broken.is_empty() || c.found.iter().any(Diagnostic::is_error);
    ((!failed).then_some(model), c.found)
}

struct Checker<'a> {
    file: &'a File,
    vocabulary: &'a Vocabulary,
    scope: Scope,
    found: Vec<Diagnostic>,
    /// Unknown names, each reported once.
    reported: BTreeSet<String>,
    /// Nodes written out so far.
    written: usize,
}

impl<'a> Checker<'a> {
    fn say(&mut self, d: Diagnostic) {
        self.found.push(d);
    }

    /// Reports and gives up on the node at hand.
    fn fail<T>(&mut self, d: Diagnostic) -> Option<T> {
        self.found.push(d);
        None
    }

    /// `sidc 1` comes first, and once.
    fn headers(&mut self) {
        let mut before: Option<Span> = None;
        let mut first_system: Option<Span> = None;
        for s in &self.file.statements {
            match &s.kind {
                StatementKind::Version(v) => {
                    let broken = self.file.broken.iter().find(|b| b.span < s.span);
                    if let Some(before) = before.or(broken.map(|b| b.span)) {
                        self.say(complain::late_version(s.span, before));
                    } else if *v != 1.0 {
                        self.say(complain::future_version(s.span, *v));
                    }
                }
                StatementKind::System(name) => match first_system {
                    Some(first) => self.say(complain::twice(name.span, first, "`system` line")),
                    None => first_system = Some(name.span),
                },
                _ => {}
            }
            before = before.or(Some(s.span));
        }
    }

    fn system(&self) -> Option<String> {
        self.file.statements.iter().find_map(|s| match &s.kind {
            StatementKind::System(name) => Some(name.text.clone()),
            _ => None,
        })
    }

    fn data_blocks(&mut self) -> DataBlock {
        let file = self.file;
        let mut block: Option<DataBlock> = None;
        for s in &file.statements {
            if let StatementKind::Data(entries) = &s.kind {
                match block.as_ref().and_then(|b| b.span) {
                    Some(first) => self.say(complain::twice(s.span, first, "data block")),
                    None => block = Some(self.data(s.span, entries)),
                }
            }
        }
        block.unwrap_or_default()
    }

    /// What is legal and worth a word.
    fn notes(&mut self, model: &Model) {
        let is_broken = |k: Option<Keyword>| self.file.broken.iter().any(|b| b.keyword == k);
        if model.equations.is_empty() {
            let written = |s: &Statement| matches!(s.kind, StatementKind::Equation { .. });
            if !is_broken(None) && !self.statements().any(written) {
                let at = self.file.statements.last().map(|s| s.span);
                let missing = complain::no_equation(at, model, self.file.id);
                self.say(missing);
            }
            return;
        }
        if !self.found.iter().any(Diagnostic::is_error) && self.file.broken.is_empty() {
            let notes = complain::loose_ends(model, &self.scope);
            self.found.extend(notes);
        }
    }

    /// The user's own words.
    fn text(&self, span: Span) -> &'a str {
        self.file.text.get(span.start..span.end).unwrap_or("")
    }

    fn statements(&self) -> impl Iterator<Item = &'a Statement> + use<'a> {
        self.file.statements.iter()
    }
}
