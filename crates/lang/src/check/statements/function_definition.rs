//! `let sat(v) = tanh(v/vs)`: a function with a name.
//!
//! In: the statement. Out: the function in the checker's table. Names in the body are looked up here, so that a function that is never
//! called is checked too; each call decides what the body means. A function may use only those above it, which rules out recursion.

use std::collections::BTreeMap;
use std::rc::Rc;

use crate::ast::{Call, Expr as Ast, ExprKind, Ident, Statement, StatementKind};
use crate::check::checker::Checker;
use crate::check::errors;
use crate::check::own_functions::{Argument, OwnFunction};
use crate::source::Span;
use crate::term::Func;

/// Words with a meaning of their own before `(`.
const FORMS: [&str; 7] = [
    "known", "required", "next", "lag", "coef", "unwrap", "delay",
];

impl<'a> Checker<'a> {
    /// Collects the names of the model's own functions, which take precedence over built-in functions and generators.
    pub fn function_names(&mut self) {
        let names = self.statements().filter_map(|s| match &s.kind {
            StatementKind::Function { name, .. } => Some(name.text.clone()),
            _ => None,
        });
        self.own_function_names = names.collect();
    }

    pub fn define_function(&mut self, s: &'a Statement) {
        let StatementKind::Function { name, params, body } = &s.kind else {
            return;
        };
        if let Some(first) = self.functions.get(&name.text).map(|f| f.span) {
            let what = format!("function `{}`", name.text);
            return self.say(errors::twice(name.span, first, &what));
        }
        let before = self.found.len();
        self.function_name(name);
        self.function_params(s, params, body);
        let names = params.iter().map(|p| (p.text.clone(), Argument::Name));
        self.arguments.push(names.collect());
        self.body_names(body);
        self.arguments.pop();
        let shape = self.shape(body, params);
        let sized = self.within_limits(body.span, shape.own);
        let wrong = sized.is_none() || self.found.iter().skip(before).any(|d| d.is_error());
        let function = OwnFunction {
            span: name.span,
            params,
            body,
            library: self.is_library(body),
            wrong,
            shape: Rc::new(shape),
        };
        self.functions.insert(name.text.clone(), function);
    }

    fn function_name(&mut self, name: &Ident) {
        let text = name.text.as_str();
        if text == "t" || text == "pi" {
            self.say(errors::taken_by_function(name.span, text, name.span));
        } else if FORMS.contains(&text) {
            self.say(errors::form_as_function(name.span, text));
        } else if let Some(signal) = self.scope.signal(text) {
            let declared = self.scope.var(signal.var).and_then(|v| v.span);
            self.say(errors::let_clash(name.span, text, declared));
        } else if let Some(first) = self.scope.lets.get(text).map(|l| l.span) {
            self.say(errors::twice(name.span, first, &format!("`let {text}`")));
        } else if Func::named(text).is_some() || self.vocabulary.generator(text).is_some() {
            self.say(errors::function_replaced(name.span, text));
        }
    }

    /// Reports arguments that are given twice or whose names mean something else in the model.
    fn function_params(&mut self, s: &'a Statement, params: &'a [Ident], body: &'a Ast) {
        let mut seen: BTreeMap<&str, Span> = BTreeMap::new();
        for p in params {
            let text = p.text.as_str();
            if let Some(first) = seen.insert(text, p.span) {
                self.say(errors::second_argument(p.span, first, text));
            } else if text == "t" || text == "pi" {
                self.say(errors::taken_by_function(p.span, text, s.span));
            } else if let Some((meaning, place)) = self.meaning_elsewhere(text) {
                let other = self.free_name(text);
                let renamed = self.renamed(s.span, (params, body), (text, &other));
                let at = (p.span, place);
                self.say(errors::argument_hides(
                    at,
                    (text, meaning),
                    &other,
                    s.span,
                    renamed,
                ));
            }
        }
    }

    /// What a name means outside functions, and where it is declared.
    fn meaning_elsewhere(&self, text: &str) -> Option<(&'static str, Option<Span>)> {
        if let Some(signal) = self.scope.signal(text) {
            return Some(("a signal", self.scope.var(signal.var).and_then(|v| v.span)));
        }
        self.statements().find_map(|s| match &s.kind {
            StatementKind::Let { name, .. } if name.text == text => {
                Some(("a `let`", Some(name.span)))
            }
            StatementKind::Function { name, .. } if name.text == text => {
                Some(("a function", Some(name.span)))
            }
            _ => None,
        })
    }

    /// `v_`, with more underscores until it does not occur in the text.
    fn free_name(&self, text: &str) -> String {
        let mut other = format!("{text}_");
        while self.file.texts().any(|t| t.contains(&other)) {
            other.push('_');
        }
        other
    }

    /// The statement with another name for an argument.
    fn renamed(
        &self,
        statement: Span,
        (params, body): (&[Ident], &Ast),
        (old, new): (&str, &str),
    ) -> String {
        let own = params.iter().filter(|p| p.text == old).map(|p| p.span);
        let mut places: Vec<Span> = own.chain(body.places_of(old)).collect();
        places.sort_by_key(|p| p.start);
        places.dedup();
        let edits = places.into_iter().map(|p| (p, new.to_string()));
        self.file.edited(statement, edits.collect())
    }

    /// Looks up every name of a body.
    fn body_names(&mut self, e: &Ast) {
        match &e.kind {
            ExprKind::Name(text) => {
                let known = self.argument(text).is_some()
                    || self.scope.use_signal(text).is_some()
                    || self.scope.lets.contains_key(text)
                    || text == "pi";
                self.scope.used_lets.insert(text.clone());
                if !known {
                    self.unknown_name::<()>(e.span, text);
                }
            }
            ExprKind::Text(text) => drop(self.text_in_model::<()>(e, text)),
            ExprKind::Range(..) => {}
            ExprKind::Call(call) => self.body_call(e, call),
            _ => e.children().into_iter().for_each(|x| self.body_names(x)),
        }
    }

    fn body_call(&mut self, e: &Ast, call: &Call) {
        let name = call.name.text.as_str();
        if let Some(f) = self.functions.get(name) {
            let params = f.params;
            let at = (e.span, f.span);
            self.used_functions.insert(name.to_string());
            if params.len() != call.args.len() {
                let ours = self.call_of(call, (params.len(), params.len()), self.example_name());
                let found = call.args.len();
                self.say(errors::own_arity(at, name, params, found, &ours));
            }
        } else if let Some(f) = self.function_named(name) {
            let (found, (least, most)) = (call.args.len(), f.arity);
            if found < least || found > most {
                let ours = self.call_of(call, f.arity, self.example_name());
                self.say(errors::arity(e.span, (f.name, found), f.arity, &ours));
            }
        } else if self.generator_named(name).is_none() && !["next", "lag"].contains(&name) {
            self.not_a_function::<()>(e, call);
            return;
        }
        let numbers = call.numbers.iter().flatten();
        call.args
            .iter()
            .chain(numbers)
            .for_each(|x| self.body_names(x));
    }
}
