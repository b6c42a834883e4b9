//! ast → model: names resolved, statements understood, libraries kept factored.
//!
//! In: one parsed file and the names of the generators. Out: the model, or none if there are errors, and all diagnostics. Expands no
//! library and checks no generator's numbers; the library does.

mod checker;
mod errors;
mod expressions;
mod families;
mod hidden_states;
mod own_functions;
mod scope;
mod statements;
mod suggestions;
mod time_domain;
mod undeclared_constants;
mod unknown_names;
mod vocabulary;

use std::collections::{BTreeMap, BTreeSet};

use crate::ast::{Broken, File, Keyword, Statement, StatementKind};
use crate::diagnostic::Diagnostic;
use crate::model::{DataBlock, Model};
use crate::source::Span;
use checker::Checker;
use scope::Scope;

pub use vocabulary::{GeneratorSignature, Vocabulary};

/// Checks one file. The model is `None` only if there are errors, here or in the text (`file.broken`).
pub fn check(file: &File, vocabulary: &Vocabulary) -> (Option<Model>, Vec<Diagnostic>) {
    let Some((written, mut found)) = families::expand_families(file) else {
        return check_equations(file, vocabulary);
    };
    let (model, more) = check_equations(&written, vocabulary);
    // An error that all equations of a family share is reported once.
    for d in more {
        if !found.contains(&d) {
            found.push(d);
        }
    }
    (model, found)
}

/// [`check`], of a file without families.
fn check_equations(file: &File, vocabulary: &Vocabulary) -> (Option<Model>, Vec<Diagnostic>) {
    let mut c = Checker {
        file,
        vocabulary,
        scope: Scope::default(),
        found: Vec::new(),
        reported: BTreeSet::new(),
        written: 0,
        own_function_names: BTreeSet::new(),
        functions: BTreeMap::new(),
        used_functions: BTreeSet::new(),
        arguments: Vec::new(),
        reported_in_calls: BTreeSet::new(),
    };
    c.headers();
    c.function_names();
    c.find_time_kind();
    c.number_lets();
    c.declarations();
    c.lets();
    let mut model = c.equations();
    model.system = c.system();
    model.discrete = c.scope.discrete.is_some();
    model.constraints = c.constraints(&model.equations);
    model.per_run = c.per_run(&model.equations);
    model.resets = c.resets(&model.equations);
    model.symmetries = c.symmetries();
    model.degree = c.degree_limit();
    model.norms = c.preferred_norms();
    model.data = c.data_blocks();
    c.units();
    model.vars = std::mem::take(&mut c.scope.vars);
    model.unknowns = std::mem::take(&mut c.scope.unknowns);
    c.hidden_states(&model);
    c.notes(&model);
    let failed = !file.broken.is_empty() || c.found.iter().any(Diagnostic::is_error);
    ((!failed).then_some(model), c.found)
}

impl<'a> Checker<'a> {
    /// `sidc 1` comes first; `sidc` and `system` are given once.
    fn headers(&mut self) {
        let mut before: Option<Span> = None;
        let mut first_system: Option<Span> = None;
        for s in &self.file.statements {
            match &s.kind {
                StatementKind::Version(v) => {
                    let before_it = |b: &&Broken| b.span.file == s.span.file && b.span < s.span;
                    let broken = self.file.broken.iter().find(before_it);
                    if let Some(before) = before.or(broken.map(|b| b.span)) {
                        self.say(errors::late_version(s.span, before));
                    } else if *v != 1.0 {
                        self.say(errors::future_version(s.span, *v));
                    }
                }
                StatementKind::System(name) => match first_system {
                    Some(first) => self.say(errors::twice(name.span, first, "`system` line")),
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
                    Some(first) => self.say(errors::twice(s.span, first, "data block")),
                    None => block = Some(self.data(s.span, entries)),
                }
            }
        }
        block.unwrap_or_default()
    }

    /// Reports a missing equation, and what is legal but probably not meant.
    fn notes(&mut self, model: &Model) {
        if model.equations.is_empty() {
            let written = |s: &Statement| matches!(s.kind, StatementKind::Equation { .. });
            let perhaps = [None, Some(Keyword::Include)];
            if !self
                .file
                .broken
                .iter()
                .any(|b| perhaps.contains(&b.keyword))
                && !self.statements().any(written)
            {
                let at = self.file.statements.last().map(|s| s.span);
                let missing = errors::no_equation(at, model, self.file);
                self.say(missing);
            }
            return;
        }
        if !self.found.iter().any(Diagnostic::is_error) && self.file.broken.is_empty() {
            let notes = errors::unused_declarations(model, &self.scope);
            let idle = self.functions.iter();
            let idle = idle.filter(|(name, _)| !self.used_functions.contains(*name));
            let idle = idle.map(|(name, f)| errors::unused(f.span, name, false));
            // An included file may declare more than this model uses.
            let own = |d: &Diagnostic| d.labels.iter().all(|l| l.span.file == self.file.id);
            let notes: Vec<Diagnostic> = notes.into_iter().chain(idle).filter(own).collect();
            self.found.extend(notes);
        }
    }
}
