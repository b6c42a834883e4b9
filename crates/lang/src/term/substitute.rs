//! Numbers in place of signals.
//!
//! In: an expression, the values of some signals. Out: the expression without these signals, in the normal form.

use crate::term::{Atom, Expr, Signal, Term};

impl Expr {
    /// The expression with `value(s)` in place of every signal s that has one.
    pub fn with_values(&self, value: &impl Fn(Signal) -> Option<f64>) -> Expr {
        let terms = self.terms();
        terms.map(|(w, t)| t.with_values(value).scale(w)).sum()
    }
}

impl Term {
    /// As [`Expr::with_values`].
    pub fn with_values(&self, value: &impl Fn(Signal) -> Option<f64>) -> Expr {
        let factors = self.factors();
        factors.fold(Expr::number(1.0), |product, (atom, power)| {
            product * atom.with_values(value).pow(power)
        })
    }
}

impl Atom {
    fn with_values(&self, value: &impl Fn(Signal) -> Option<f64>) -> Expr {
        match self {
            Atom::Signal(s) => value(*s).map_or_else(|| Expr::signal(*s), Expr::number),
            Atom::Call(f, args) => {
                if let Some((base, exponent)) = self.as_power(&|s| value(s).is_some())
                    && let Some(p) = exponent.with_values(value).as_number()
                {
                    return base.with_values(value).pow(p);
                }
                let args = args.iter().map(|a| a.with_values(value));
                Expr::call(*f, args.collect())
            }
            Atom::Sum(e) => e.with_values(value),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::term::{Func, VarId};

    #[test]
    fn an_expression_has_the_same_value_with_numbers_in_place_of_signals() {
        let [x, k] = [1, 2].map(|v| Signal::new(VarId(v)));
        let exp = Func::named("exp").unwrap();
        let (sx, sk) = (Expr::signal(x), Expr::signal(k));
        let decay = Expr::call(exp, vec![(sk.clone() * sx.clone()).scale(-1.0)]);
        let saturated = sx.clone() / (sk.clone() + sx.clone());
        let e = decay.scale(2.0) + saturated * sk.pow(0.5);
        let at = |s: Signal| if s == x { 0.7 } else { 3.0 };
        let numeric = e.with_values(&|s| (s == k).then_some(3.0));
        assert!(!numeric.mentions(k) && numeric.mentions(x));
        assert!((numeric.eval(&at) - e.eval(&at)).abs() < 1e-15);
        let all = e.with_values(&|s| Some(at(s)));
        assert!((all.as_number().unwrap() - e.eval(&at)).abs() < 1e-15);
    }

    #[test]
    fn a_power_becomes_one_of_a_number() {
        let [x, n] = [1, 2].map(|v| Signal::new(VarId(v)));
        let power = Expr::signal(x).raised_to(Expr::signal(n)).unwrap();
        let cube = power.with_values(&|s| (s == n).then_some(3.0));
        assert_eq!(cube, Expr::signal(x).pow(3.0));
    }
}
