//! `TARGET ~ LIBRARY` and `TARGET = EXPR`: one equation per target.
//!
//! In: equation statements. Out: targets resolved, known parts as expressions, the rest as one set expression. Expands nothing.

use std::collections::BTreeMap;

use crate::ast::{Call, Expr as Ast, ExprKind, Sign, StatementKind};
use crate::check::checker::Checker;
use crate::check::errors;
use crate::check::expressions::union;
use crate::diagnostic::Edit;
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
            let targets = self.targets(targets, right, *known);
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

    /// `right` is the other side; `known` is true if the sign is `=`.
    fn targets(&mut self, targets: &[Ast], right: &Ast, known: bool) -> Vec<(Signal, Span)> {
        let mut out = Vec::new();
        for e in targets {
            match &e.kind {
                ExprKind::Name(text) => {
                    out.extend(self.target_name(e.span, text).map(|s| (s, e.span)))
                }
                ExprKind::Call(call) if call.name.text == "next" => {
                    out.extend(self.target_next(e, call))
                }
                ExprKind::Indexed(name, index) => drop(self.stray_index::<()>(e, name, index)),
                ExprKind::Range(from, to) => {
                    for name in self.expand_range(e.span, from, to).unwrap_or_default() {
                        out.extend(self.target_name(e.span, &name).map(|s| (s, e.span)));
                    }
                }
                _ => self.say(match functions::target(self.text(e.span)) {
                    Some(ours) => foreign(e.span, self.text(e.span), &ours),
                    None => {
                        let moved = self.moved_right(e, known).filter(|_| targets.len() == 1);
                        let example = self.example_target();
                        let (target, sum) = moved.unwrap_or((example, String::new()));
                        let sign = if known { "=" } else { "~" };
                        errors::not_a_target(e.span, (&target, sign), (right.span, sum))
                    }
                }),
            }
        }
        out
    }

    /// For `dx - y ~ …`: `dx`, and `known(y) + ` to put before the right side.
    fn moved_right(&self, e: &Ast, known: bool) -> Option<(String, String)> {
        let ExprKind::Sum(parts) = &e.kind else {
            return None;
        };
        let is_target = |(sign, x): &&(Sign, Ast)| {
            let signal = x.as_name().and_then(|name| self.scope.signal(name));
            *sign == Sign::Plus && signal.is_some_and(|s| s.der > 0)
        };
        let (_, target) = parts.iter().find(is_target)?;
        let mut moved = String::new();
        for (sign, x) in parts.iter().filter(|(_, x)| x.span != target.span) {
            moved.push_str(match (moved.is_empty(), sign) {
                (true, Sign::Minus) => "",
                (true, Sign::Plus) => "-",
                (false, Sign::Minus) => " + ",
                (false, Sign::Plus) => " - ",
            });
            moved.push_str(self.text(x.span));
        }
        let sum = match known {
            true => format!("{moved} + "),
            false => format!("known({moved}) + "),
        };
        Some((self.text(target.span).to_string(), sum))
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
        let last = targets.last().map(|(_, at)| *at);
        let sign = last.and_then(|at| self.relation_sign(at, right.span));
        if self.is_library(right) {
            return self.fail(errors::known_library(right.span, sign));
        }
        let expr = self.arithmetic(right)?;
        let sought = sign.map(|sign| {
            let terms: Vec<&str> = match &right.ungrouped().kind {
                ExprKind::Sum(parts) => parts.iter().map(|(_, x)| self.text(x.span)).collect(),
                _ => vec![self.text(right.span)],
            };
            let list = format!("<{}>", terms.join(", "));
            vec![
                Edit::Replace(sign, "~".to_string()),
                Edit::Replace(right.span, list),
            ]
        });
        let known = self.known_part(right, expr, targets, sought.unwrap_or_default());
        known.map(RightSide::Known)
    }

    /// `sought` are edits that turn the part into candidates or remove it.
    fn known_part(
        &mut self,
        e: &Ast,
        expr: Expr,
        targets: &[(Signal, Span)],
        sought: Vec<Edit>,
    ) -> Option<Expr> {
        if !expr.is_finite() {
            return self.fail(errors::not_finite(e.span));
        }
        match targets.iter().find(|(s, _)| expr.mentions(*s)) {
            Some((s, at)) => {
                let name = self.spelling(*s);
                self.fail(errors::known_with_target(e.span, *at, &name, sought))
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
        let mut end = right.span.start;
        for (sign, part) in parts {
            let whole = Span::new(part.span.file, end, part.span.end);
            end = part.span.end;
            match &part.kind {
                ExprKind::Call(call) if call.name.text == "known" => {
                    match self.known_summand((sign, whole), part, call, targets) {
                        Some(expr) => known.push((expr, part.span)),
                        None => complete = false,
                    }
                }
                ExprKind::Call(call) if self.is_required(call) => {
                    match self.required_summand((sign, whole), part, call) {
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
        // Required terms are added after the differences of the library, which cannot remove them.
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
    fn required_summand(
        &mut self,
        (sign, whole): (Sign, Span),
        e: &Ast,
        call: &Call,
    ) -> Option<LibExpr> {
        if call.args.is_empty() {
            let ours = format!("required({})", self.example_name());
            return self.fail(errors::form(e.span, "required", &ours));
        }
        if sign == Sign::Minus || call.numbers.is_some() || call.power.is_some() {
            let args = call.args.iter().map(|x| self.text(x.span));
            let ours = format!("required({})", args.collect::<Vec<_>>().join(", "));
            let d = errors::required_subtracted(e.span, whole, &self.added(whole, e, &ours));
            return self.fail(d);
        }
        let items = self.items(&call.args)?;
        let set = LibExpr::new(e.span, LibKind::List(items));
        Some(LibExpr::new(e.span, LibKind::Required(Box::new(set))))
    }

    /// A summand, with a plus unless it comes first.
    fn added(&self, whole: Span, e: &Ast, ours: &str) -> String {
        match whole.start == e.span.start {
            true => ours.to_string(),
            false => format!(" + {ours}"),
        }
    }

    /// `whole` is the summand with its sign.
    fn known_summand(
        &mut self,
        (sign, whole): (Sign, Span),
        e: &Ast,
        call: &Call,
        targets: &[(Signal, Span)],
    ) -> Option<Expr> {
        let [arg] = call.args.as_slice() else {
            let given = call.args.first().map(|x| self.text(x.span));
            let ours = format!("known({})", given.unwrap_or(self.example_name()));
            return self.fail(errors::form(e.span, "known", &ours));
        };
        if sign == Sign::Minus || call.numbers.is_some() || call.power.is_some() {
            let x = self.text(arg.span);
            let ours = match (sign, &arg.kind) {
                (Sign::Plus, _) => format!("known({x})"),
                (Sign::Minus, ExprKind::Sum(_)) => format!("known(-({x}))"),
                (Sign::Minus, _) => format!("known(-{x})"),
            };
            let d = errors::known_subtracted(e.span, whole, &ours, &self.added(whole, e, &ours));
            return self.fail(d);
        }
        let expr = self.arithmetic(arg)?;
        self.known_part(arg, expr, targets, vec![Edit::Remove(e.span)])
    }
}

/// A statement without comments and line breaks.
fn one_line(text: &str) -> String {
    let lines = text.lines().map(|l| l.split('#').next().unwrap_or(""));
    let words: Vec<&str> = lines.flat_map(str::split_whitespace).collect();
    words.join(" ")
}
