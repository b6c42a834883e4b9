//! The symbol table of a model: what was declared, what each name means, and what was used.
//!
//! In: declarations. Out: the signal or `let` of a name. Derivatives such as `dx` are names that declarations make; no name is taken
//! apart to find them.

use std::collections::{BTreeMap, BTreeSet};

use crate::diagnostic::Diagnostic;
use crate::model::{LibExpr, UnknownConstant, Var};
use crate::source::Span;
use crate::term::{Expr, Signal, VarId};
use crate::thresholds::MESSAGES;

#[derive(Debug, Default)]
pub struct Scope {
    /// Index 0 is time.
    pub vars: Vec<Var>,
    /// Every spelling without primes: `x`, `dx`, `ddx`, `t`.
    pub signals: BTreeMap<String, Signal>,
    /// The variables that are unknown constants.
    pub unknowns: Vec<UnknownConstant>,
    pub lets: BTreeMap<String, Let>,
    /// Where the model first uses discrete time (`next`, `lag`).
    pub discrete: Option<Span>,
    /// Names that broken statements would have declared.
    pub broken_names: BTreeSet<String>,
    /// Whether a missing file may have declared any name.
    pub incomplete: bool,
    pub used_vars: BTreeSet<VarId>,
    pub used_lets: BTreeSet<String>,
}

/// A checked `let`.
#[derive(Debug)]
pub struct Let {
    pub span: Span,
    pub value: Value,
    /// Size with every `let` in it written out, to limit what inlining may build.
    pub nodes: usize,
    pub depth: usize,
}

#[derive(Debug)]
pub enum Value {
    Number(f64),
    /// Arithmetic on signals, usable in terms. As a library it is one term, or the set of its summands.
    Expr {
        expr: Expr,
        /// Its meaning outside `< >`, or why it has none there.
        library: Result<LibExpr, Vec<Diagnostic>>,
    },
    Library(LibExpr),
    /// Wrong; an error was reported.
    Wrong,
}

impl Scope {
    /// The signal that a name means, primes included.
    pub fn signal(&self, text: &str) -> Option<Signal> {
        let base = text.trim_end_matches('\'');
        let primes = text.len() - base.len();
        let s = *self.signals.get(base)?;
        if primes == 0 {
            return Some(s);
        }
        let order = usize::from(s.der) + primes;
        let var = self.vars.get(usize::from(s.var.0))?;
        let exists = s.shift == 0 && order <= usize::from(var.order);
        exists.then(|| Signal::derivative(s.var, order as u8))
    }

    /// As [`Scope::signal`], counted as a use.
    pub fn use_signal(&mut self, text: &str) -> Option<Signal> {
        let s = self.signal(text)?;
        self.used_vars.insert(s.var);
        Some(s)
    }

    pub fn var(&self, id: VarId) -> Option<&Var> {
        self.vars.get(usize::from(id.0))
    }

    /// True if a broken statement or a missing file may have declared this name.
    pub fn may_be_declared(&self, text: &str) -> bool {
        if self.incomplete {
            return true;
        }
        let mut base = text.trim_end_matches('\'');
        loop {
            if self.broken_names.contains(base) {
                return true;
            }
            match base.strip_prefix('d') {
                Some(rest) => base = rest,
                None => return false,
            }
        }
    }

    /// `theta, dtheta, ddtheta`
    pub fn spellings(&self, id: VarId) -> String {
        let Some(var) = self.var(id) else {
            return String::new();
        };
        let names: Vec<String> = (0..=usize::from(var.order))
            .map(|k| "d".repeat(k) + &var.name)
            .collect();
        names.join(", ")
    }

    /// Every name, variables in order of declaration and then `let`s, cut short if there are many.
    pub fn in_scope(&self) -> String {
        let mut names: Vec<String> = Vec::new();
        for var in self.vars.iter().skip(1) {
            if names.len() > MESSAGES.scope_names {
                break;
            }
            names.extend((0..=usize::from(var.order)).map(|k| "d".repeat(k) + &var.name));
        }
        names.extend(self.lets.keys().cloned());
        if names.is_empty() {
            return "nothing but t and pi".to_string();
        }
        let more = names.len() > MESSAGES.scope_names;
        names.truncate(MESSAGES.scope_names);
        names.join(", ") + if more { ", …" } else { "" }
    }
}
