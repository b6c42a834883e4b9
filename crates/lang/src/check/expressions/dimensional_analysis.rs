//! Dimensional analysis of the model's text: sums of different units, functions of arguments with units.
//!
//! In: a model without errors. Out: an error for each sum whose parts have different units. A number may carry any unit, so a product
//! with a number has an unknown one; a sum with a name of unknown unit is not checked. Works on the text and not on normal forms,
//! where `exp(-t/1)` would have lost its number.

use std::collections::BTreeMap;

use crate::ast::{Call, Expr as Ast, ExprKind, Side, Sign, StatementKind};
use crate::check::checker::Checker;
use crate::check::errors::{self, SumContext, Summand};
use crate::check::expressions::function_calls::in_call;
use crate::check::scope::Value;
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::term::{Func, UnitRule, VarId};
use crate::thresholds::MESSAGES;
use crate::units;
use crate::units::{Commensurability, Unit};

/// What is known about the unit of an expression.
#[derive(Clone, Debug)]
enum InferredUnit {
    /// It contains a number, which may carry any unit.
    Any,
    /// It contains a name without a unit.
    Unknown,
    Is(Unit),
}

impl Checker<'_> {
    /// Checks every sum and every argument of the model, if it declares any unit.
    pub fn units(&mut self) {
        let declared = self.scope.vars.iter().any(|v| v.unit.is_some());
        if !declared || !self.file.broken.is_empty() || self.found.iter().any(Diagnostic::is_error)
        {
            return;
        }
        let mut pass = Pass {
            checker: self,
            lets: BTreeMap::new(),
            arguments: Vec::new(),
            found: Vec::new(),
        };
        for s in pass.checker.statements() {
            match &s.kind {
                StatementKind::Let { body, .. } => pass.library(body),
                StatementKind::Equation {
                    known: true, right, ..
                } => {
                    pass.measure(right);
                }
                StatementKind::Equation { right, .. } => pass.library(right),
                StatementKind::Reset {
                    left, right, jumps, ..
                } => {
                    let jumps = jumps.iter().map(|(name, to)| (name, to));
                    for (a, b) in jumps.chain([(left, right)]) {
                        pass.alike(&[(false, a), (false, b)], SumContext::Comparison);
                    }
                }
                _ => {}
            }
        }
        let found = pass.found;
        self.found.extend(found);
    }
}

struct Pass<'c, 'f> {
    checker: &'c Checker<'f>,
    /// Units of `let`s by name, each computed once.
    lets: BTreeMap<&'f str, InferredUnit>,
    /// Units of the arguments of the functions being measured, innermost last, with their values if they are numbers.
    arguments: Vec<BTreeMap<&'f str, (InferredUnit, Option<f64>)>>,
    found: Vec<Diagnostic>,
}

