//! Partial derivatives, exact, in the normal form.
//!
//! In: an expression and a signal. Out: its derivative with respect to that signal, with every other signal fixed: for `x`, `dx` is fixed
//! too. Never multiplies out. The derivatives of functions are in the table of `function.rs`.

use crate::term::expr::Factor;
use crate::term::{Atom, Expr, Signal, Term};

impl Expr {
    /// ∂/∂`by`. At a kink (`abs`, `min`, `max`) the mean of both sides; the jump of `sign` has slope 0.
    pub fn derivative(&self, by: Signal) -> Expr {
        self.terms()
            .map(|(weight, term)| term.derivative(by).scale(weight))
            .sum()
    }
}

impl Term {
    /// ∂/∂`by` by the product rule: a summand for every factor that mentions the signal.
    pub fn derivative(&self, by: Signal) -> Expr {
        let summand = |(i, (atom, power)): (usize, (&Atom, f64))| {
            let inner = atom.derivative(by);
            match inner.as_number() {
                Some(0.0) => Expr::zero(),
                _ => times(Expr::from((power, self.lowered(i))), inner),
            }
        };
        self.factors().enumerate().map(summand).sum()
    }

    /// The term with the exponent of factor `i` lowered by one.
    fn lowered(&self, i: usize) -> Term {
        let mut factors = self.0.clone();
        if let Some(factor) = factors.get_mut(i) {
            factor.power -= 1.0;
        }
        factors.retain(|f| f.power != 0.0);
        Term(factors)
    }
}

impl Atom {
    /// ∂/∂`by` by the chain rule.
    pub fn derivative(&self, by: Signal) -> Expr {
        match self {
            Atom::Signal(s) if *s == by => Expr::number(1.0),
            Atom::Signal(_) => Expr::zero(),
            Atom::Sum(e) => e.derivative(by),
            Atom::Call(f, args) => {
                let summand = |(i, arg): (usize, &Expr)| {
                    let inner = arg.derivative(by);
                    match inner.as_number() {
                        Some(0.0) => Expr::zero(),
                        _ => times((f.slope)(args, i), inner),
                    }
                };
                args.iter().enumerate().map(summand).sum()
            }
        }
    }
}

/// The product. If it is a single sum it is returned as a sum and not as a factor, so that it merges with other summands:
/// (x(1 − x))′ = 1 − 2x.
fn times(a: Expr, b: Expr) -> Expr {
    let (weight, term) = (a * b).into_term();
    if let [Factor { atom, power }] = term.0.as_slice()
        && let (Atom::Sum(sum), true) = (atom, *power == 1.0)
    {
        return sum.as_ref().clone().scale(weight);
    }
    Expr::from((weight, term))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::term::{FUNCTIONS, Func, VarId};

    const X: Signal = Signal::new(VarId(1));
    const Y: Signal = Signal::new(VarId(2));

    fn x() -> Expr {
        Expr::signal(X)
    }

    fn y() -> Expr {
        Expr::signal(Y)
    }

    fn one() -> Expr {
        Expr::number(1.0)
    }

    fn call(name: &str, args: &[Expr]) -> Expr {
        Expr::call(Func::named(name).unwrap(), args.to_vec())
    }

    #[test]
    fn powers_products_and_sums_come_out_in_their_shortest_form() {
        let by_x = |e: Expr| e.derivative(X);
        assert_eq!(by_x(Expr::number(3.0)), Expr::zero());
        assert_eq!(by_x(y().pow(3.0)), Expr::zero());
        assert_eq!(
            by_x(Expr::signal(Signal::derivative(X.var, 1))),
            Expr::zero()
        );
        assert_eq!(by_x(x().scale(3.0)), Expr::number(3.0));
        assert_eq!(by_x(x().pow(2.0) * y()), x() * y().scale(2.0));
        assert_eq!(by_x(x().pow(-2.0)), x().pow(-3.0).scale(-2.0));
        assert_eq!(by_x(x().pow(0.5)), x().pow(-0.5).scale(0.5));
        assert_eq!(by_x(x() * (one() - x())), one() - x().scale(2.0));
        let square = (x() + y()).pow(2.0);
        assert_eq!(by_x(square), x().scale(2.0) + y().scale(2.0));
        let quotient = x() / (one() + x());
        let both = (one() + x()).pow(-1.0) - x() * (one() + x()).pow(-2.0);
        assert_eq!(by_x(quotient), both);
    }

    #[test]
    fn functions_follow_the_chain_rule() {
        let inner = x() * y();
        assert_eq!(
            call("sin", std::slice::from_ref(&inner)).derivative(X),
            y() * call("cos", std::slice::from_ref(&inner))
        );
        let drag = x() * call("abs", &[x()]);
        assert_eq!(
            drag.derivative(X),
            call("abs", &[x()]) + x() * call("sign", &[x()])
        );
        assert_eq!(call("sign", &[inner]).derivative(X), Expr::zero());
    }

    /// The table against the functions themselves, every argument of every function.
    #[test]
    fn every_slope_of_the_table_is_the_central_difference() {
        for f in FUNCTIONS {
            let signals: Vec<Signal> = (1..=3).map(|i| Signal::new(VarId(i))).collect();
            let count = f.arity.1.min(3);
            let args: Vec<Expr> = signals[..count].iter().copied().map(Expr::signal).collect();
            let whole = call(f.name, &args);
            for point in [[0.2, 0.5, 0.3], [0.9, 0.1, 0.4], [0.6, 0.3, 0.8]] {
                for (i, by) in signals[..count].iter().enumerate() {
                    let shifted = |h: f64| {
                        let mut z = point;
                        z[i] += h;
                        (f.eval)(&z[..count])
                    };
                    let difference = (shifted(1e-5) - shifted(-1e-5)) / 2e-5;
                    let exact = whole.derivative(*by);
                    let exact = exact.eval(&|s: Signal| point[usize::from(s.var.0) - 1]);
                    let off = (exact - difference).abs();
                    assert!(
                        off < 1e-8,
                        "{} by {i} at {point:?}: {exact} for {difference}",
                        f.name
                    );
                }
            }
        }
    }

    #[test]
    fn slopes_at_a_tie_add_up_to_one() {
        for name in ["min", "max"] {
            let args: Vec<Expr> = (1..=4)
                .map(|i| Expr::signal(Signal::new(VarId(i))))
                .collect();
            let whole = call(name, &args);
            for values in [[1.0; 4], [1.0, 0.0, 1.0, 1.0], [0.0, 2.0, 2.0, 1.0]] {
                let at = |s: Signal| values[usize::from(s.var.0) - 1];
                let slopes: Vec<f64> = (1..=4)
                    .map(|i| whole.derivative(Signal::new(VarId(i))).eval(&at))
                    .collect();
                assert_eq!(
                    slopes.iter().sum::<f64>(),
                    1.0,
                    "{name}{values:?}: {slopes:?}"
                );
                let value = whole.eval(&at);
                let fair = |(s, v): (&f64, f64)| *s == 0.0 || v == value;
                assert!(
                    slopes.iter().zip(values).all(fair),
                    "{name}{values:?}: {slopes:?}"
                );
            }
        }
    }
}
