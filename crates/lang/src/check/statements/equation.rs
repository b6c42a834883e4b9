//! `TARGET ~ LIBRARY` and `TARGET = EXPR`: one equation per target.
//!
//! In: equation statements. Out: targets resolved, known parts as expressions, the rest as one set expression. Expands nothing.

use std::collections::BTreeMap;

use crate::ast::{Call, Expr as Ast, ExprKind, Sign, StatementKind};
use crate::check::checker::Checker;
use crate::check::errors;
use crate::check::expressions::union;
use crate::model::{Equation, LibExpr, LibKind, Model, RightSide, VarKind};
use crate::parse::foreign_spellings::{foreign, functions};
use crate::source::Span;
use crate::term::{Expr, Signal};

impl Checker<'_> {
    /// The equations, in a model that is otherwise empty.
    pub fn equations(&mut self) -> Model {
        let mut model = Model::default();
        let mut taken: BTreeMap<Signal, Span> = BTreeMap::new();
        for s in self.statements() {
            let StatementKind::Equation {
                targets,
                known,
                right,
                written,
            } = &s.kind
            else {
                continue;
            };
            if *known && self.is_bare_function(s.span, targets) {
                continue;
            }
            let targets = self.targets(targets);
            let copies = targets.len().max(1);
            let Some(size) = self.sized(right) else {
                continue;
            };
            let more = size.nodes.saturating_mul(copies - 1);
            if self.afford(right.span, more).is_none() {
                continue;
            }
            let right = if *known {
                self.known_side(right, &targets)
            } else {
                self.search_side(right, &targets)
            };
            for (target, target_span) in targets {
                if let Some(first) = taken.insert(target, target_span) {
                    let name = self.spelling(target);
                    self.say(errors::second_equation(target_span, first, &name));
                    continue;
                }
                if let Some(right) = right.clone() {
                    model.equations.push(Equation {
                        target,
                        target_span,
                        span: s.span,
                        written: one_line(written.as_deref().unwrap_or(self.text(s.span))),
                        right,
                    });
                }
            }
        }
        model
    }

    /// Reports `f(x) = x^2`.
    fn is_bare_function(&mut self, statement: Span, targets: &[Ast]) -> bool {
        let [target] = targets else {
            return false;
        };
        let ExprKind::Call(call) = &target.kind else {
            return false;
        };
        let name = call.name.text.as_str();
        let names = !call.args.is_empty() && call.args.iter().all(|x| x.as_name().is_some());
        let free = !self.is_declared(name)
            && self.function_named(name).is_none()
            && self.generator_named(name).is_none()
            && functions::target(self.text(target.span)).is_none();
        let is_function =
            free && names && !call.juxtaposed && call.numbers.is_none() && name != "next";
        if is_function {
            let line = self.text(statement);
            self.say(errors::function_without_let(target.span, statement, line));
        }
        is_function
    }

    pub fn spelling(&self, s: Signal) -> String {
        let name = self.scope.var(s.var).map_or("?", |v| v.name.as_str());
        match s.shift {
            0 => "d".repeat(usize::from(s.der)) + name,
            1 => format!("next({name})"),
            k => format!("lag({name}, {})", -k),
        }
    }

    fn targets(&mut self, targets: &[Ast]) -> Vec<(Signal, Span)> {
        let mut out = Vec::new();
        for e in targets {
            match &e.kind {
                ExprKind::Name(text) => {
                    out.extend(self.target_name(e.span, text).map(|s| (s, e.span)))
                }
                ExprKind::Call(call) if call.name.text == "next" => {
                    out.extend(self.target_next(e, call))
                }
                ExprKind::Indexed(name, _) => drop(self.stray_index::<()>(e, name)),
                ExprKind::Range(from, to) => {
                    for name in self.expand_range(e.span, from, to).unwrap_or_default() {
                        out.extend(self.target_name(e.span, &name).map(|s| (s, e.span)));
                    }
                }
                _ => self.say(match functions::target(self.text(e.span)) {
                    Some(ours) => foreign(e.span, self.text(e.span), &ours),
                    None => errors::not_a_target(e.span, &self.example_target()),
                }),
            }
        }
        out
    }

    /// A target that this model could have, for messages.
    pub fn example_target(&self) -> String {
        let state = self.scope.vars.iter().find(|v| v.kind == VarKind::State);
        match state {
            Some(v) if self.scope.discrete.is_some() => format!("next {}", v.name),
            Some(v) => "d".repeat(usize::from(v.order)) + &v.name,
            None => "dx".to_string(),
        }
    }

    fn target_next(&mut self, e: &Ast, call: &Call) -> Option<(Signal, Span)> {
        let s = self.next(e, call)?;
        let var = self.scope.var(s.var)?;
        if var.kind == VarKind::State {
            return Some((s, e.span));
        }
        let d = errors::next_of_other(e.span, var);
        self.fail(d)
    }

    /// A declared derivative of a state, or an output.
    fn target_name(&mut self, span: Span, text: &str) -> Option<Signal> {
        if self.scope.lets.contains_key(text) && self.scope.signal(text).is_none() {
            let definition = self.scope.lets.get(text).map(|l| l.span);
            return self.fail(errors::let_as_target(span, text, definition));
        }
        let Some(s) = self.scope.signal(text) else {
            return self.unknown_name(span, text);
        };
        let var = self.scope.var(s.var)?;
        let fits = match var.kind {
            VarKind::State => s.der > 0,
            VarKind::Output => true,
            _ => false,
        };
        if fits {
            return Some(s);
        }
        let d = errors::wrong_target(span, text, var, self.scope.discrete.is_some());
        self.fail(d)
    }

    /// `TARGET = EXPR`
    fn known_side(&mut self, right: &Ast, targets: &[(Signal, Span)]) -> Option<RightSide> {
        if self.is_library(right) {
            return self.fail(errors::known_library(right.span));
        }
        let expr = self.arithmetic(right)?;
        self.known_part(right, expr, targets).map(RightSide::Known)
    }

    fn known_part(&mut self, e: &Ast, expr: Expr, targets: &[(Signal, Span)]) -> Option<Expr> {
        if !expr.is_finite() {
            return self.fail(errors::not_finite(e.span));
        }
        match targets.iter().find(|(s, _)| expr.mentions(*s)) {
            Some((s, at)) => {
                let name = self.spelling(*s);
                self.fail(errors::known_with_target(e.span, *at, &name))
            }
            None => Some(expr),
        }
    }

    /// `TARGET ~ known(EXPR) + LIBRARY`
    fn search_side(&mut self, right: &Ast, targets: &[(Signal, Span)]) -> Option<RightSide> {
        let parts: Vec<(Sign, &Ast)> = match &right.kind {
            ExprKind::Sum(parts) => parts.iter().map(|(s, x)| (*s, x)).collect(),
            _ => vec![(Sign::Plus, right)],
        };
        let (mut known, mut required, mut rest) = (Vec::new(), Vec::new(), Vec::new());
        let mut complete = true;
        for (sign, part) in parts {
            match &part.kind {
                ExprKind::Call(call) if call.name.text == "known" => {
                    match self.known_summand(sign, part, call, targets) {
                        Some(expr) => known.push((expr, part.span)),
                        None => complete = false,
                    }
                }
                ExprKind::Call(call) if self.is_required(call) => {
                    match self.required_summand(sign, part, call) {
                        Some(set) => required.push(set),
                        None => complete = false,
                    }
                }
                _ => rest.push((sign, part)),
            }
        }
        if let Some((Sign::Minus, first)) = rest.first() {
            return self.fail(errors::minus_from_nothing(first.span));
        }
        // What is required is written beside the library and is part of it, whatever is taken out of that.
        if !rest.is_empty() {
            required.insert(0, self.set_sum(&rest)?);
        }
        let library = union(required);
        complete.then_some(RightSide::Search { known, library })
    }

    fn is_required(&self, call: &Call) -> bool {
        call.name.text == "required" && !call.juxtaposed && !self.is_own_function("required")
    }

    /// `required(A, B)`
    fn required_summand(&mut self, sign: Sign, e: &Ast, call: &Call) -> Option<LibExpr> {
        if call.args.is_empty() {
            return self.fail(errors::form(e.span, "required", "required(x, x^3)"));
        }
        if sign == Sign::Minus || call.numbers.is_some() || call.power.is_some() {
            return self.fail(errors::required_subtracted(e.span));
        }
        let items = self.items(&call.args)?;
        let set = LibExpr::new(e.span, LibKind::List(items));
        Some(LibExpr::new(e.span, LibKind::Required(Box::new(set))))
    }

    fn known_summand(
        &mut self,
        sign: Sign,
        e: &Ast,
        call: &Call,
        targets: &[(Signal, Span)],
    ) -> Option<Expr> {
        let [arg] = call.args.as_slice() else {
            return self.fail(errors::form(e.span, "known", "known(-9.8*x)"));
        };
        if sign == Sign::Minus || call.numbers.is_some() || call.power.is_some() {
            return self.fail(errors::known_subtracted(e.span));
        }
        let expr = self.arithmetic(arg)?;
        self.known_part(arg, expr, targets)
    }
}

/// A statement without comments and line breaks.
fn one_line(text: &str) -> String {
    let lines = text.lines().map(|l| l.split('#').next().unwrap_or(""));
    let words: Vec<&str> = lines.flat_map(str::split_whitespace).collect();
    words.join(" ")
}
