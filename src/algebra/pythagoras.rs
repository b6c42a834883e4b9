//! sin² + cos² = 1, where it makes an expression shorter.
//!
//! In: an expression that is multiplied out. Out: the same with fewer terms, or as it came. Terms that differ only in even
//! powers of the sine and the cosine of one angle are taken together, and written in the cosine or in the sine, whichever
//! takes fewer terms. Never lengthens anything.

use std::collections::{BTreeMap, BTreeSet};

use super::expand::gathered;
use crate::term::{Atom, Expr, Func, Term};

/// Highest power of a square that is rewritten: (1 − c²)^8 has 9 terms.
const HIGHEST: u32 = 8;

/// The shortest of what the identity gives, angle by angle, until nothing gets shorter.
pub fn shortened(e: &Expr) -> Expr {
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

/// Arguments of which both the sine and the cosine can stand in the expression.
fn angles(e: &Expr) -> BTreeSet<Expr> {
    let atoms = e.terms().flat_map(|(_, t)| t.factors());
    atoms
        .filter_map(|(atom, _)| match atom {
            Atom::Call(f, args) if matches!(f.name, "sin" | "cos") => args.first().cloned(),
            _ => None,
        })
        .collect()
}

/// A monomial in the squares: weight, power of sin², power of cos².
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
    gathered(written.collect())
}

/// The group as it is, in cosines, or in sines; the first of the shortest.
fn shortest(group: Vec<Square>, shape: &impl Fn(Square) -> (f64, Term)) -> Vec<(f64, Term)> {
    let plain: Vec<(f64, Term)> = group.iter().map(|s| shape(*s)).collect();
    if group.len() < 2 || group.iter().any(|(_, i, j)| i.max(j) > &HIGHEST) {
        return plain;
    }
    let turned = |sines: bool| -> Vec<(f64, Term)> {
        let all = group.iter().flat_map(|s| without(*s, sines));
        let sum = gathered(all.map(shape).collect());
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

/// w·S^i·C^j with S = 1 − C (`sines` go), or C = 1 − S (cosines go), multiplied out.
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

/// How often the square of a factor stands in a term.
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
    // The sine of a number is a number, and no factor.
    (whole.as_number().is_none()).then(|| whole.into_term().1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::term::{Signal, VarId};

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
        assert_eq!(shortened(&(sin(1).pow(2.0) + cos(1).pow(2.0))), one);
        assert_eq!(shortened(&(one.clone() - cos(1).pow(2.0))), sin(1).pow(2.0));
        let three = one.clone() + sin(1).pow(2.0).scale(3.0) + cos(1).pow(2.0).scale(2.0);
        assert_eq!(
            shortened(&three),
            Expr::number(4.0) - cos(1).pow(2.0),
            "three terms are two"
        );
        let fourth = sin(1).pow(4.0) + sin(1).pow(2.0) * cos(1).pow(2.0);
        assert_eq!(shortened(&fourth), sin(1).pow(2.0));
        let both = v(2) * (sin(1) * cos(2)).pow(2.0) + v(2) * (cos(1) * cos(2)).pow(2.0);
        let both = both + v(2) * sin(2).pow(2.0);
        assert_eq!(shortened(&both), v(2), "one angle after the other");
    }

    #[test]
    fn a_constant_may_go_into_one_of_two_angles() {
        let e = Expr::number(1.0) - cos(1).pow(2.0) - sin(2).pow(2.0);
        assert_eq!(shortened(&e), sin(1).pow(2.0) - sin(2).pow(2.0));
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
            assert_eq!(shortened(&e), e);
        }
    }
}
