//! Fractions of two sums, with common factors cancelled.
//!
//! In: numerator and denominator, expanded. Out: factors of all terms are cancelled, inner fractions cleared, factors
//! of the whole numerator placed before it. Polynomials are never divided.

use crate::algebra::thresholds::SYMBOLIC;
use std::collections::BTreeMap;

use crate::algebra::expand::{collected, expanded};
use crate::algebra::trigonometric_identity::simplified;
use sidc_lang::term::{Atom, Expr, Signal, Term};

/// factor · sum / below
#[derive(Clone, Debug, PartialEq)]
pub struct Fraction {
    /// Common factor of the numerator; 1 for a single term.
    pub factor: Term,
    pub sum: Expr,
    /// 1 if there is no denominator.
    pub below: Expr,
}

impl Fraction {
    /// `None` if clearing inner fractions takes too many terms or overflows.
    pub(super) fn new(above: Expr, below: Expr) -> Option<Fraction> {
        let (mut above, mut below) = (above, below);
        for _ in 0..SYMBOLIC.clearing_rounds {
            let shared = shared_by(above.terms().chain(below.terms()).map(|(_, t)| t));
            if shared.is_one() {
                break;
            }
            above = simplified(&expanded(&divided(&above, &shared))?);
            below = simplified(&expanded(&divided(&below, &shared))?);
        }
        let scale = 1.0 / unit(&below);
        let (above, below) = (above.scale(scale), below.scale(scale));
        let factor = match above.terms().len() {
            0 | 1 => Term::one(),
            _ => shared_by(above.terms().map(|(_, t)| t)),
        };
        let sum = divided(&above, &factor);
        (sum.is_finite() && below.is_finite()).then_some(Fraction { factor, sum, below })
    }

    /// Value at one point.
    pub fn eval(&self, at: &impl Fn(Signal) -> f64) -> f64 {
        self.factor.eval(at) * self.sum.eval(at) / self.below.eval(at)
    }
}

/// What the denominator is normalised by: its constant term, or else its first coefficient.
fn unit(below: &Expr) -> f64 {
    let constant = below.terms().find(|(_, t)| t.is_one());
    constant
        .or_else(|| below.terms().next())
        .map_or(1.0, |(w, _)| w)
}

fn divided(e: &Expr, by: &Term) -> Expr {
    let inverse = by.pow(-1.0);
    collected(e.terms().map(|(w, t)| (w, t.mul(&inverse))).collect())
}

/// The product of the lowest powers of all atoms: common factors, and inner denominators as negative powers.
fn shared_by<'a>(terms: impl Iterator<Item = &'a Term>) -> Term {
    let mut lowest: BTreeMap<&Atom, (f64, usize)> = BTreeMap::new();
    let mut count = 0;
    for term in terms {
        count += 1;
        for (atom, power) in term.factors() {
            let entry = lowest.entry(atom).or_insert((power, 0));
            entry.0 = entry.0.min(power);
            entry.1 += 1;
        }
    }
    let shared = lowest.into_iter().map(|(atom, (power, times))| {
        let lowest = if times < count { power.min(0.0) } else { power };
        Term::atom(atom.clone()).pow(lowest)
    });
    shared.fold(Term::one(), |all, t| all.mul(&t))
}

#[cfg(test)]
mod tests {
    use super::*;
    use sidc_lang::term::VarId;

    fn v(i: u16) -> Expr {
        Expr::signal(Signal::new(VarId(i)))
    }

    #[test]
    fn shared_factors_cancel_and_fractions_inside_are_cleared() {
        // (x/m + x y) / (x − x c/m)  =  (1 + m y)/(m − c)
        let (x, y, m, c) = (v(1), v(2), v(3), v(4));
        let above = x.clone() / m.clone() + x.clone() * y.clone();
        let below = x.clone() - x * c.clone() / m.clone();
        let f = Fraction::new(above, below).unwrap();
        assert_eq!(f.factor, Term::one());
        assert_eq!(f.sum, Expr::number(1.0) + m.clone() * y);
        assert_eq!(f.below, m - c);
    }

    #[test]
    fn what_all_terms_above_share_stands_before_them() {
        let (x, y) = (v(1), v(2));
        let above = x.clone() * y.clone() + x.clone() * y.clone().pow(2.0);
        let f = Fraction::new(above, Expr::number(2.0) + y.clone().pow(2.0)).unwrap();
        assert_eq!(Expr::from(f.factor.clone()), x * y.clone());
        assert_eq!(f.sum, (Expr::number(1.0) + y.clone()).scale(0.5));
        assert_eq!(f.below, Expr::number(1.0) + y.pow(2.0).scale(0.5));
    }
}
