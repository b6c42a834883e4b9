//! Arithmetic on numbers and signals, in arguments, lists and known parts: ast → [`Expr`].
//!
//! In: an expression. Out: its normal form, or `None` after reporting an error. Refuses libraries.

use crate::ast::{Call, Expr as Ast, ExprKind, Ident, Side, Sign};
use crate::check::checker::{Checker, every};
use crate::check::errors;
use crate::check::own_functions::Argument;
use crate::check::scope::Value;
use crate::model::VarKind;
use crate::parse::ambiguous_argument;
use crate::parse::foreign_spellings::foreign;
use crate::term::{Expr, Func, Signal};
use crate::thresholds::MODEL;

impl Checker<'_> {
    /// The normal form of an arithmetic expression.
    pub fn arithmetic(&mut self, e: &Ast) -> Option<Expr> {
        match &e.kind {
            ExprKind::Number(x) => Some(Expr::number(*x)),
            ExprKind::Share(x) => self.fail(errors::share_elsewhere(e.span, *x)),
            ExprKind::Text(text) => self.text_in_model(e, text),
            ExprKind::Name(text) => self.name(e, text),
            ExprKind::Negate(x) => Some(self.arithmetic(x)?.scale(-1.0)),
            ExprKind::Group(x) => self.arithmetic(x),
            ExprKind::Sum(parts) => self.sum(parts),
            ExprKind::Product(parts) => self.product(e, parts),
            ExprKind::Power(base, exponent) if self.is_eulers_number(base) => {
                let ours = format!("exp({})", self.text(exponent.ungrouped().span));
                self.fail(foreign(e.span, self.text(e.span), &ours))
            }
            ExprKind::Power(base, exponent) => {
                self.one_argument(e, base, exponent)?;
                let (b, p) = (self.arithmetic(base), self.raised_to(e, base, exponent));
                let (b, p) = (b?, p?);
                match p.as_number() {
                    Some(p) => self.powered(e, b, p),
                    None => b.raised_to(p),
                }
            }
            ExprKind::List(_) => self.fail(errors::library_inside(e.span, "a list")),
            ExprKind::Range(..) => self.fail(errors::range_inside(e.span)),
            ExprKind::Call(call) => self.call(e, call),
            ExprKind::Indexed(name, index) => self.stray_index(e, name, index),
        }
    }

    /// `"x"` outside the data block.
    pub fn text_in_model<T>(&mut self, e: &Ast, text: &str) -> Option<T> {
        let known = self.scope.signal(text).is_some();
        self.fail(errors::text_in_model(e.span, text, known))
    }

    /// `x[i]` outside a family.
    pub fn stray_index<T>(&mut self, e: &Ast, name: &Ident, index: &Ast) -> Option<T> {
        let example = self.example_indexed_name(&name.text, index);
        self.fail(errors::index_without_range(e.span, &example))
    }

    /// The `e` of `e^x`, unless a signal has that name.
    fn is_eulers_number(&self, e: &Ast) -> bool {
        let is_e = |name: &&str| matches!(*name, "e" | "ℯ");
        let free = |name| !self.is_declared(name) && !self.scope.may_be_declared(name);
        e.as_name().filter(is_e).is_some_and(free)
    }

    fn name(&mut self, e: &Ast, text: &str) -> Option<Expr> {
        if let Some(argument) = self.argument(text) {
            return match argument {
                Argument::Value(value) => Some(value.clone()),
                _ => self.text_in_model(e, text),
            };
        }
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
                self.fail(errors::library_by_name_inside(e.span, text, definition))
            }
            Some((Value::Wrong, _)) => None,
            None => self.unknown_name(e.span, text),
        }
    }

    fn sum(&mut self, parts: &[(Sign, Ast)]) -> Option<Expr> {
        let terms = every(parts.iter().map(|(sign, x)| {
            let x = self.arithmetic(x)?;
            Some(match sign {
                Sign::Minus => x.scale(-1.0),
                Sign::Plus => x,
            })
        }))?;
        Some(terms.into_iter().sum())
    }

    fn product(&mut self, e: &Ast, parts: &[(Side, Ast)]) -> Option<Expr> {
        if parts.len() > MODEL.factors {
            return self.fail(errors::too_many_factors(e.span, parts.len(), MODEL.factors));
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

    /// `a / b`. Two numbers are divided directly, so that 9.8/3 is rounded once.
    pub fn quotient(&mut self, divisor: &Ast, a: Expr, b: Expr) -> Option<Expr> {
        match (a.as_number(), b.as_number()) {
            (_, Some(0.0)) => self.fail(errors::division_by_zero(divisor.span)),
            (Some(x), Some(y)) => Some(Expr::number(x / y)),
            _ => Some(a / b),
        }
    }

    pub fn powered(&mut self, e: &Ast, base: Expr, p: f64) -> Option<Expr> {
        let result = base.pow(p);
        if result.is_finite() {
            return Some(result);
        }
        self.fail(errors::not_finite(e.span))
    }

    /// Refuses `sat x^2` for the model's own functions, as the parser does for built-in ones.
    pub fn one_argument(&mut self, e: &Ast, base: &Ast, exponent: &Ast) -> Option<()> {
        let ExprKind::Call(call) = &base.kind else {
            return Some(());
        };
        if !call.juxtaposed || !self.is_own_function(&call.name.text) {
            return Some(());
        }
        let (f, p) = (&call.name.text, self.text(exponent.span));
        let x = call.args.first().map_or("x", |x| self.text(x.span));
        let readings = [format!("{f}({x})^{p}"), format!("{f}({x}^{p})")];
        self.fail(ambiguous_argument(e.span, f, &readings))
    }

    /// The exponent of a power: a number, or an expression of unknown constants alone.
    fn raised_to(&mut self, whole: &Ast, base: &Ast, e: &Ast) -> Option<Expr> {
        let value = self.arithmetic(e)?;
        let mut constant = true;
        value.for_each_signal(&mut |s| {
            let kind = self.scope.var(s.var).map(|v| v.kind);
            constant &= kind == Some(VarKind::Unknown);
        });
        match constant {
            true => Some(value),
            false => self.variable_exponent(whole, base, e),
        }
    }

    fn variable_exponent<T>(&mut self, whole: &Ast, base: &Ast, e: &Ast) -> Option<T> {
        let (b, p) = (self.shown(base.ungrouped().span), self.shown(e.span));
        let ours = format!("exp({p}*log({b}))");
        self.fail(errors::exponent_not_a_number(e.span, whole.span, &ours))
    }

    /// The exponent of a power, which must be constant.
    pub fn exponent(&mut self, whole: &Ast, base: &Ast, e: &Ast) -> Option<f64> {
        let value = self.arithmetic(e)?;
        match value.as_number() {
            Some(p) => Some(p),
            None => self.variable_exponent(whole, base, e),
        }
    }

    /// A constant, known without data; `what` names its purpose in the error.
    pub fn constant(&mut self, e: &Ast, what: &str) -> Option<f64> {
        let value = self.arithmetic(e)?;
        match value.as_number() {
            Some(x) if x.is_finite() => Some(x),
            Some(_) => self.fail(errors::not_finite(e.span)),
            None => self.fail(errors::not_constant(e.span, what)),
        }
    }

    fn call(&mut self, e: &Ast, call: &Call) -> Option<Expr> {
        let name = call.name.text.as_str();
        if let Some(value) = self.own_call(e, call) {
            return value;
        }
        match (name, self.function_named(name)) {
            ("next", _) => self.next(e, call).map(Expr::signal),
            ("lag", _) => self.lag(e, call).map(Expr::signal),
            (_, Some(f)) => self.function(e, call, f),
            (_, None) => self.not_a_function(e, call),
        }
    }

    fn function(&mut self, e: &Ast, call: &Call, f: Func) -> Option<Expr> {
        if call.numbers.is_some() {
            let ours = self.call_without_numbers(call, f.arity.1);
            return self.fail(errors::numbers_of_function(e.span, f.name, &ours));
        }
        if let Some((p, at)) = call.power
            && p < 0.0
        {
            let arg = call.args.first().map_or("x", |x| self.shown(x.span));
            let d = errors::inverse_or_reciprocal(at, e.span, f.name, arg);
            return self.fail(d);
        }
        let args = every(call.args.iter().map(|arg| self.arithmetic(arg)))?;
        let (least, most) = f.arity;
        if args.len() < least || args.len() > most {
            let ours = self.call_of(call, f.arity, self.example_name());
            let found = (f.name, args.len());
            return self.fail(errors::arity(e.span, found, f.arity, &ours));
        }
        let inner = Expr::call(f, args);
        if inner.as_number().is_some_and(|x| !x.is_finite()) {
            return self.fail(errors::outside_domain(e.span, f.name, f.domain));
        }
        match call.power {
            Some((p, _)) => self.powered(e, inner, p),
            None => Some(inner),
        }
    }

    /// `next(x)`
    pub fn next(&mut self, e: &Ast, call: &Call) -> Option<Signal> {
        match call.args.as_slice() {
            [one] if call.numbers.is_none() && call.power.is_none() => self.shifted(e, one, 1),
            given => {
                let x = given
                    .first()
                    .map_or(self.example_name(), |x| self.shown(x.span));
                let ours = format!("next({x})");
                self.fail(errors::form(e.span, "next", &ours))
            }
        }
    }

    /// `lag(u, k)`
    fn lag(&mut self, e: &Ast, call: &Call) -> Option<Signal> {
        let plain = call.numbers.is_none() && call.power.is_none();
        let ([signal, back], true) = (call.args.as_slice(), plain) else {
            let numbers = call.numbers.iter().flatten();
            let mut given = call.args.iter().chain(numbers).map(|x| self.shown(x.span));
            let x = given.next().unwrap_or(self.example_name());
            let ours = format!("lag({x}, {})", given.next().unwrap_or("1"));
            return self.fail(errors::form(e.span, "lag", &ours));
        };
        let k = self.constant(back, "the lag");
        let k = k?;
        if k.fract() != 0.0 || !(0.0..=MODEL.lag).contains(&k) {
            let name = self.shown(signal.span);
            return self.fail(errors::lag(back.span, k, name));
        }
        self.shifted(e, signal, -(k as i32))
    }

    /// `whole` is the call, `e` what it shifts.
    fn shifted(&mut self, whole: &Ast, e: &Ast, by: i32) -> Option<Signal> {
        let inner = e.ungrouped();
        let Some(text) = inner.as_name() else {
            let ours = self.shifted_inside(whole, e, by);
            return self.fail(errors::shift_of_expression(e.span, ours));
        };
        if let Some(argument) = self.argument(text) {
            let Some(s) = argument.as_signal() else {
                return self.fail(errors::shift_of_expression(e.span, None));
            };
            return match s.der == 0 && s.shift == 0 {
                true => Some(Signal::shifted(s.var, by)),
                false => self.fail(errors::shift_of_expression(e.span, None)),
            };
        }
        match self.scope.use_signal(text) {
            Some(s) if s.der == 0 => Some(Signal::shifted(s.var, by)),
            Some(_) => self.fail(errors::shift_of_expression(e.span, None)),
            None if self.scope.lets.contains_key(text) => {
                self.fail(errors::shift_of_expression(e.span, None))
            }
            None => self.unknown_name(inner.span, text),
        }
    }
}