impl<'f> Pass<'_, 'f> {
    fn say(&mut self, d: Diagnostic) {
        if self.found.len() < MESSAGES.unit_faults && !self.found.contains(&d) {
            self.found.push(d);
        }
    }

    /// Sets of terms. Summands of a union may have different units; arithmetic begins in lists and arguments.
    fn library(&mut self, e: &'f Ast) {
        match &e.kind {
            ExprKind::Group(x) | ExprKind::Negate(x) | ExprKind::Power(x, _) => self.library(x),
            ExprKind::Sum(parts) => parts.iter().for_each(|(_, x)| self.library(x)),
            ExprKind::Product(parts) => parts.iter().for_each(|(_, x)| self.library(x)),
            ExprKind::List(items) => items.iter().for_each(|x| self.item(x)),
            ExprKind::Call(call) if call.name.text == "required" => {
                call.args.iter().for_each(|x| self.item(x));
            }
            ExprKind::Call(call) if self.checker.is_library_function(&call.name.text) => {
                self.own_call(e, call);
            }
            ExprKind::Call(call) => match self.checker.generator_named(&call.name.text) {
                Some(g) => {
                    for x in &call.args {
                        if g.of_angles && !self.checker.is_library(x) {
                            self.pure(g.name, x, None);
                        } else {
                            self.item(x);
                        }
                    }
                }
                None => {
                    self.call(e, call);
                }
            },
            _ => {}
        }
    }

    fn item(&mut self, e: &'f Ast) {
        match &e.kind {
            _ if self.checker.is_library(e) => self.library(e),
            ExprKind::Range(..) => {}
            ExprKind::Sum(parts) => {
                self.alike(&signed(parts), SumContext::Item);
            }
            _ => {
                self.measure(e);
            }
        }
    }

    fn measure(&mut self, e: &'f Ast) -> InferredUnit {
        match &e.kind {
            ExprKind::Name(text) => self.name(text),
            ExprKind::Negate(x) | ExprKind::Group(x) => self.measure(x),
            ExprKind::Sum(parts) => self.alike(&signed(parts), SumContext::Sum),
            ExprKind::Product(parts) => self.product(parts),
            ExprKind::Power(base, exponent) => {
                let base = self.measure(base);
                let p = self.number(exponent);
                p.map_or(InferredUnit::Unknown, |p| base.power(p))
            }
            ExprKind::Call(call) => self.call(e, call),
            _ => InferredUnit::Any,
        }
    }

    fn name(&mut self, text: &'f str) -> InferredUnit {
        if let Some((measure, _)) = self.arguments.last().and_then(|a| a.get(text)) {
            return measure.clone();
        }
        if let Some(s) = self.checker.scope.signal(text) {
            let of = |id: VarId| self.checker.scope.var(id)?.unit.as_ref();
            let unit = of(s.var)
                .zip(of(VarId::TIME))
                .and_then(|(var, time)| units::derivative(var, time, s.der));
            return unit.map_or(InferredUnit::Unknown, InferredUnit::Is);
        }
        if let Some(known) = self.lets.get(text) {
            return known.clone();
        }
        let value = self.checker.scope.lets.get(text).map(|l| &l.value);
        if !matches!(value, Some(Value::Expr { .. })) {
            return InferredUnit::Any;
        }
        let body = self.checker.statements().find_map(|s| match &s.kind {
            StatementKind::Let { name, body } if name.text == text => Some(body),
            _ => None,
        });
        let Some(body) = body else {
            return InferredUnit::Any;
        };
        let found = self.measure(body);
        self.lets.insert(text, found.clone());
        found
    }

    fn product(&mut self, parts: &'f [(Side, Ast)]) -> InferredUnit {
        let mut out = InferredUnit::Is(Unit::one());
        for (side, part) in parts {
            let factor = self.measure(part);
            let factor = match side {
                Side::Above => factor,
                Side::Below => factor.power(-1.0),
            };
            out = match (out, factor) {
                (InferredUnit::Unknown, _) | (_, InferredUnit::Unknown) => InferredUnit::Unknown,
                (InferredUnit::Any, _) | (_, InferredUnit::Any) => InferredUnit::Any,
                (InferredUnit::Is(a), InferredUnit::Is(b)) => {
                    a.times(&b).map_or(InferredUnit::Unknown, InferredUnit::Is)
                }
            };
        }
        out
    }

    /// A sum, or arguments that are compared: all must have one unit.
    fn alike(&mut self, parts: &[(bool, &'f Ast)], joint: SumContext) -> InferredUnit {
        let measured: Vec<InferredUnit> = parts.iter().map(|(_, x)| self.measure(x)).collect();
        if measured.iter().any(|m| matches!(m, InferredUnit::Unknown)) {
            return InferredUnit::Unknown;
        }
        let with_units = parts.iter().zip(&measured).filter_map(|(part, m)| match m {
            InferredUnit::Is(unit) => Some((part, unit)),
            _ => None,
        });
        let mut with_units = with_units.map(|((subtracted, x), unit)| Summand {
            at: x.span,
            text: self.checker.text(x.span),
            unit,
            subtracted: *subtracted,
            sum: matches!(x.kind, ExprKind::Sum(_)),
        });
        let Some(first) = with_units.next() else {
            return InferredUnit::Any;
        };
        let odd =
            with_units.find(|s| first.unit.commensurability(s.unit) != Commensurability::Same);
        let fault = odd.map(|second| errors::unit_sum(&first, &second, joint));
        let unit = first.unit.clone();
        if let Some(d) = fault {
            self.say(d);
            return InferredUnit::Unknown;
        }
        InferredUnit::Is(unit)
    }

    /// The unit of a call of one of the model's own functions.
    fn own_call(&mut self, e: &'f Ast, call: &'f Call) -> InferredUnit {
        let Some(f) = self.checker.functions.get(&call.name.text).cloned() else {
            return InferredUnit::Any;
        };
        let mut arguments = BTreeMap::new();
        for (param, x) in f.params.iter().zip(&call.args) {
            arguments.insert(param.text.as_str(), (self.measure(x), self.number(x)));
        }
        let before = self.found.len();
        self.arguments.push(arguments);
        let value = match f.library {
            true => {
                self.library(f.body);
                InferredUnit::Any
            }
            false => self.measure(f.body),
        };
        self.arguments.pop();
        let inside = self.found.split_off(before);
        self.found
            .extend(inside.into_iter().map(|d| in_call(d, e.span)));
        match call.power {
            Some((p, _)) => value.power(p),
            None => value,
        }
    }

    fn call(&mut self, e: &'f Ast, call: &'f Call) -> InferredUnit {
        if self.checker.is_own_function(&call.name.text) {
            return self.own_call(e, call);
        }
        if matches!(call.name.text.as_str(), "next" | "lag" | "known") {
            return match call.args.first() {
                Some(x) => self.measure(x),
                None => InferredUnit::Any,
            };
        }
        let Some(f) = Func::named(&call.name.text) else {
            return InferredUnit::Any;
        };
        let value = match f.units {
            UnitRule::Pure => {
                let head = call.power.map_or(call.name.span, |(_, at)| at);
                for x in &call.args {
                    let bare = Span::new(x.span.file, head.end, x.span.end);
                    self.pure(f.name, x, call.juxtaposed.then_some(bare));
                }
                InferredUnit::Is(Unit::one())
            }
            UnitRule::Lost => {
                call.args.iter().for_each(|x| {
                    self.measure(x);
                });
                InferredUnit::Is(Unit::one())
            }
            UnitRule::Kept | UnitRule::Root => {
                let args: Vec<(bool, &Ast)> = call.args.iter().map(|x| (false, x)).collect();
                let value = self.alike(&args, SumContext::Comparison);
                if f.units == UnitRule::Root {
                    value.power(0.5)
                } else {
                    value
                }
            }
        };
        match call.power {
            Some((p, _)) => value.power(p),
            None => value,
        }
    }

    /// Checks an argument that must be a pure number or an angle in rad. If it has no parentheses, `bare` is its place, from right after
    /// the function.
    fn pure(&mut self, function: &str, e: &'f Ast, bare: Option<Span>) {
        let InferredUnit::Is(unit) = self.measure(e) else {
            return;
        };
        if unit.is_pure_number() {
            return;
        }
        let argument = Summand {
            at: e.span,
            text: self.checker.text(e.span),
            unit: &unit,
            subtracted: false,
            sum: matches!(e.kind, ExprKind::Sum(_)),
        };
        let time = self.checker.scope.var(VarId::TIME);
        let time = time.and_then(|v| v.unit.as_ref()) == Some(&unit);
        self.say(errors::unit_argument(function, &argument, bare, time));
    }

    /// The value of a constant exponent.
    fn number(&self, e: &Ast) -> Option<f64> {
        match &e.kind {
            ExprKind::Number(x) => Some(*x),
            ExprKind::Group(x) => self.number(x),
            ExprKind::Negate(x) => Some(-self.number(x)?),
            ExprKind::Name(text) => {
                if let Some((_, value)) = self.arguments.last().and_then(|a| a.get(text.as_str())) {
                    return *value;
                }
                match self.checker.scope.lets.get(text)?.value {
                    Value::Number(x) => Some(x),
                    _ => None,
                }
            }
            ExprKind::Product(parts) => parts.iter().try_fold(1.0, |out, (side, x)| {
                let x = self.number(x)?;
                Some(if *side == Side::Above {
                    out * x
                } else {
                    out / x
                })
            }),
            _ => None,
        }
    }
}

/// The parts of a sum, and whether each is subtracted.
fn signed(parts: &[(Sign, Ast)]) -> Vec<(bool, &Ast)> {
    parts
        .iter()
        .map(|(sign, x)| (*sign == Sign::Minus, x))
        .collect()
}

impl InferredUnit {
    fn power(self, p: f64) -> InferredUnit {
        match self {
            InferredUnit::Is(unit) => unit
                .power(p)
                .map_or(InferredUnit::Unknown, InferredUnit::Is),
            other => other,
        }
    }
}
