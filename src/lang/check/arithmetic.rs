//! Arithmetic on numbers and signals: ast → [`Expr`], in arguments, lists and known parts.
//!
//! In: an expression. Out: its normal form, or nothing after reporting why not. Libraries have no place here.

use super::scope::Value;
use super::{Checker, complain};
use crate::lang::ast::{Call, Expr as Ast, ExprKind, Side, Sign};
use crate::term::{Expr, Func, Signal};

/// Longest product of one statement; the normal form of a product is sorted at each factor.
const MAX_FACTORS: usize = 1_000;
const MAX_LAG: f64 = 1e6;

impl Checker<'_> {
    /// The normal form of an arithmetic expression.
    pub fn arithmetic(&mut self, e: &Ast) -> Option<Expr> {
        match &e.kind {
            ExprKind::Number(x) => Some(Expr::number(*x)),
            ExprKind::Text(text) => self.fail(complain::text_in_model(e.span, text)),
            ExprKind::Name(text) => self.name(e, text),
            ExprKind::Negate(x) => Some(self.arithmetic(x)?.scale(-1.0)),
            ExprKind::Group(x) => self.arithmetic(x),
            ExprKind::Sum(parts) => self.sum(parts),
            ExprKind::Product(parts) => self.product(e, parts),
            ExprKind::Power(base, exponent) => {
                let (b, p) = (self.arithmetic(base), self.exponent(exponent));
                let (b, p) = (b?, p?);
                self.powered(e, b, p)
            }
            ExprKind::List(_) => self.fail(complain::library_inside(e.span, "a list")),
            ExprKind::Range(..) => self.fail(complain::range_inside(e.span)),
            ExprKind::Call(call) => self.call(e, call),
        }
    }

    fn name(&mut self, e: &Ast, text: &str) -> Option<Expr> {
        if let Some(s) = self.scope.use_signal(text) {
            return Some(Expr::signal(s));
        }
        if text == "pi" {
            return Some(Expr::number(std::f64::consts::PI));
        }
        self.scope.used_lets.insert(text.to_string());
        match self.scope.lets.get(text).map(|l| (&l.value, l.span)) {
            Some((Value::Number(x), _)) => Some(Expr::number(*x)),
            Some((Value::Expr { expr, .. }, _)) => Some(expr.clone()),
            Some((Value::Library(_), definition)) => {
                self.fail(complain::library_by_name_inside(e.span, text, definition))
            }
            Some((Value::Wrong, _)) => None,
            None => self.unknown_name(e.span, text),
        }
    }

    fn sum(&mut self, parts: &[(Sign, Ast)]) -> Option<Expr> {
        let terms: Vec<Option<Expr>> = parts
            .iter()
            .map(|(sign, x)| {
                let x = self.arithmetic(x)?;
                Some(if *sign == Sign::Minus {
                    x.scale(-1.0)
                } else {
                    x
                })
            })
            .collect();
        terms.into_iter().sum()
    }

    fn product(&mut self, e: &Ast, parts: &[(Side, Ast)]) -> Option<Expr> {
        if parts.len() > MAX_FACTORS {
            return self.fail(complain::too_many_factors(e.span, parts.len(), MAX_FACTORS));
        }
        let mut out = Some(Expr::number(1.0));
        for (side, part) in parts {
            let factor = self.arithmetic(part);
            let (Some(done), Some(factor)) = (out.take(), factor) else {
                continue;
            };
            out = match side {
                Side::Above => Some(done * factor),
                Side::Below => self.quotient(part, done, factor),
            };
        }
        out
    }

    /// `a / b`; numbers are divided as numbers, so that 9.8/3 is rounded once.
    pub fn quotient(&mut self, divisor: &Ast, a: Expr, b: Expr) -> Option<Expr> {
        match (a.as_number(), b.as_number()) {
            (_, Some(0.0)) => self.fail(complain::division_by_zero(divisor.span)),
            (Some(x), Some(y)) => Some(Expr::number(x / y)),
            _ => Some(a / b),
        }
    }

    pub fn powered(&mut self, e: &Ast, base: Expr, p: f64) -> Option<Expr> {
        let result = base.pow(p);
        if result.is_finite() {
            return Some(result);
        }
        self.fail(complain::not_finite(e.span))
    }

    /// The exponent of a power: a number, whatever arithmetic made it.
    pub fn exponent(&mut self, e: &Ast) -> Option<f64> {
        let value = self.arithmetic(e)?;
        match value.as_number() {
            Some(p) => Some(p),
            None => self.fail(complain::exponent_not_a_number(e.span)),
        }
    }

    /// A number known from the text alone; `what` says for which purpose.
    pub fn constant(&mut self, e: &Ast, what: &str) -> Option<f64> {
        let value = self.arithmetic(e)?;
        match value.as_number() {
            Some(x) if x.is_finite() => Some(x),
            Some(_) => self.fail(complain::not_finite(e.span)),
            None => self.fail(complain::not_constant(e.span, what)),
        }
    }

    fn call(&mut self, e: &Ast, call: &Call) -> Option<Expr> {
        let name = call.name.text.as_str();
        match (name, Func::named(name)) {
            ("next", _) => self.next(e, call).map(Expr::signal),
            ("lag", _) => self.lag(e, call).map(Expr::signal),
            (_, Some(f)) => self.function(e, call, f),
            (_, None) => self.not_a_function(e, call),
        }
    }

    fn function(&mut self, e: &Ast, call: &Call, f: Func) -> Option<Expr> {
        if call.numbers.is_some() {
            return self.fail(complain::numbers_of_function(e.span, f.name));
        }
        if let Some((p, at)) = call.power
            && p < 0.0
        {
            let arg = call.args.first().and_then(Ast::as_name).unwrap_or("…");
            return self.fail(complain::inverse_or_reciprocal(at, f.name, arg));
        }
        let mut args = Vec::with_capacity(call.args.len());
        for arg in &call.args {
            args.push(self.arithmetic(arg));
        }
        let args = args.into_iter().collect::<Option<Vec<Expr>>>()?;
        let (least, most) = f.arity;
        if args.len() < least || args.len() > most {
            return self.fail(complain::arity(e.span, f.name, args.len(), f.arity));
        }
        let inner = Expr::call(f, args);
        if inner.as_number().is_some_and(|x| !x.is_finite()) {
            return self.fail(complain::outside_domain(e.span, f.name, f.domain));
        }
        match call.power {
            Some((p, _)) => self.powered(e, inner, p),
            None => Some(inner),
        }
    }

    /// `next(x)`
    pub fn next(&mut self, e: &Ast, call: &Call) -> Option<Signal> {
        match call.args.as_slice() {
            [one] if call.numbers.is_none() && call.power.is_none() => self.shifted(one, 1),
            _ => self.fail(complain::form(e.span, "next", "next(x)")),
        }
    }

    /// `lag(u, k)`
    fn lag(&mut self, e: &Ast, call: &Call) -> Option<Signal> {
        let [signal, back] = call.args.as_slice() else {
            return self.fail(complain::form(e.span, "lag", "lag(u, 2)"));
        };
        if call.numbers.is_some() || call.power.is_some() {
            return self.fail(complain::form(e.span, "lag", "lag(u, 2)"));
        }
        let k = self.constant(back, "the lag");
        let k = k?;
        if k.fract() != 0.0 || !(0.0..=MAX_LAG).contains(&k) {
            return self.fail(complain::lag(back.span, k));
        }
        self.shifted(signal, -(k as i32))
    }

    fn shifted(&mut self, e: &Ast, by: i32) -> Option<Signal> {
        let inner = e.ungrouped();
        let Some(text) = inner.as_name() else {
            return self.fail(complain::shift_of_expression(e.span));
        };
        match self.scope.use_signal(text) {
            Some(s) if s.der == 0 => Some(Signal::shifted(s.var, by)),
            Some(_) => self.fail(complain::shift_of_expression(e.span)),
            None if self.scope.lets.contains_key(text) => {
                self.fail(complain::shift_of_expression(e.span))
            }
            None => self.unknown_name(inner.span, text),
        }
    }
}
