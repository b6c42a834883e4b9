//! `when y < 0 : dy -> -e*dy`: states that jump where a condition becomes true.
//!
//! In: these statements, and the equations. Out: conditions and values, as expressions. Decides no side.

use std::collections::BTreeMap;

use crate::ast::{Expr as Ast, StatementKind};
use crate::check::checker::{Checker, every};
use crate::check::errors;
use crate::model::{Condition, Equation, Reset, VarKind};
use crate::source::Span;
use crate::term::{Expr, Signal};
use crate::thresholds::MODEL;

impl Checker<'_> {
    pub fn resets(&mut self, equations: &[Equation]) -> Vec<Reset> {
        let mut out: Vec<Reset> = Vec::new();
        for s in self.statements() {
            let StatementKind::Reset {
                left,
                relation,
                right,
                jumps,
            } = &s.kind
            else {
                continue;
            };
            if let Some(discrete) = self.scope.discrete {
                self.say(errors::reset_in_discrete(s.span, discrete));
                continue;
            }
            let condition = self.condition((left, relation, right), equations);
            let jumps = jumps
                .iter()
                .map(|(name, to)| self.jump(name, to, equations));
            let jumps = every(jumps);
            let (Some(condition), Some(jumps)) = (condition, jumps) else {
                continue;
            };
            let mut first: BTreeMap<Signal, Span> = BTreeMap::new();
            for (signal, _, at) in &jumps {
                if let Some(before) = first.insert(*signal, *at) {
                    self.say(errors::twice(*at, before, "value of this state"));
                }
            }
            out.push(Reset {
                condition,
                jumps: jumps.into_iter().map(|(s, to, _)| (s, to)).collect(),
            });
            if out.len() > MODEL.resets {
                self.say(errors::too_many_resets(s.span, MODEL.resets));
                break;
            }
        }
        out
    }

    fn condition(
        &mut self,
        (left, relation, right): (&Ast, &str, &Ast),
        equations: &[Equation],
    ) -> Option<Condition> {
        let whole = left.span.to(right.span);
        if relation == "=" {
            let ours = [self.text(left.span), self.text(right.span)];
            return self.fail(errors::reset_at_equality(whole, ours));
        }
        let (a, b) = (
            self.of_states(left, equations),
            self.of_states(right, equations),
        );
        let condition = Condition {
            left: a?,
            is_above: relation.starts_with('>'),
            right: b?,
        };
        let guard = condition.guard();
        let mut moves = false;
        guard.for_each_signal(&mut |s| {
            let var = self.scope.var(s.var).map(|v| v.kind);
            moves |= var.is_some_and(|k| k == VarKind::State || k == VarKind::Time);
        });
        match moves {
            true => Some(condition),
            false => self.fail(errors::reset_without_state(whole)),
        }
    }

    /// `dy -> -e*dy`
    fn jump(
        &mut self,
        name: &Ast,
        to: &Ast,
        equations: &[Equation],
    ) -> Option<(Signal, Expr, Span)> {
        let text = name.as_name().unwrap_or("");
        let signal = match self.scope.use_signal(text) {
            Some(signal) => Some(signal),
            None => self.unknown_name(name.span, text),
        };
        let to = self.of_states(to, equations);
        let signal = signal?;
        let own = equations.iter().find(|e| e.target.var == signal.var);
        let is_state = self.scope.var(signal.var)?.kind == VarKind::State;
        match own {
            Some(own) if is_state && signal.der < own.target.der => Some((signal, to?, name.span)),
            Some(own) if is_state => {
                let target = self.spelling(own.target);
                self.fail(errors::jump_of_target(name.span, own.span, &target))
            }
            // Its equation may be one that could not be read.
            _ if !self.file.broken.is_empty() => None,
            _ => self.fail(errors::jump_of_other(name.span, text, is_state)),
        }
    }

    /// Arithmetic that is known at an instant: without the targets of equations.
    fn of_states(&mut self, e: &Ast, equations: &[Equation]) -> Option<Expr> {
        self.sized(e)?;
        let expr = self.arithmetic(e)?;
        if !expr.is_finite() {
            return self.fail(errors::not_finite(e.span));
        }
        match equations.iter().find(|q| expr.mentions(q.target)) {
            Some(own) => {
                let target = self.spelling(own.target);
                self.fail(errors::reset_by_target(e.span, own.span, &target))
            }
            None => Some(expr),
        }
    }
}
