//! Expansion of products of sums.
//!
//! In: an expression. Out: one sum of products of powers of signals and calls, like terms collected, terms that cancel
//! up to rounding removed. A sum under a root or below a fraction bar stays one factor; arguments of functions stay as
//! they are.

use crate::algebra::thresholds::SYMBOLIC;
use sidc_lang::term::{Atom, Expr, Term};

/// The expanded expression; `None` if it has too many terms.
pub fn expanded(e: &Expr) -> Option<Expr> {
    let mut all = Vec::new();
    for (weight, term) in e.terms() {
        let part = expanded_term(term)?;
        all.extend(part.terms().map(|(w, t)| (weight * w, t.clone())));
        if all.len() > SYMBOLIC.expanded_terms {
            return None;
        }
    }
    Some(collected(all))
}

fn expanded_term(term: &Term) -> Option<Expr> {
    let plain = term.part(|a| !matches!(a, Atom::Sum(_)));
    let mut out = Expr::from(plain);
    for (atom, power) in term.factors() {
        let Atom::Sum(inner) = atom else { continue };
        let inner = expanded(inner)?;
        let whole = power.fract() == 0.0 && power > 0.0;
        if !whole || inner.terms().len() < 2 {
            out = times(&out, &inner.pow(power))?;
            continue;
        }
        if power > SYMBOLIC.expanded_power {
            return None;
        }
        for _ in 0..power as usize {
            out = times(&out, &inner)?;
        }
    }
    Some(out)
}

/// The product of two expanded expressions.
pub(super) fn times(a: &Expr, b: &Expr) -> Option<Expr> {
    if a.terms().len().saturating_mul(b.terms().len()) > SYMBOLIC.expanded_terms {
        return None;
    }
    let pairs = a
        .terms()
        .flat_map(|(v, s)| b.terms().map(move |(w, t)| (v * w, s.mul(t))));
    Some(collected(pairs.collect()))
}

/// Collects like terms. Products in different orders round differently, so terms that cancel are recognised up to
/// rounding.
pub(super) fn collected(mut all: Vec<(f64, Term)>) -> Expr {
    all.sort_by(|a, b| a.1.cmp(&b.1));
    let mut sums: Vec<(f64, f64, Term)> = Vec::new();
    for (weight, term) in all {
        match sums.last_mut() {
            Some((sum, size, last)) if *last == term => {
                *sum += weight;
                *size += weight.abs();
            }
            _ => sums.push((weight, weight.abs(), term)),
        }
    }
    let kept = sums.into_iter();
    kept.filter(|(sum, size, _)| sum.abs() > SYMBOLIC.cancelled * size)
        .map(|(sum, _, term)| Expr::from((sum, term)))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sidc_lang::term::{Signal, VarId};

    fn v(i: u16) -> Expr {
        Expr::signal(Signal::new(VarId(i)))
    }

    #[test]
    fn sums_are_multiplied_out_and_cancel() {
        let (x, y) = (v(1), v(2));
        let square = (x.clone() - y.clone()).pow(2.0);
        let written = x.clone().pow(2.0) + y.clone().pow(2.0) - (x.clone() * y.clone()).scale(2.0);
        assert_eq!(expanded(&square), Some(written.clone()));
        assert_eq!(expanded(&(square - written)), Some(Expr::zero()));
        // 0.1·0.2·0.3 in two orders differs in its last bit.
        let a = (x.clone().scale(0.1) * y.clone().scale(0.2)) * x.clone().scale(0.3);
        let b = (x.clone().scale(0.3) * y.clone().scale(0.1)) * x.scale(0.2);
        let both = [terms(&a), terms(&b.scale(-1.0))].concat();
        assert_eq!(collected(both), Expr::zero());
    }

    fn terms(e: &Expr) -> Vec<(f64, Term)> {
        e.terms().map(|(w, t)| (w, t.clone())).collect()
    }

    #[test]
    fn what_would_explode_is_refused_in_no_time() {
        let sum: Expr = (1..12).map(v).sum();
        assert_eq!(expanded(&sum.clone().pow(40.0)), None);
        assert_eq!(expanded(&(v(1) + v(2)).pow(1e15)), None);
        // Below a fraction bar a sum is one factor.
        let below = sum.pow(-40.0);
        assert_eq!(expanded(&below), Some(below));
    }
}
