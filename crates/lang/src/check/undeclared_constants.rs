//! Undeclared names where a constant is likely: inside a term, or before one.
//!
//! In: the place of such a name. Out: whether it is inside a term or a coefficient; for coefficients, the library that needs no names.

use std::collections::BTreeSet;

use crate::ast::{Expr as Ast, ExprKind, Side, StatementKind};
use crate::check::checker::Checker;
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::thresholds::MESSAGES;

/// What an undeclared name stands for, judged by its place.
pub enum Undeclared {
    /// A number that a term depends on nonlinearly: the a of `exp(-a*x)`, the K of `x/(K + x)`, the n of `x^n`.
    InsideTerm,
    /// Numbers before terms: the a and b of `dx ~ a*x + b`.
    Coefficients(Coefficients),
    Other,
}

/// Undeclared numbers before the terms of an equation.
pub struct Coefficients {
    names: Vec<PlacedName>,
    /// The equation as a library, and its place: `dx ~ <x, 1>`.
    library: String,
    equation: Span,
}

type PlacedName = (String, Span);

impl Checker<'_> {
    /// What the undeclared name at this place stands for.
    pub fn undeclared(&self, at: Span) -> Undeclared {
        let statement = self.statements().find(|s| s.span.holds(at));
        let (right, targets) = match statement.map(|s| &s.kind) {
            Some(StatementKind::Equation { right, targets, .. }) if right.span.holds(at) => {
                (right, &targets[..])
            }
            Some(StatementKind::Let { body, .. } | StatementKind::Function { body, .. })
                if body.span.holds(at) =>
            {
                (body, &[][..])
            }
            _ => return Undeclared::Other,
        };
        if self.is_nonlinear(right, at) {
            return Undeclared::InsideTerm;
        }
        let (Some(first), Some(last)) = (targets.first(), targets.last()) else {
            return Undeclared::Other;
        };
        match self.coefficients(right) {
            Some((names, terms)) if names.iter().any(|(_, place)| *place == at) => {
                let targets = self.text(first.span.to(last.span));
                let library = format!("{targets} ~ <{}>", terms.join(", "));
                Undeclared::Coefficients(Coefficients {
                    names,
                    library,
                    equation: first.span.to(right.span),
                })
            }
            _ => Undeclared::Other,
        }
    }

    /// The message about names before terms; they are not reported again.
    pub fn undeclared_coefficients(&mut self, at: Span, coefficients: &Coefficients) -> Diagnostic {
        let Coefficients {
            names,
            library,
            equation,
        } = coefficients;
        let mut said: BTreeSet<&str> = BTreeSet::new();
        let mut d = Diagnostic::error(
            "unknown-signal",
            "coefficients are found with the equation and need no names",
        );
        for (name, place) in names {
            if !said.insert(name) {
                continue;
            }
            self.reported.insert(name.clone());
            d = match *place == at {
                true => d.at(*place, "not declared"),
                false => d.also(*place, "nor is this"),
            };
        }
        let name = self.text(at);
        let d = d.fix(*equation, library.as_str());
        let d = match said.len() {
            1 => self.declaring(d, at, &["state", "input"], name),
            // Declaring one name would leave the others undeclared.
            _ => d,
        };
        d.help(format!(
            "list the terms alone: `{library}`; if `{name}` is a signal, declare it: `state {name}` or `input {name}`"
        ))
    }

    /// Whether the name at this place stands with a declared one inside an argument, a divisor or a power, where a number is not a
    /// coefficient.
    fn is_nonlinear(&self, e: &Ast, at: Span) -> bool {
        let Some(inner) = child_with(e, at) else {
            return false;
        };
        let around = match &e.kind {
            ExprKind::Call(_) => Some(inner),
            ExprKind::Power(..) => Some(e),
            ExprKind::Product(parts) => {
                let below = |(side, x): &&(Side, Ast)| *side == Side::Below && x.span == inner.span;
                parts.iter().find(below).map(|(_, x)| x)
            }
            _ => None,
        };
        around.is_some_and(|a| self.mentions_declared(a)) || self.is_nonlinear(inner, at)
    }

    fn mentions_declared(&self, e: &Ast) -> bool {
        let own = e.as_name().is_some_and(|name| self.is_declared(name));
        own || e.children().into_iter().any(|x| self.mentions_declared(x))
    }

    pub fn is_declared(&self, name: &str) -> bool {
        self.scope.signal(name).is_some()
            || self.scope.lets.contains_key(name)
            || self.argument(name).is_some()
            || name == "pi"
    }

    /// The undeclared factors and summands of a sum of terms, and the terms without them. `None` if the sum contains a library, if no
    /// undeclared factor multiplies something declared, or if there are too many for a message.
    fn coefficients(&self, right: &Ast) -> Option<(Vec<PlacedName>, Vec<String>)> {
        if self.is_library(right) {
            return None;
        }
        let one = [right];
        let summands: Vec<&Ast> = match &right.ungrouped().kind {
            ExprKind::Sum(parts) => parts.iter().map(|(_, x)| x).collect(),
            _ => one.to_vec(),
        };
        if summands.len() > MESSAGES.scope_names {
            return None;
        }
        let (mut found, mut terms, mut scaled) = (Vec::new(), Vec::<String>::new(), false);
        for summand in summands {
            let (names, term) = self.without_coefficients(summand);
            if names.len() > 1 && term == "1" {
                // In `b*y`, either may be a forgotten signal.
                return None;
            }
            scaled |= !names.is_empty() && term != "1";
            found.extend(names);
            if !terms.contains(&term) {
                terms.push(term);
            }
        }
        (scaled && found.len() <= MESSAGES.scope_names).then_some((found, terms))
    }

    /// A summand's undeclared factors, and its text without them.
    fn without_coefficients(&self, summand: &Ast) -> (Vec<PlacedName>, String) {
        let undeclared = |e: &Ast| {
            let mut names = Vec::new();
            names_in(e, &mut names);
            let none = names.iter().all(|(name, _)| !self.is_declared(name));
            (none && !names.is_empty()).then_some(names)
        };
        let mut e = summand.ungrouped();
        while let ExprKind::Negate(inner) = &e.kind {
            e = inner.ungrouped();
        }
        let ExprKind::Product(parts) = &e.kind else {
            return match undeclared(e) {
                Some(found) => (found, "1".into()),
                None => (Vec::new(), self.text(e.span).into()),
            };
        };
        let (mut names, mut rest) = (Vec::new(), Vec::new());
        for factor in parts {
            match undeclared(&factor.1) {
                Some(found) => names.extend(found),
                None => rest.push(factor),
            }
        }
        let mut text = self.file.product_of(rest);
        if text.is_empty() {
            text.push('1');
        }
        (names, text)
    }
}

fn child_with(e: &Ast, at: Span) -> Option<&Ast> {
    let children = e.children().into_iter();
    let mut holding = children.filter(|x| x.span.holds(at));
    holding.next()
}

/// Names and their places in an expression, except those inside calls.
fn names_in(e: &Ast, out: &mut Vec<PlacedName>) {
    match &e.kind {
        ExprKind::Name(name) => out.push((name.clone(), e.span)),
        ExprKind::Call(_) => {}
        _ => e.children().into_iter().for_each(|x| names_in(x, out)),
    }
}
