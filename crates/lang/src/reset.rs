//! States that jump where a condition becomes true.
//!
//! In: nothing but these types. Read by all who run laws. Decides no side.

use crate::term::{Expr, Language, Signal, SignalNames};

/// `when y < 0 : dy -> -e*dy`: at the instant at which the condition becomes true, some states jump, all at once.
#[derive(Clone, Debug, PartialEq)]
pub struct Reset {
    pub condition: Condition,
    /// States or derivatives below a target, each with its value after the jump as a function of those before.
    pub jumps: Vec<(Signal, Expr)>,
}

/// `left < right`, or `left > right` if `is_above`.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    pub left: Expr,
    pub is_above: bool,
    pub right: Expr,
}

impl Reset {
    /// As it is written.
    pub fn text(&self, names: &(impl SignalNames + ?Sized)) -> String {
        let language = Language(names);
        let jump = |(signal, value): &(Signal, Expr)| {
            format!("{} -> {}", language.0.name(*signal), language.expr(value))
        };
        let jumps: Vec<String> = self.jumps.iter().map(jump).collect();
        format!("when {} : {}", self.condition.text(names), jumps.join(", "))
    }

    /// All its expressions.
    pub fn expressions(&self) -> impl Iterator<Item = &Expr> {
        let Condition { left, right, .. } = &self.condition;
        let values = self.jumps.iter().map(|(_, value)| value);
        [left, right].into_iter().chain(values)
    }

    /// The same with each expression changed.
    pub fn map(&self, change: &dyn Fn(&Expr) -> Expr) -> Reset {
        let Condition {
            left,
            is_above,
            right,
        } = &self.condition;
        Reset {
            condition: Condition {
                left: change(left),
                is_above: *is_above,
                right: change(right),
            },
            jumps: (self.jumps.iter())
                .map(|(signal, value)| (*signal, change(value)))
                .collect(),
        }
    }
}

impl Condition {
    /// As it is written.
    pub fn text(&self, names: &(impl SignalNames + ?Sized)) -> String {
        let language = Language(names);
        let sign = if self.is_above { '>' } else { '<' };
        let (left, right) = (language.expr(&self.left), language.expr(&self.right));
        format!("{left} {sign} {right}")
    }

    /// What is positive while the condition is false, and zero where it becomes true.
    pub fn guard(&self) -> Expr {
        let above = self.left.clone() - self.right.clone();
        above.scale(if self.is_above { -1.0 } else { 1.0 })
    }
}
