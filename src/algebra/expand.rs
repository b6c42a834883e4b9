//! Products of sums multiplied out.
//!
//! In: an expression. Out: the same as one sum of products of powers of signals and calls, equal terms merged, what only
//! rounding leaves of a cancelled term gone. A sum under a root or below a fraction bar stays one factor; arguments of
//! functions stay as they are. Never makes more than [`MOST`] terms.

use crate::term::{Atom, Expr, Term};

/// Terms before merging: a bound on time and memory, far above what anybody reads.
const MOST: usize = 20_000;
/// Highest power of a sum that is multiplied out.
const HIGHEST: f64 = 64.0;
/// Relative size, against what was added up, of a sum that is rounding.
const ROUNDING: f64 = 1e-13;

/// The expression multiplied out; `None` if that takes too many terms.
pub fn expanded(e: &Expr) -> Option<Expr> {
    let mut all = Vec::new();
    for (weight, term) in e.terms() {
        let part = expanded_term(term)?;
        all.extend(part.terms().map(|(w, t)| (weight * w, t.clone())));
        if all.len() > MOST {
            return None;
        }
    }
    Some(gathered(all))
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
        if power > HIGHEST {
            return None;
        }
        for _ in 0..power as usize {
            out = times(&out, &inner)?;
        }
    }
    Some(out)
}

/// The product of two expressions that are multiplied out themselves.
pub(super) fn times(a: &Expr, b: &Expr) -> Option<Expr> {
    if a.terms().len().saturating_mul(b.terms().len()) > MOST {
        return None;
    }
    let pairs = a
        .terms()
        .flat_map(|(v, s)| b.terms().map(move |(w, t)| (v * w, s.mul(t))));
    Some(gathered(pairs.collect()))
}

/// Equal terms added up. Different orders of multiplication round differently: what should cancel may not do so exactly.
pub(super) fn gathered(mut all: Vec<(f64, Term)>) -> Expr {
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
    kept.filter(|(sum, size, _)| sum.abs() > ROUNDING * size)
        .map(|(sum, _, term)| Expr::from((sum, term)))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::term::{Signal, VarId};

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
        assert_eq!(gathered(both), Expr::zero());
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
