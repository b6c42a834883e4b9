//! Expressions over sets of terms: ast → [`LibExpr`], still factored.
//!
//! Outside `< >` and arguments, `+ - * / ^` join libraries; inside they are arithmetic. What a difference removes
//! and how many terms a divisor has is seen only when the library is expanded.

use super::scope::Value;
use super::sets::{number_minus_term, sum_of_numbers, union};
use super::{Checker, complain};
use crate::lang::ast::{Call, Expr as Ast, ExprKind, Side, Sign};
use crate::lang::model::{LibExpr, LibKind, NumberArg};
use crate::lang::source::Span;
use crate::term::{Expr, Signal};

/// Differences, quotients and products of whole libraries in one chain: each nests the result one deeper.
const MAX_CHAIN: usize = 200;
const LIST: &str = "put the terms in a list: `<a, b, c>`";
const MAX_RANGE: usize = 10_000;

impl Checker<'_> {
    /// True if the text has a list, a generator or a named library in it.
    pub fn is_library(&self, e: &Ast) -> bool {
        match &e.kind {
            ExprKind::Number(_) | ExprKind::Text(_) => false,
            ExprKind::Name(text) => {
                self.scope.signal(text).is_none()
                    && matches!(
                        self.scope.lets.get(text).map(|l| &l.value),
                        Some(Value::Library(_))
                    )
            }
            ExprKind::Negate(x) | ExprKind::Group(x) => self.is_library(x),
            ExprKind::Power(x, _) => self.is_library(x),
            ExprKind::Range(..) => false,
            ExprKind::Sum(parts) => parts.iter().any(|(_, x)| self.is_library(x)),
            ExprKind::Product(parts) => parts.iter().any(|(_, x)| self.is_library(x)),
            ExprKind::List(_) => true,
            ExprKind::Call(call) => self.vocabulary.generator(&call.name.text).is_some(),
        }
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
                Some(LibExpr {
                    span: e.span,
                    kind: LibKind::List(items),
                })
            }
            ExprKind::Call(call) if self.vocabulary.generator(&call.name.text).is_some() => {
                self.generator(e, call)
            }
            ExprKind::Call(_) | ExprKind::Text(_) => self.term(e),
            ExprKind::Range(..) => self.fail(complain::range_inside(e.span)),
        }
    }

    /// A `let` used by name where a library may stand; outer `None` if it is not one.
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
        Some(Some(LibExpr {
            span: e.span,
            kind: LibKind::Named {
                name: text.to_string(),
                body: Box::new(body),
            },
        }))
    }

    /// A single term, by arithmetic.
    fn term(&mut self, e: &Ast) -> Option<LibExpr> {
        let expr = self.arithmetic(e)?;
        self.checked_term(e.span, expr)
    }

    fn checked_term(&mut self, span: Span, expr: Expr) -> Option<LibExpr> {
        if !expr.is_finite() {
            return self.fail(complain::not_finite(span));
        }
        if expr.terms().len() == 0 {
            return self.fail(complain::zero_term(span));
        }
        Some(LibExpr {
            span,
            kind: LibKind::Term(expr),
        })
    }

    fn negated(&mut self, e: &Ast, x: &Ast) -> Option<LibExpr> {
        let inner = self.library(x)?;
        let span = e.span;
        Some(match inner.kind {
            LibKind::Term(expr) => LibExpr {
                span,
                kind: LibKind::Term(expr.scale(-1.0)),
            },
            kind => {
                let minus = LibExpr {
                    span,
                    kind: LibKind::Term(Expr::number(-1.0)),
                };
                let kind = LibKind::Product(
                    Box::new(minus),
                    Box::new(LibExpr {
                        span: inner.span,
                        kind,
                    }),
                );
                LibExpr { span, kind }
            }
        })
    }

    /// `A + B - C`: unions are joined by halves, so that a long chain stays shallow.
    pub fn set_sum(&mut self, parts: &[(Sign, &Ast)]) -> Option<LibExpr> {
        let sets: Vec<Option<(Sign, LibExpr)>> = parts
            .iter()
            .map(|(sign, x)| Some((*sign, self.library(x)?)))
            .collect();
        let sets = sets.into_iter().collect::<Option<Vec<_>>>()?;
        if let Some(number) = sum_of_numbers(&sets) {
            return self.checked_term(number.span, number.expr);
        }
        let differences = sets.iter().filter(|(s, _)| *s == Sign::Minus).count();
        if let (true, Some((_, last))) = (differences > MAX_CHAIN, sets.last()) {
            return self.fail(complain::chain_too_long(last.span, MAX_CHAIN, LIST));
        }
        if let Some(span) = number_minus_term(&sets) {
            return self.fail(complain::arithmetic_outside_list(span, self.text(span)));
        }
        let mut pending: Vec<LibExpr> = Vec::with_capacity(sets.len());
        for (sign, set) in sets {
            if sign == Sign::Plus {
                pending.push(set);
                continue;
            }
            let left = union(std::mem::take(&mut pending))?;
            pending.push(LibExpr {
                span: left.span.to(set.span),
                kind: LibKind::Difference(Box::new(left), Box::new(set)),
            });
        }
        union(pending)
    }

    /// `A * B / C`; single terms that meet are multiplied at once.
    fn set_product(&mut self, e: &Ast, parts: &[(Side, Ast)]) -> Option<LibExpr> {
        let sets: Vec<Option<LibExpr>> = parts.iter().map(|(_, x)| self.library(x)).collect();
        let sets = sets.into_iter().collect::<Option<Vec<_>>>()?;
        let whole = sets
            .iter()
            .filter(|s| !matches!(s.kind, LibKind::Term(_)))
            .count();
        if whole > MAX_CHAIN || sets.len() > 5 * MAX_CHAIN {
            return self.fail(complain::chain_too_long(e.span, MAX_CHAIN, LIST));
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
        let kind = match (left.kind, side, right.kind) {
            (LibKind::Term(a), Side::Above, LibKind::Term(b)) => LibKind::Term(a * b),
            (LibKind::Term(a), Side::Below, LibKind::Term(b)) => {
                LibKind::Term(self.quotient(ast, a, b)?)
            }
            (a, side, b) => {
                let a = Box::new(LibExpr {
                    span: left.span,
                    kind: a,
                });
                let b = Box::new(LibExpr {
                    span: right.span,
                    kind: b,
                });
                match side {
                    Side::Above => LibKind::Product(a, b),
                    Side::Below => LibKind::Quotient(a, b),
                }
            }
        };
        Some(LibExpr { span, kind })
    }

    fn set_power(&mut self, e: &Ast, base: &Ast, exponent: &Ast) -> Option<LibExpr> {
        let (base_set, p) = (self.library(base), self.exponent(exponent));
        let (set, p) = (base_set?, p?);
        Some(match set.kind {
            LibKind::Term(expr) => {
                let power = self.powered(e, expr, p)?;
                return self.checked_term(e.span, power);
            }
            _ => LibExpr {
                span: e.span,
                kind: LibKind::Power(Box::new(set), p),
            },
        })
    }

    /// The items of a list or the arguments of a generator: terms, or whole libraries.
    fn items(&mut self, items: &[Ast]) -> Option<Vec<LibExpr>> {
        let mut out = Vec::with_capacity(items.len());
        let mut complete = true;
        for item in items {
            match self.item(item) {
                Some(sets) => out.extend(sets),
                None => complete = false,
            }
        }
        complete.then_some(out)
    }

    fn item(&mut self, e: &Ast) -> Option<Vec<LibExpr>> {
        if let ExprKind::Range(from, to) = &e.kind {
            return self.signal_range(e.span, from, to);
        }
        let whole = match &e.ungrouped().kind {
            ExprKind::List(_) => true,
            ExprKind::Call(call) => self.vocabulary.generator(&call.name.text).is_some(),
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
            out.push(LibExpr {
                span,
                kind: LibKind::Term(Expr::signal(signal)),
            });
        }
        Some(out)
    }

    /// The names of `x1..x12`: one stem, numbers that rise.
    pub fn expand_range(&mut self, span: Span, from: &Ast, to: &Ast) -> Option<Vec<String>> {
        let ends = from
            .as_name()
            .and_then(numbered)
            .zip(to.as_name().and_then(numbered));
        let Some(((stem, first), (_, last))) = ends.filter(|((a, _), (b, _))| a == b) else {
            return self.fail(complain::range_of_names(span));
        };
        let (Ok(a), Ok(b)) = (first.parse::<usize>(), last.parse::<usize>()) else {
            return self.fail(complain::range_of_names(span));
        };
        if a > b || b - a >= MAX_RANGE {
            return self.fail(complain::range_bounds(span, a, b, MAX_RANGE));
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
        let usage = self
            .vocabulary
            .generator(&name.text)
            .map_or("", |g| g.usage);
        if call.juxtaposed || call.power.is_some() {
            return self.fail(complain::generator_without_arguments(
                e.span, &name.text, usage,
            ));
        }
        let args = self.items(&call.args);
        if call.numbers.is_none() && usage.contains(';') {
            let last = call.args.last().map(|a| {
                (
                    a.span,
                    matches!(a.kind, ExprKind::Number(_) | ExprKind::Range(..)),
                )
            });
            return self.fail(complain::numbers_missing(e.span, &name.text, usage, last));
        }
        let numbers: Vec<Option<NumberArg>> = call
            .numbers
            .iter()
            .flatten()
            .map(|n| self.number_arg(n))
            .collect();
        let numbers = numbers.into_iter().collect::<Option<Vec<_>>>();
        Some(LibExpr {
            span: e.span,
            kind: LibKind::Generate {
                name: name.text.clone(),
                name_span: name.span,
                args: args?,
                numbers: numbers?,
            },
        })
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
