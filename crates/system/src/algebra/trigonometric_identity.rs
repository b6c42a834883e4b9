//! sin² + cos² = 1, applied where it shortens an expression.
//!
//! In: an expanded expression. Out: the same with as many terms or fewer. Terms that differ only in even powers of
//! sine and cosine of one angle are rewritten in the cosine or the sine, whichever takes fewer terms.

use crate::algebra::thresholds::SYMBOLIC;
use std::collections::{BTreeMap, BTreeSet};

use crate::algebra::expand::collected;
use sidc_lang::term::{Atom, Expr, Func, Term};

/// Applies the identity angle by angle until nothing gets shorter.
pub fn simplified(e: &Expr) -> Expr {
    let mut best = e.clone();
    loop {
        let before = best.terms().len();
        for angle in angles(&best) {
            let next = in_one_angle(&best, &angle);
            if next.terms().len() < best.terms().len() {
                best = next;
            }
        }
        if best.terms().len() == before {
            return best;
        }
    }
}

/// Arguments of sines and cosines in the expression.
fn angles(e: &Expr) -> BTreeSet<Expr> {
    let atoms = e.terms().flat_map(|(_, t)| t.factors());
    atoms
        .filter_map(|(atom, _)| match atom {
            Atom::Call(f, args) if matches!(f.name, "sin" | "cos") => args.first().cloned(),
            _ => None,
        })
        .collect()
}

/// A monomial: coefficient, power of sin², power of cos².
type Square = (f64, u32, u32);

fn in_one_angle(e: &Expr, angle: &Expr) -> Expr {
    let (Some(sin), Some(cos)) = (call("sin", angle), call("cos", angle)) else {
        return e.clone();
    };
    let mut groups: BTreeMap<Term, Vec<Square>> = BTreeMap::new();
    for (weight, term) in e.terms() {
        let (i, j) = (squares(term, &sin), squares(term, &cos));
        let rest = term.mul(&sin.pow(-2.0 * f64::from(i)));
        let rest = rest.mul(&cos.pow(-2.0 * f64::from(j)));
        groups.entry(rest).or_default().push((weight, i, j));
    }
    let written = groups.into_iter().flat_map(|(rest, group)| {
        let shape = |(w, i, j): Square| {
            let s = sin.pow(2.0 * f64::from(i));
            (w, rest.mul(&s).mul(&cos.pow(2.0 * f64::from(j))))
        };
        shortest(group, &shape)
    });
    collected(written.collect())
}

/// The shortest of: the group as it is, in cosines, in sines.
fn shortest(group: Vec<Square>, shape: &impl Fn(Square) -> (f64, Term)) -> Vec<(f64, Term)> {
    let plain: Vec<(f64, Term)> = group.iter().map(|s| shape(*s)).collect();
    if group.len() < 2
        || group
            .iter()
            .any(|(_, i, j)| i.max(j) > &SYMBOLIC.rewritten_square)
    {
        return plain;
    }
    let turned = |sines: bool| -> Vec<(f64, Term)> {
        let all = group.iter().flat_map(|s| without(*s, sines));
        let sum = collected(all.map(shape).collect());
        sum.terms().map(|(w, t)| (w, t.clone())).collect()
    };
    let mut best = plain;
    for other in [turned(true), turned(false)] {
        if other.len() < best.len() {
            best = other;
        }
    }
    best
}

/// coefficient · S^i · C^j with S = 1 − C (`sines` are replaced), or C = 1 − S, expanded by the binomial theorem.
fn without((weight, i, j): Square, sines: bool) -> Vec<Square> {
    let (gone, stays) = if sines { (i, j) } else { (j, i) };
    let mut binomial = 1.0;
    (0..=gone)
        .map(|k| {
            let term = weight * binomial;
            binomial *= -f64::from(gone - k) / f64::from(k + 1);
            match sines {
                true => (term, 0, stays + k),
                false => (term, stays + k, 0),
            }
        })
        .collect()
}

/// The power of factor² in a term.
fn squares(term: &Term, factor: &Term) -> u32 {
    let wanted = factor.factors().next().map(|(a, _)| a);
    let power = term
        .factors()
        .find(|(a, _)| Some(*a) == wanted)
        .map_or(0.0, |(_, p)| p);
    match power.fract() == 0.0 && power >= 2.0 {
        true => (power / 2.0).floor().min(1e6) as u32,
        false => 0,
    }
}

fn call(name: &str, angle: &Expr) -> Option<Term> {
    let f = Func::named(name)?;
    let whole = Expr::call(f, vec![angle.clone()]);
    // The sine of a number is a number, not a factor.
    (whole.as_number().is_none()).then(|| whole.into_term().1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sidc_lang::term::{Signal, VarId};

    fn v(i: u16) -> Expr {
        Expr::signal(Signal::new(VarId(i)))
    }

    fn sin(i: u16) -> Expr {
        Expr::call(Func::named("sin").unwrap(), vec![v(i)])
    }

    fn cos(i: u16) -> Expr {
        Expr::call(Func::named("cos").unwrap(), vec![v(i)])
    }

    #[test]
    fn squares_that_add_up_to_one_go() {
        let one = Expr::number(1.0);
        assert_eq!(simplified(&(sin(1).pow(2.0) + cos(1).pow(2.0))), one);
        assert_eq!(
            simplified(&(one.clone() - cos(1).pow(2.0))),
            sin(1).pow(2.0)
        );
        let three = one.clone() + sin(1).pow(2.0).scale(3.0) + cos(1).pow(2.0).scale(2.0);
        assert_eq!(
            simplified(&three),
            Expr::number(4.0) - cos(1).pow(2.0),
            "three terms are two"
        );
        let fourth = sin(1).pow(4.0) + sin(1).pow(2.0) * cos(1).pow(2.0);
        assert_eq!(simplified(&fourth), sin(1).pow(2.0));
        let both = v(2) * (sin(1) * cos(2)).pow(2.0) + v(2) * (cos(1) * cos(2)).pow(2.0);
        let both = both + v(2) * sin(2).pow(2.0);
        assert_eq!(simplified(&both), v(2), "one angle after the other");
    }

    #[test]
    fn a_constant_may_go_into_one_of_two_angles() {
        let e = Expr::number(1.0) - cos(1).pow(2.0) - sin(2).pow(2.0);
        assert_eq!(simplified(&e), sin(1).pow(2.0) - sin(2).pow(2.0));
    }

    #[test]
    fn what_gets_no_shorter_stays() {
        let one = Expr::number(1.0);
        let denominators = [
            one - cos(1).pow(2.0).scale(0.3548),
            sin(1) * cos(1) + sin(1).pow(3.0),
            sin(1).pow(2.0).scale(0.5) + cos(2).pow(2.0).scale(0.5),
        ];
        for e in denominators {
            assert_eq!(simplified(&e), e);
        }
    }
}
