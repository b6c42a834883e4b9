//! The state of one check: the file, the names found so far, and the diagnostics.
//!
//! The passes over statements and expressions are methods, each in the file of its subject.

use std::collections::{BTreeMap, BTreeSet};

use crate::ast::{File, Statement};
use crate::check::own_functions::{Arguments, OwnFunction};
use crate::check::scope::Scope;
use crate::check::vocabulary::Vocabulary;
use crate::diagnostic::Diagnostic;
use crate::source::Span;

pub struct Checker<'a> {
    pub file: &'a File,
    pub vocabulary: &'a Vocabulary,
    pub scope: Scope,
    pub found: Vec<Diagnostic>,
    /// Names and limits that were reported, so that each is reported once.
    pub reported: BTreeSet<String>,
    /// Nodes so far with every `let` written out.
    pub written: usize,
    /// The names of all functions that the model defines.
    pub own_function_names: BTreeSet<String>,
    /// The functions that are defined so far.
    pub functions: BTreeMap<String, OwnFunction<'a>>,
    pub used_functions: BTreeSet<String>,
    /// The arguments of the functions whose bodies are being read, the innermost last.
    pub arguments: Vec<Arguments>,
    /// Codes and places of errors in function bodies, so that each is reported once.
    pub reported_in_calls: BTreeSet<(&'static str, Option<Span>)>,
}

impl<'a> Checker<'a> {
    pub fn say(&mut self, d: Diagnostic) {
        self.found.push(d);
    }

    /// Reports an error and returns the caller's `None`.
    pub fn fail<T>(&mut self, d: Diagnostic) -> Option<T> {
        self.found.push(d);
        None
    }

    /// The user's text at a place.
    pub fn text(&self, span: Span) -> &'a str {
        self.file.slice(span)
    }

    pub fn statements(&self) -> impl Iterator<Item = &'a Statement> + use<'a> {
        self.file.statements.iter()
    }
}

/// All values, or `None` if one is missing. Goes through all of them, so that the errors of each are reported.
pub fn every<T>(values: impl Iterator<Item = Option<T>>) -> Option<Vec<T>> {
    let values: Vec<Option<T>> = values.collect();
    values.into_iter().collect()
}
