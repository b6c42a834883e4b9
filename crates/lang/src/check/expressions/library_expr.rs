//! Expressions over sets of terms: ast → [`LibExpr`], still factored.
//!
//! In: an expression where a library may be. Out: a set expression with names resolved, or `None` after reporting an error. Outside
//! `< >` and arguments, `+ - * / ^` are operations on sets; inside they are arithmetic. Expands nothing: what a difference removes and
//! how many terms a divisor has is checked by the library.

use crate::ast::{Call, Expr as Ast, ExprKind, Side, Sign};
use crate::check::checker::{Checker, every};
use crate::check::errors;
use crate::check::expressions::set_algebra::{number_minus_term, sum_of_numbers, union};
use crate::check::scope::Value;
use crate::check::suggestions::numbers_example;
use crate::model::{LibExpr, LibKind, NumberArg};
use crate::source::Span;
use crate::term::{Expr, Signal};
use crate::thresholds::MODEL;

const LIST: &str = "put the terms in a list: `<a, b, c>`";

impl Checker<'_> {
    /// True if the expression contains a list, a generator or a named library.
    pub fn is_library(&self, e: &Ast) -> bool {
        match &e.kind {
            ExprKind::Name(text) => {
                let value = self.scope.lets.get(text).map(|l| &l.value);
                self.scope.signal(text).is_none() && matches!(value, Some(Value::Library(_)))
            }
            ExprKind::Power(x, _) => self.is_library(x),
            ExprKind::Range(..) => false,
            ExprKind::List(_) => true,
            ExprKind::Call(call) => self.makes_library(call),
            _ => e.children().into_iter().any(|x| self.is_library(x)),
        }
    }

    /// A generator, or a function whose body is a library.
    fn makes_library(&self, call: &Call) -> bool {
        let name = call.name.text.as_str();
        self.generator_named(name).is_some() || self.is_library_function(name)
    }

    /// An expression as a set of terms.
    pub fn library(&mut self, e: &Ast) -> Option<LibExpr> {
        match &e.kind {
            ExprKind::Name(text) => match self.named(e, text) {
                Some(found) => found,
                None => self.term(e),
            },
            ExprKind::Number(_) => self.term(e),
            ExprKind::Group(x) => self.library(x),
            ExprKind::Negate(x) => self.negated(e, x),
            ExprKind::Sum(parts) => {
                let parts: Vec<(Sign, &Ast)> = parts.iter().map(|(s, x)| (*s, x)).collect();
                self.set_sum(&parts)
            }
            ExprKind::Product(parts) => self.set_product(e, parts),
            ExprKind::Power(base, exponent) => self.set_power(e, base, exponent),
            ExprKind::List(items) => {
                let items = self.items(items)?;
                Some(LibExpr::new(e.span, LibKind::List(items)))
            }
            ExprKind::Call(call) if self.generator_named(&call.name.text).is_some() => {
                self.generator(e, call)
            }
            ExprKind::Call(call) if self.is_library_function(&call.name.text) => {
                self.own_library(e, call)
            }
            ExprKind::Call(_) | ExprKind::Text(_) | ExprKind::Share(_) | ExprKind::Indexed(..) => {
                self.term(e)
            }
            ExprKind::Range(..) => self.fail(errors::range_inside(e.span)),
        }
    }

    /// A named library; the outer `None` if the name is not one, the inner after an error.
    fn named(&mut self, e: &Ast, text: &str) -> Option<Option<LibExpr>> {
        if self.scope.signal(text).is_some() {
            return None;
        }
        let body = match &self.scope.lets.get(text)?.value {
            Value::Library(body) => body.clone(),
            Value::Expr {
                library: Ok(body), ..
            } if !matches!(body.kind, LibKind::Term(_)) => body.clone(),
            Value::Expr {
                library: Err(why), ..
            } => {
                let why = why.clone();
                self.found.extend(why);
                return Some(None);
            }
            _ => return None,
        };
        self.scope.used_lets.insert(text.to_string());
        let (name, body) = (text.to_string(), Box::new(body));
        Some(Some(LibExpr::new(e.span, LibKind::Named { name, body })))
    }

    /// A single term, by arithmetic.
    fn term(&mut self, e: &Ast) -> Option<LibExpr> {
        let expr = self.arithmetic(e)?;
        self.checked_term(e.span, expr)
    }

    fn checked_term(&mut self, span: Span, expr: Expr) -> Option<LibExpr> {
        if !expr.is_finite() {
            return self.fail(errors::not_finite(span));
        }
        if expr.terms().len() == 0 {
            return self.fail(errors::zero_term(span));
        }
        Some(LibExpr::new(span, LibKind::Term(expr)))
    }

    fn negated(&mut self, e: &Ast, x: &Ast) -> Option<LibExpr> {
        let inner = self.library(x)?;
        let kind = match inner.kind {
            LibKind::Term(expr) => LibKind::Term(expr.scale(-1.0)),
            _ => {
                let minus = LibExpr::new(e.span, LibKind::Term(Expr::number(-1.0)));
                LibKind::Product(Box::new(minus), Box::new(inner))
            }
        };
        Some(LibExpr::new(e.span, kind))
    }

    /// `A + B - C`. Unions are balanced trees, so that a long chain stays shallow.
    pub fn set_sum(&mut self, parts: &[(Sign, &Ast)]) -> Option<LibExpr> {
        let sets = every(
            parts
                .iter()
                .map(|(sign, x)| Some((*sign, self.library(x)?))),
        )?;
        if let Some(number) = sum_of_numbers(&sets) {
            return self.checked_term(number.span, number.expr);
        }
        let differences = sets.iter().filter(|(s, _)| *s == Sign::Minus).count();
        if let (true, Some((_, last))) = (differences > MODEL.chain, sets.last()) {
            return self.fail(errors::chain_too_long(last.span, MODEL.chain, LIST));
        }
        if let Some(span) = number_minus_term(&sets) {
            return self.fail(errors::arithmetic_outside_list(span, self.text(span)));
        }
        let mut pending: Vec<LibExpr> = Vec::with_capacity(sets.len());
        for (sign, set) in sets {
            if sign == Sign::Plus {
                pending.push(set);
                continue;
            }
            let left = union(std::mem::take(&mut pending))?;
            let span = left.span.to(set.span);
            let kind = LibKind::Difference(Box::new(left), Box::new(set));
            pending.push(LibExpr::new(span, kind));
        }
        union(pending)
    }

    /// `A * B / C`; adjacent single terms are multiplied at once.
    fn set_product(&mut self, e: &Ast, parts: &[(Side, Ast)]) -> Option<LibExpr> {
        let sets = every(parts.iter().map(|(_, x)| self.library(x)))?;
        let whole = sets
            .iter()
            .filter(|s| !matches!(s.kind, LibKind::Term(_)))
            .count();
        if whole > MODEL.chain || sets.len() > MODEL.chain_terms {
            return self.fail(errors::chain_too_long(e.span, MODEL.chain, LIST));
        }
        let mut out: Option<LibExpr> = None;
        for (set, (side, ast)) in sets.into_iter().zip(parts) {
            out = Some(match out {
                None => set,
                Some(left) => self.join(left, *side, set, ast)?,
            });
        }
        out
    }

    fn join(&mut self, left: LibExpr, side: Side, right: LibExpr, ast: &Ast) -> Option<LibExpr> {
        let span = left.span.to(right.span);
        let boxed = |span, kind| Box::new(LibExpr::new(span, kind));
        let kind = match (left.kind, side, right.kind) {
            (LibKind::Term(a), Side::Above, LibKind::Term(b)) => LibKind::Term(a * b),
            (LibKind::Term(a), Side::Below, LibKind::Term(b)) => {
                LibKind::Term(self.quotient(ast, a, b)?)
            }
            (a, Side::Above, b) => LibKind::Product(boxed(left.span, a), boxed(right.span, b)),
            (a, Side::Below, b) => LibKind::Quotient(boxed(left.span, a), boxed(right.span, b)),
        };
        Some(LibExpr::new(span, kind))
    }

    fn set_power(&mut self, e: &Ast, base: &Ast, exponent: &Ast) -> Option<LibExpr> {
        self.one_argument(e, base, exponent)?;
        let (base_set, p) = (self.library(base), self.exponent(e, base, exponent));
        let (set, p) = (base_set?, p?);
        if let LibKind::Term(expr) = set.kind {
            let power = self.powered(e, expr, p)?;
            return self.checked_term(e.span, power);
        }
        Some(LibExpr::new(e.span, LibKind::Power(Box::new(set), p)))
    }

    /// The items of a list or the arguments of a generator: terms, or whole libraries.
    pub fn items(&mut self, items: &[Ast]) -> Option<Vec<LibExpr>> {
        let sets = every(items.iter().map(|item| self.item(item)))?;
        Some(sets.into_iter().flatten().collect())
    }

    fn item(&mut self, e: &Ast) -> Option<Vec<LibExpr>> {
        if let ExprKind::Range(from, to) = &e.kind {
            return self.signal_range(e.span, from, to);
        }
        let whole = match &e.ungrouped().kind {
            ExprKind::List(_) => true,
            ExprKind::Call(call) => self.makes_library(call),
            ExprKind::Name(_) => self.is_library(e.ungrouped()),
            _ => false,
        };
        let set = if whole { self.library(e) } else { self.term(e) };
        Some(vec![set?])
    }

    /// `x1..x12`
    fn signal_range(&mut self, span: Span, from: &Ast, to: &Ast) -> Option<Vec<LibExpr>> {
        let names = self.expand_range(span, from, to)?;
        let mut out = Vec::with_capacity(names.len());
        for name in names {
            let signal: Signal = match self.scope.use_signal(&name) {
                Some(s) => s,
                None => return self.unknown_name(span, &name),
            };
            out.push(LibExpr::new(span, LibKind::Term(Expr::signal(signal))));
        }
        Some(out)
    }

    /// The names of `x1..x12`: one stem, ascending numbers.
    pub fn expand_range(&mut self, span: Span, from: &Ast, to: &Ast) -> Option<Vec<String>> {
        let ends = from
            .as_name()
            .and_then(numbered)
            .zip(to.as_name().and_then(numbered));
        let (left, right) = (self.text(from.span), self.text(to.span));
        let ends = ends.filter(|((a, _), (b, _))| a == b);
        let numbers = ends.and_then(|((_, a), (_, b))| a.parse().ok().zip(b.parse().ok()));
        let (Some(((stem, first), _)), Some((a, b))) = (ends, numbers) else {
            let listed = format!("{left}, {right}");
            return self.fail(errors::range_of_names(span, &listed));
        };
        let (a, b): (usize, usize) = (a, b);
        if a > b || b - a >= MODEL.range {
            let turned = format!("{right}..{left}");
            let d = errors::range_bounds(span, (a, b), &turned, MODEL.range);
            return self.fail(d);
        }
        self.afford(span, b - a)?;
        let width = if first.starts_with('0') {
            first.len()
        } else {
            1
        };
        Some((a..=b).map(|i| format!("{stem}{i:0width$}")).collect())
    }

    fn generator(&mut self, e: &Ast, call: &Call) -> Option<LibExpr> {
        let name = &call.name;
        let known = self.generator_named(&name.text);
        let usage = known.map_or("", |g| g.usage);
        if call.juxtaposed || call.power.is_some() {
            let example = known.map(|g| self.generator_example(g, Some(call)));
            let example = example.unwrap_or_default();
            let d = errors::generator_without_arguments(e.span, &name.text, &example);
            return self.fail(d);
        }
        let args = self.items(&call.args);
        if call.numbers.is_none() && usage.contains(';') {
            let last = call.args.last().map(|a| {
                (
                    a.span,
                    matches!(a.kind, ExprKind::Number(_) | ExprKind::Range(..)),
                )
            });
            let comma = match call.args.as_slice() {
                [.., a, b] => Some(Span::new(e.span.file, a.span.end, b.span.start)),
                _ => None,
            };
            let usage = (usage, known.map_or("", numbers_example));
            return self.fail(errors::numbers_missing(
                e.span, &name.text, usage, last, comma,
            ));
        }
        let numbers = call.numbers.iter().flatten();
        let numbers = every(numbers.map(|n| self.number_arg(n)));
        let kind = LibKind::Generate {
            name: name.text.clone(),
            name_span: name.span,
            args: args?,
            numbers: numbers?,
        };
        Some(LibExpr::new(e.span, kind))
    }

    /// `2` or `1..3`
    fn number_arg(&mut self, e: &Ast) -> Option<NumberArg> {
        let what = "the number after `;`";
        let (from, to, range) = match &e.kind {
            ExprKind::Range(a, b) => {
                let (a, b) = (self.constant(a, what), self.constant(b, what));
                (a?, b?, true)
            }
            _ => {
                let x = self.constant(e, what)?;
                (x, x, false)
            }
        };
        Some(NumberArg {
            from,
            to,
            range,
            span: e.span,
        })
    }
}

/// `x12` is the stem `x` and the digits `12`.
fn numbered(name: &str) -> Option<(&str, &str)> {
    let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let digits = name.get(stem.len()..)?;
    (!digits.is_empty()).then_some((stem, digits))
}
