//! `let`: a number, an expression or a library with a name. Functions are defined in the same pass.
//!
//! In: the `let` statements. Out: their values in the scope. Plain numbers are defined first, so that attributes may use them. Every
//! other `let` may use those above it, which rules out circular definitions.

use crate::ast::{Expr as Ast, ExprKind, StatementKind};
use crate::check::checker::Checker;
use crate::check::errors;
use crate::check::scope::{Let, Value};
use crate::source::Span;

impl Checker<'_> {
    /// Defines the `let`s that are plain numbers.
    pub fn number_lets(&mut self) {
        for s in self.statements() {
            if let StatementKind::Let { name, body } = &s.kind
                && self.is_numeric(body)
                && !self.scope.lets.contains_key(&name.text)
                && self.sized(body).is_some()
            {
                let value = self
                    .constant(body, "a constant")
                    .map_or(Value::Wrong, Value::Number);
                self.define(&name.text, name.span, value, (1, 1));
            }
        }
    }

    fn is_numeric(&self, e: &Ast) -> bool {
        match &e.kind {
            ExprKind::Name(text) => {
                let value = self.scope.lets.get(text).map(|l| &l.value);
                text == "pi" || matches!(value, Some(Value::Number(_)))
            }
            ExprKind::Text(_) | ExprKind::List(_) | ExprKind::Range(..) => false,
            ExprKind::Call(call) if self.function_named(&call.name.text).is_none() => false,
            _ => e.children().into_iter().all(|x| self.is_numeric(x)),
        }
    }

    fn define(&mut self, name: &str, span: Span, value: Value, (nodes, depth): (usize, usize)) {
        let entry = Let {
            span,
            value,
            nodes,
            depth,
        };
        self.scope.lets.insert(name.to_string(), entry);
    }

    /// Defines all other `let`s, each of which may use those above it.
    pub fn lets(&mut self) {
        for s in self.statements() {
            let StatementKind::Let { name, body } = &s.kind else {
                self.define_function(s);
                continue;
            };
            let text = name.text.as_str();
            if text == "t" || text == "pi" {
                self.say(errors::taken(name.span, text));
                continue;
            }
            if let Some(signal) = self.scope.signal(text) {
                let declared = self.scope.var(signal.var).and_then(|v| v.span);
                self.say(errors::let_clash(name.span, text, declared));
                continue;
            }
            if let Some(first) = self.functions.get(text).map(|f| f.span) {
                let what = format!("function `{text}`");
                self.say(errors::twice(name.span, first, &what));
                continue;
            }
            match self.scope.lets.get(text).map(|l| l.span) {
                Some(span) if span == name.span => continue,
                Some(first) => {
                    self.say(errors::twice(name.span, first, &format!("`let {text}`")));
                    continue;
                }
                None => {}
            }
            let Some(size) = self.sized(body) else {
                self.define(text, name.span, Value::Wrong, (1, 1));
                continue;
            };
            let value = self.let_value(body).unwrap_or(Value::Wrong);
            self.define(text, name.span, value, (size.nodes, size.depth));
        }
    }

    fn let_value(&mut self, body: &Ast) -> Option<Value> {
        if self.is_library(body) {
            return self.library(body).map(Value::Library);
        }
        let expr = self.arithmetic(body)?;
        if !expr.is_finite() {
            return self.fail(errors::not_finite(body.span));
        }
        if let Some(x) = expr.as_number() {
            return Some(Value::Number(x));
        }
        let before = self.found.len();
        let library = match self.library(body) {
            Some(library) => Ok(library),
            None => Err(self.found.split_off(before)),
        };
        Some(Value::Expr { expr, library })
    }
}
