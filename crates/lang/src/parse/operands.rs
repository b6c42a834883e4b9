//! Small parts of expressions: chains of operators, ranges, numbers.
//!
//! In: operands, or pest's pairs of digits. Out: nodes and values. Reports nothing.

use pest::iterators::Pair;

use crate::ast::{Expr, ExprKind, Side, Sign};
use crate::parse::grammar::Rule;

/// Joins two operands, keeping a chain of one precedence flat.
pub fn infix(left: Expr, op: Rule, right: Expr) -> Expr {
    let span = left.span.to(right.span);
    let kind = match op {
        Rule::add | Rule::subtract => {
            let sign = if op == Rule::add {
                Sign::Plus
            } else {
                Sign::Minus
            };
            let mut parts = match left.kind {
                ExprKind::Sum(parts) => parts,
                kind => vec![(Sign::Plus, Expr::new(left.span, kind))],
            };
            parts.push((sign, right));
            ExprKind::Sum(parts)
        }
        _ => {
            let side = if op == Rule::multiply {
                Side::Above
            } else {
                Side::Below
            };
            let mut parts = match left.kind {
                ExprKind::Product(parts) => parts,
                kind => vec![(Side::Above, Expr::new(left.span, kind))],
            };
            parts.push((side, right));
            ExprKind::Product(parts)
        }
    };
    Expr::new(span, kind)
}

/// `from .. to`
pub fn range(from: Expr, to: Expr) -> Expr {
    let span = from.span.to(to.span);
    Expr::new(span, ExprKind::Range(Box::new(from), Box::new(to)))
}

/// The value of digits that the lexer has accepted.
pub fn number(pair: &Pair<Rule>) -> f64 {
    pair.as_str().parse().unwrap_or(f64::NAN)
}

/// `share = @{ number ~ " "* ~ "%" }`
pub fn percent(pair: &Pair<Rule>) -> f64 {
    let number = pair.as_str().trim_end_matches(['%', ' ']);
    number.parse::<f64>().unwrap_or(f64::NAN) / 100.0
}

/// `raised = { "^" ~ minus? ~ number }`
pub fn raised(pair: Pair<Rule>) -> f64 {
    pair.into_inner()
        .fold(1.0, |value, part| match part.as_rule() {
            Rule::minus => -value,
            _ => value * number(&part),
        })
}
