//! Parity of terms: even or odd when some signals change sign together.
//!
//! In: which signals change sign. Out: the parity that the form of a term proves. Never evaluates, so that `exp(x)*exp(-x)` counts as
//! neither.

use crate::term::function::Symmetry;
use crate::term::{Atom, Expr, Signal, Term};

/// How a term changes when the signals change sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    Even,
    Odd,
    /// No definite parity: `exp(x)`, `1 + x`.
    Neither,
}

impl Parity {
    fn times(self, other: Parity) -> Parity {
        match (self, other) {
            (Parity::Neither, _) | (_, Parity::Neither) => Parity::Neither,
            (a, b) if a == b => Parity::Even,
            _ => Parity::Odd,
        }
    }

    /// Parity of x^p, given that of x.
    fn power(self, p: f64) -> Parity {
        match self {
            Parity::Odd if p.fract() != 0.0 => Parity::Neither,
            Parity::Odd if p % 2.0 == 0.0 => Parity::Even,
            same => same,
        }
    }
}

impl Term {
    /// The parity of the product of its factors.
    pub fn parity(&self, flips: &impl Fn(Signal) -> bool) -> Parity {
        self.factors()
            .map(|(atom, p)| atom.parity(flips).power(p))
            .fold(Parity::Even, Parity::times)
    }
}

impl Expr {
    /// The parity that all terms share.
    pub fn parity(&self, flips: &impl Fn(Signal) -> bool) -> Parity {
        let mut parities = self.terms().map(|(_, t)| t.parity(flips));
        let first = parities.next().unwrap_or(Parity::Even);
        match parities.all(|p| p == first) {
            true => first,
            false => Parity::Neither,
        }
    }
}

impl Atom {
    pub fn parity(&self, flips: &impl Fn(Signal) -> bool) -> Parity {
        match self {
            Atom::Signal(s) if flips(*s) => Parity::Odd,
            Atom::Signal(_) => Parity::Even,
            Atom::Sum(e) => e.parity(flips),
            Atom::Call(f, args) => {
                let mut parities = args.iter().map(|a| a.parity(flips));
                if parities.clone().all(|p| p == Parity::Even) {
                    return Parity::Even;
                }
                match (parities.next(), parities.next(), f.symmetry) {
                    (Some(Parity::Odd), None, Symmetry::Odd) => Parity::Odd,
                    (Some(Parity::Odd), None, Symmetry::Even) => Parity::Even,
                    _ => Parity::Neither,
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::term::{FUNCTIONS, Func, VarId};

    const X: Signal = Signal::new(VarId(1));
    const Y: Signal = Signal::new(VarId(2));

    fn flips(s: Signal) -> bool {
        s.var == X.var
    }

    fn call(name: &str, args: &[Expr]) -> Expr {
        Expr::call(Func::named(name).unwrap(), args.to_vec())
    }

    #[test]
    fn products_powers_and_sums_have_the_parity_of_their_parts() {
        let (x, y) = (Expr::signal(X), Expr::signal(Y));
        let of = |e: Expr| e.parity(&flips);
        assert_eq!(of(Expr::number(1.0)), Parity::Even);
        assert_eq!(
            of(Expr::signal(Signal::derivative(VarId(1), 2))),
            Parity::Odd
        );
        assert_eq!(of(x.clone() * y.clone()), Parity::Odd);
        assert_eq!(of(x.clone().pow(-3.0)), Parity::Odd);
        assert_eq!(of(x.clone().pow(4.0)), Parity::Even);
        assert_eq!(of(x.clone().pow(0.5)), Parity::Neither);
        assert_eq!(of(y.clone().pow(0.5)), Parity::Even);
        assert_eq!(of(x.clone() + x.clone().pow(3.0)), Parity::Odd);
        assert_eq!(of(Expr::number(1.0) + x.clone()), Parity::Neither);
        assert_eq!(of((x.clone() + Expr::number(1.0)) * y), Parity::Neither);
    }

    #[test]
    fn functions_of_even_arguments_are_even() {
        let square = Expr::signal(X).pow(2.0);
        for f in FUNCTIONS {
            let args = vec![square.clone(); f.arity.0];
            let parity = call(f.name, &args).parity(&flips);
            assert_eq!(parity, Parity::Even, "{}", f.name);
        }
    }

    /// The table against the functions themselves, at points inside every domain.
    #[test]
    fn functions_of_odd_arguments_are_what_the_table_says() {
        for f in FUNCTIONS.iter().filter(|f| f.arity.0 == 1) {
            let parity = call(f.name, &[Expr::signal(X)]).parity(&flips);
            let pairs = [0.2, 0.5, 0.9].map(|x| ((f.eval)(&[x]), (f.eval)(&[-x])));
            let measured = if pairs.iter().all(|(a, b)| a == b) {
                Parity::Even
            } else if pairs.iter().all(|(a, b)| *a == -b) {
                Parity::Odd
            } else {
                Parity::Neither
            };
            assert_eq!(parity, measured, "{}", f.name);
        }
        let both = [Expr::signal(X), Expr::signal(Y)];
        assert_eq!(call("max", &both).parity(&flips), Parity::Neither);
    }
}
