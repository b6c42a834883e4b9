//! Calls of functions that the model defines.
//!
//! In: a call. Out: the body of the function with these arguments: an expression or a library. Errors in a body are shown with the call.

use crate::ast::{Call, Expr as Ast};
use crate::check::checker::{Checker, every};
use crate::check::errors;
use crate::check::own_functions::{Argument, Arguments, OwnFunction};
use crate::check::vocabulary::GeneratorSignature;
use crate::diagnostic::{Diagnostic, Edit};
use crate::model::{LibExpr, LibKind};
use crate::source::Span;
use crate::term::{Expr, Func};

impl<'a> Checker<'a> {
    /// What this argument of the function being read stands for.
    pub fn argument(&self, name: &str) -> Option<&Argument> {
        self.arguments.last()?.get(name)
    }

    /// Whether the model defines a function of this name, anywhere.
    pub fn is_own_function(&self, name: &str) -> bool {
        self.own_function_names.contains(name)
    }

    /// The generator of this name, unless the model defines a function of that name.
    pub fn generator_named(&self, name: &str) -> Option<&'a GeneratorSignature> {
        match self.is_own_function(name) {
            true => None,
            false => self.vocabulary.generator(name),
        }
    }

    /// The built-in function of this name, unless the model defines one of that name.
    pub fn function_named(&self, name: &str) -> Option<Func> {
        match self.is_own_function(name) {
            true => None,
            false => Func::named(name),
        }
    }

    /// True for a call of a function whose body is a library.
    pub fn is_library_function(&self, name: &str) -> bool {
        self.functions.get(name).is_some_and(|f| f.library)
    }

    /// The model's function that is called; the outer `None` if there is none, the inner after an error.
    fn called(&mut self, e: &Ast, call: &Call) -> Option<Option<OwnFunction<'a>>> {
        let name = call.name.text.as_str();
        let function = self.functions.get(name)?.clone();
        self.used_functions.insert(name.to_string());
        if function.wrong {
            return Some(None);
        }
        if call.numbers.is_some() {
            let ours = self.call_without_numbers(call, function.params.len());
            return Some(self.fail(errors::numbers_of_function(e.span, name, &ours)));
        }
        if call.args.len() != function.params.len() {
            let at = (e.span, function.span);
            let params = function.params;
            let ours = self.call_of(call, (params.len(), params.len()), self.example_name());
            let d = errors::own_arity(at, name, params, call.args.len(), &ours);
            return Some(self.fail(d));
        }
        if let Some((p, at)) = call.power
            && p < 0.0
        {
            let arg = call.args.first().map_or("x", |x| self.shown(x.span));
            let d = errors::inverse_or_reciprocal(at, e.span, name, arg);
            return Some(self.fail(d));
        }
        Some(Some(function))
    }

    /// The value of a call; the outer `None` if the model has no function of the name, the inner after an error.
    pub fn own_call(&mut self, e: &Ast, call: &Call) -> Option<Option<Expr>> {
        let function = self.called(e, call)?;
        Some(function.and_then(|f| self.value_of(e, call, &f)))
    }

    fn value_of(&mut self, e: &Ast, call: &Call, f: &OwnFunction<'a>) -> Option<Expr> {
        if f.library {
            let name = self.text(e.span);
            return self.fail(errors::library_by_name_inside(e.span, name, f.span));
        }
        let arguments = self.values(call, f)?;
        let value = self.inside(e.span, arguments, |c| c.arithmetic(f.body))?;
        if !value.is_finite() {
            return self.fail(errors::not_finite(e.span));
        }
        match call.power {
            Some((p, _)) => self.powered(e, value, p),
            None => Some(value),
        }
    }

    /// The library that a call stands for.
    pub fn own_library(&mut self, e: &Ast, call: &Call) -> Option<LibExpr> {
        let f = self.called(e, call).flatten()?;
        if call.power.is_some() {
            let name = &call.name.text;
            return self.fail(errors::form(e.span, name, &format!("{name}(x)^2")));
        }
        let arguments = self.values(call, &f)?;
        let body = self.inside(e.span, arguments, |c| c.library(f.body))?;
        let (name, body) = (call.name.text.clone(), Box::new(body));
        Some(LibExpr::new(e.span, LibKind::Named { name, body }))
    }

    fn values(&mut self, call: &Call, f: &OwnFunction) -> Option<Arguments> {
        let values = every(call.args.iter().map(|x| self.arithmetic(x)))?;
        let names = f.params.iter().map(|p| p.text.clone());
        Some(names.zip(values.into_iter().map(Argument::Value)).collect())
    }

    /// Reads the body of a function with its arguments, and shows the errors in it with this call.
    fn inside<T>(
        &mut self,
        call: Span,
        arguments: Arguments,
        read: impl FnOnce(&mut Self) -> Option<T>,
    ) -> Option<T> {
        let before = self.found.len();
        self.arguments.push(arguments);
        let out = read(self);
        self.arguments.pop();
        let outermost = self.arguments.is_empty();
        let inside = self.found.split_off(before.min(self.found.len()));
        for d in inside {
            let primary = d.labels.iter().find(|l| l.primary).map(|l| l.span);
            // An error in a body is reported once, however often the function is called.
            let again = outermost && !self.reported_in_calls.insert((d.code, primary));
            if !again {
                self.found.push(in_call(d, call));
            }
        }
        out
    }
}

/// A diagnostic from the body of a function, shown with its call.
pub fn in_call(mut d: Diagnostic, call: Span) -> Diagnostic {
    // A fix removes the call and not the part of the body, which may be right with other arguments.
    for edit in d.edits.iter_mut().flatten() {
        if let Edit::Remove(at) = edit {
            *at = call;
        }
    }
    d.also(call, "in this call")
}
