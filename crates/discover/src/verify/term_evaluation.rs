//! Terms at one row, in 106 bits.
//!
//! In: a term, and the value of every signal, which counts as exact. Out: a [`Ball`].

use super::ball::{Ball, unknown};
use sidc_lang::term::{Atom, Expr, Func, Signal, Term};

/// A term at one row.
pub fn term(term: &Term, at: &impl Fn(Signal) -> f64) -> Ball {
    let factors = term.factors().map(|(a, p)| (atom(a, at), p));
    product(factors)
}

/// Powers multiplied, in order.
pub fn product(factors: impl Iterator<Item = (Ball, f64)>) -> Ball {
    let mut all: Option<Ball> = None;
    for (base, p) in factors {
        let factor = base.power(p);
        all = Some(all.map_or(factor, |a| a.times(factor)));
    }
    all.unwrap_or(Ball::ONE)
}

/// An atom at one row.
pub fn atom(a: &Atom, at: &impl Fn(Signal) -> f64) -> Ball {
    match a {
        Atom::Signal(s) => Ball::exact(at(*s)),
        Atom::Sum(e) => expr(e, at),
        Atom::Call(f, args) => call(*f, args, at),
    }
}

fn expr(e: &Expr, at: &impl Fn(Signal) -> f64) -> Ball {
    let parts = e.terms().map(|(weight, t)| match weight == 1.0 {
        true => term(t, at),
        false => term(t, at).scale(weight),
    });
    // A single part is not rounded.
    parts.reduce(Ball::add).unwrap_or(Ball::exact(0.0))
}

fn call(f: Func, args: &[Expr], at: &impl Fn(Signal) -> f64) -> Ball {
    let mut values = args.iter().map(|a| expr(a, at));
    let Some(first) = values.next() else {
        return unknown();
    };
    match f.name {
        "min" => values.fold(first, |a, b| a.pick(b, -1.0)),
        "max" => values.fold(first, |a, b| a.pick(b, 1.0)),
        name => first.call(name),
    }
}

#[cfg(test)]
mod tests {
    use super::super::double_double::DoubleDouble;
    use super::*;
    use sidc_lang::term::{FUNCTIONS, VarId};

    fn x() -> Expr {
        Expr::signal(Signal::new(VarId(1)))
    }

    fn at(value: f64) -> impl Fn(Signal) -> f64 {
        move |s| match s.var.0 {
            1 => value,
            other => value + 0.5 - 0.2 * f64::from(other),
        }
    }

    #[test]
    fn every_function_of_the_language_is_known_and_agrees() {
        for f in FUNCTIONS {
            for point in [-2.3, -0.7, -0.01, 0.0, 0.3, 0.99, 1.0, 5.5, 40.0] {
                let mut args = vec![x()];
                args.extend(
                    (1..f.arity.1.min(3)).map(|i| Expr::signal(Signal::new(VarId(1 + i as u16)))),
                );
                let atom = Expr::call(Func::named(f.name).unwrap(), args.clone())
                    .into_term()
                    .1;
                let plain = atom.eval(&at(point));
                let found = term(&atom, &at(point));
                if plain.is_finite() {
                    let off = (found.value.to_f64() - plain).abs();
                    let allowed = 4.0 * f64::EPSILON * plain.abs().max(1.0);
                    assert!(off <= allowed, "{}({point}): {off:e}", f.name);
                    let bound = 1e-25 * plain.abs().max(1.0);
                    assert!(
                        found.error <= bound,
                        "{}({point}): {:e}",
                        f.name,
                        found.error
                    );
                } else {
                    assert!(!found.error.is_finite(), "{}({point})", f.name);
                }
            }
        }
    }

    #[test]
    fn powers_agree_with_the_evaluator() {
        for p in [-3.0, -1.5, -1.0, -0.5, 0.5, 1.5, 2.0, 7.0, 1025.0] {
            for point in [-1.2, -0.5, 0.0, 0.4, 1.001] {
                let t = x().pow(p).into_term().1;
                let plain = t.eval(&at(point));
                let found = term(&t, &at(point));
                if plain.is_finite() && plain.abs() > 1e-300 {
                    let off = (found.value.to_f64() - plain).abs() / plain.abs();
                    assert!(off < 1e-12, "{point}^{p}: {off:e}");
                } else if !plain.is_finite() {
                    assert!(!found.error.is_finite(), "{point}^{p}");
                }
            }
        }
    }

    #[test]
    fn bounds_hold_where_digits_cancel() {
        // 1 − cos x at 1e-9, whose value is x²/2 − x⁴/24.
        let cos = Expr::call(Func::named("cos").unwrap(), vec![x()]);
        let e = (Expr::number(1.0) - cos).into_term().1;
        let found = term(&e, &at(1e-9));
        let square = DoubleDouble::product(1e-9, 1e-9).scaled(-1);
        let off = (found.value - square).abs().to_f64();
        assert!(
            off <= found.error + 1e-37 && found.error < 1e-26,
            "{off:e} {:e}",
            found.error
        );
        // At x = 0 it is zero without error.
        assert_eq!(term(&e, &at(0.0)).error, 0.0);
    }

    #[test]
    fn a_sign_that_is_not_determined_has_a_wide_bound() {
        let sign = |of: Expr| {
            Expr::call(Func::named("sign").unwrap(), vec![of])
                .into_term()
                .1
        };
        assert_eq!(term(&sign(x()), &at(0.0)).error, 0.0);
        let sin = Expr::call(Func::named("sin").unwrap(), vec![x()]);
        let zero = sin.clone() - sin.pow(2.0).pow(0.5);
        assert_eq!(term(&sign(zero), &at(0.3)).error, 2.0);
    }
}
