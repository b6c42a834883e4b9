//! Sums of sets of terms: unions, and sums that were meant as arithmetic.
//!
//! In: sets with names resolved. Out: their union, or the sum as a number. Expands nothing.

use crate::ast::Sign;
use crate::model::{LibExpr, LibKind};
use crate::source::Span;
use crate::term::Expr;

/// A sum of numbers.
pub struct Number {
    pub span: Span,
    pub expr: Expr,
}

/// The value of a sum if all its parts are numbers.
pub fn sum_of_numbers(sets: &[(Sign, LibExpr)]) -> Option<Number> {
    let mut total = 0.0;
    for (sign, set) in sets {
        let LibKind::Term(expr) = &set.kind else {
            return None;
        };
        let x = expr.as_number()?;
        total += if *sign == Sign::Minus { -x } else { x };
    }
    let (first, last) = (sets.first()?, sets.last()?);
    Some(Number {
        span: first.1.span.to(last.1.span),
        expr: Expr::number(total),
    })
}

/// The place of a sum such as `1 - x` between sets: its `-` can remove nothing, and its number shows that arithmetic was meant.
pub fn number_minus_term(sets: &[(Sign, LibExpr)]) -> Option<Span> {
    let mut terms = Vec::with_capacity(sets.len());
    for (sign, set) in sets {
        let LibKind::Term(expr) = &set.kind else {
            return None;
        };
        terms.push((
            *sign,
            set.span,
            expr.clone().into_term().1,
            expr.as_number().is_some(),
        ));
    }
    let has_number = terms.iter().any(|t| t.3);
    let removes_nothing = terms
        .iter()
        .enumerate()
        .any(|(i, t)| t.0 == Sign::Minus && !terms.iter().take(i).any(|u| u.2 == t.2));
    let whole = terms.first()?.1.to(terms.last()?.1);
    (has_number && removes_nothing).then_some(whole)
}

/// The union of sets as a balanced tree, so that a long union is not deep.
pub fn union(mut sets: Vec<LibExpr>) -> Option<LibExpr> {
    while sets.len() > 1 {
        let mut rest = sets.into_iter();
        let pair = || {
            let first = rest.next()?;
            Some(match rest.next() {
                Some(second) => {
                    let span = first.span.to(second.span);
                    LibExpr::new(span, LibKind::Union(Box::new(first), Box::new(second)))
                }
                None => first,
            })
        };
        sets = std::iter::from_fn(pair).collect();
    }
    sets.pop()
}
