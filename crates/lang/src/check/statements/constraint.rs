//! `constrain coef(ddy, F) > 0`: relations that are linear in coefficients.
//!
//! In: constraints and equations. Out: `Σ weight · coef + constant RELATION 0` for each relation. Does not check that a library has
//! the term.

use crate::ast::{Call, Expr as Ast, ExprKind, Keyword, Side, Sign, Statement, StatementKind};
use crate::check::checker::Checker;
use crate::check::errors;
use crate::model::{Coefficient, Constraint, Equation, Relation, RightSide};
use crate::source::Span;
use crate::thresholds::MODEL;

/// `Σ weight · coef + constant`
#[derive(Clone, Default)]
struct Linear {
    coefficients: Vec<Coefficient>,
    constant: f64,
}

impl Linear {
    fn scale(mut self, k: f64) -> Self {
        self.coefficients.iter_mut().for_each(|c| c.weight *= k);
        self.constant *= k;
        self
    }

    fn add(mut self, mut other: Linear) -> Self {
        self.coefficients.append(&mut other.coefficients);
        self.constant += other.constant;
        self
    }
}

/// `coef(TARGET, TERM)`
fn is_coefficient(call: &Call) -> bool {
    call.name.text == "coef"
}

impl Checker<'_> {
    pub fn constraints(&mut self, equations: &[Equation]) -> Vec<Constraint> {
        let mut out = Vec::new();
        for s in self.statements() {
            if let StatementKind::Constrain { first, rest } = &s.kind {
                if out.len() + rest.len() > MODEL.constraints {
                    self.say(errors::too_many_constraints(s.span, MODEL.constraints));
                    break;
                }
                self.chain(s.span, first, rest, equations, &mut out);
            }
        }
        out
    }

    /// `coef(ddx, u), coef(ddx, 1) : per run`
    pub fn per_run(&mut self, equations: &[Equation]) -> Vec<Coefficient> {
        let mut out: Vec<Coefficient> = Vec::new();
        for s in self.statements() {
            let StatementKind::PerRun {
                coefficients,
                attribute,
            } = &s.kind
            else {
                continue;
            };
            let value = attribute.value.as_ref().and_then(Ast::as_name);
            if attribute.key.text != "per" || value != Some("run") {
                let value = attribute.value.as_ref();
                let whole = value.map_or(attribute.key.span, |v| attribute.key.span.to(v.span));
                self.say(errors::per_run_words(attribute.key.span, whole));
                continue;
            }
            for e in coefficients {
                let ExprKind::Call(call) = &e.kind else {
                    self.say(errors::per_run_of_no_coefficient(e.span));
                    continue;
                };
                if !is_coefficient(call) || self.sized(e).is_none() {
                    self.say(errors::per_run_of_no_coefficient(e.span));
                    continue;
                }
                let found = self.coefficient(e, call, equations);
                for c in found.into_iter().flat_map(|l| l.coefficients) {
                    let same = |k: &&Coefficient| k.target == c.target && k.term == c.term;
                    match out.iter().find(same) {
                        Some(first) => self.say(errors::twice(c.span, first.span, "coefficient")),
                        None => out.push(c),
                    }
                }
            }
        }
        out
    }

    /// `0 < coef(dx, x) < 1` is two constraints.
    fn chain(
        &mut self,
        span: Span,
        first: &Ast,
        rest: &[(&'static str, Ast)],
        equations: &[Equation],
        out: &mut Vec<Constraint>,
    ) {
        if self.sized(first).is_none() || !rest.iter().all(|(_, e)| self.sized(e).is_some()) {
            return;
        }
        let mut left = self.linear(first, equations);
        for (relation, e) in rest {
            let right = self.linear(e, equations);
            if let (Some(l), Some(r)) = (left, &right) {
                let difference = l.add(r.clone().scale(-1.0));
                if difference.coefficients.is_empty() {
                    self.say(errors::constraint_without_coefficient(span));
                } else {
                    out.push(Constraint {
                        coefficients: difference.coefficients,
                        constant: difference.constant,
                        relation: self.relation(relation),
                        span,
                    });
                }
            }
            left = right;
        }
    }

    fn relation(&self, text: &str) -> Relation {
        match text {
            "<" => Relation::Less,
            "<=" => Relation::LessOrEqual,
            ">" => Relation::Greater,
            ">=" => Relation::GreaterOrEqual,
            _ => Relation::Equal,
        }
    }

    fn linear(&mut self, e: &Ast, equations: &[Equation]) -> Option<Linear> {
        match &e.kind {
            ExprKind::Group(x) => self.linear(x, equations),
            ExprKind::Negate(x) => Some(self.linear(x, equations)?.scale(-1.0)),
            ExprKind::Sum(parts) => {
                let mut total = Some(Linear::default());
                for (sign, part) in parts {
                    let k = if *sign == Sign::Minus { -1.0 } else { 1.0 };
                    let part = self.linear(part, equations);
                    total = total.and_then(|t| Some(t.add(part?.scale(k))));
                }
                total
            }
            ExprKind::Product(parts) => self.linear_product(e, parts, equations),
            ExprKind::Call(call) if is_coefficient(call) => self.coefficient(e, call, equations),
            ExprKind::Power(..) | ExprKind::Call(_) if e.find_call(&is_coefficient).is_some() => {
                self.fail(errors::constraint_not_linear(e.span))
            }
            _ => {
                let constant = self.constant(e, "a constraint, outside `coef(…)`")?;
                Some(Linear {
                    coefficients: Vec::new(),
                    constant,
                })
            }
        }
    }

    fn linear_product(
        &mut self,
        e: &Ast,
        parts: &[(Side, Ast)],
        equations: &[Equation],
    ) -> Option<Linear> {
        let mut out = Linear {
            coefficients: Vec::new(),
            constant: 1.0,
        };
        for (side, part) in parts {
            let factor = self.linear(part, equations)?;
            let both = !out.coefficients.is_empty() && !factor.coefficients.is_empty();
            let below = *side == Side::Below && !factor.coefficients.is_empty();
            if both || below {
                return self.fail(errors::constraint_not_linear(e.span));
            }
            out = match side {
                Side::Below if factor.constant == 0.0 => {
                    return self.fail(errors::division_by_zero(part.span));
                }
                Side::Below => out.scale(1.0 / factor.constant),
                Side::Above if factor.coefficients.is_empty() => out.scale(factor.constant),
                Side::Above => factor.scale(out.constant),
            };
        }
        Some(out)
    }

    /// Whether an equation of this target was written but dropped because of an error, which is reported already.
    fn has_wrong_equation(&self, target: &Ast) -> bool {
        let signal = |e: &Ast| e.as_name().and_then(|name| self.scope.signal(name));
        let same = |e: &Ast| match &e.kind {
            ExprKind::Range(..) => true,
            ExprKind::Name(_) => signal(e).is_some() && signal(e) == signal(target),
            _ => self.text(e.span) == self.text(target.span),
        };
        let written = |s: &Statement| match &s.kind {
            StatementKind::Equation { targets, .. } => targets.iter().any(same),
            _ => false,
        };
        let perhaps = [None, Some(Keyword::Include)];
        let mut broken = self.file.broken.iter();
        broken.any(|b| perhaps.contains(&b.keyword)) || self.statements().any(written)
    }

    /// A product without its numbers.
    fn plain_term(&self, term: &Ast) -> Option<String> {
        let ExprKind::Product(factors) = &term.ungrouped().kind else {
            return None;
        };
        let number = |x: &&(Side, Ast)| matches!(x.1.kind, ExprKind::Number(_));
        let plain = factors.iter().filter(|x| !number(x));
        Some(self.file.product_of(plain)).filter(|x| !x.is_empty())
    }

    /// `coef(TARGET, TERM)`
    fn coefficient(&mut self, e: &Ast, call: &Call, equations: &[Equation]) -> Option<Linear> {
        let [target, term] = call.args.as_slice() else {
            let target = self.example_target();
            let ours = format!("coef({target}, {})", self.example_name());
            return self.fail(errors::form(e.span, "coef", &ours));
        };
        let (signal, expr) = (self.arithmetic(target), self.arithmetic(term));
        let (signal, expr) = (signal?, expr?);
        let equation = equations
            .iter()
            .find(|q| signal == crate::term::Expr::signal(q.target));
        let Some(equation) = equation else {
            if self.has_wrong_equation(target) {
                return None;
            }
            let own = equations
                .first()
                .map(|q| self.text(q.target_span).to_string());
            let example = own.unwrap_or_else(|| self.example_target());
            return self.fail(errors::coefficient_of_no_equation(target.span, &example));
        };
        if matches!(equation.right, RightSide::Known(_)) {
            return self.fail(errors::coefficient_of_known(target.span, equation.span));
        }
        let (weight, normal) = expr.into_term();
        if weight != 1.0 {
            let ours = self.plain_term(term).map(|x| {
                let target = self.text(target.span);
                (e.span, format!("coef({target}, {x})/{weight}"))
            });
            return self.fail(errors::coefficient_of_multiple(term.span, weight, ours));
        }
        Some(Linear {
            coefficients: vec![Coefficient {
                weight: 1.0,
                target: equation.target,
                term: normal,
                span: e.span,
            }],
            constant: 0.0,
        })
    }
}
