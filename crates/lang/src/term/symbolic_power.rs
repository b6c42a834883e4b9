//! Powers whose exponents are symbols.
//!
//! In: a base and an exponent. Out: b^e in the normal form, exp(e·log b), in which only numbers are exponents; and the base and
//! exponent of such an atom, so that it is printed, computed and emitted as the power that was written.

use crate::term::{Atom, Expr, Func, Signal};

impl Expr {
    /// b^e for an exponent that is known only with the data. `None` if the table of functions lacks `exp` or `log`.
    pub fn raised_to(self, exponent: Expr) -> Option<Expr> {
        let log = Expr::call(Func::named("log")?, vec![self]);
        Some(Expr::call(Func::named("exp")?, vec![exponent * log]))
    }
}

impl Atom {
    /// Base and exponent of an atom that is b^e with symbols in e, all of which are `constant`.
    pub fn as_power(&self, constant: &impl Fn(Signal) -> bool) -> Option<(&Expr, Expr)> {
        let Atom::Call(f, args) = self else {
            return None;
        };
        let ("exp", [arg]) = (f.name, args.as_ref()) else {
            return None;
        };
        let mut terms = arg.terms();
        let (Some((weight, term)), None) = (terms.next(), terms.next()) else {
            return None;
        };
        let logs: Vec<(&Atom, &Expr)> = term.factors().filter_map(logarithm).collect();
        let varies = |(_, base): &&(&Atom, &Expr)| !is_constant(base, constant);
        let (log, base) = *logs.iter().find(varies).or(logs.last())?;
        let exponent = Expr::from((weight, term.part(|a| a != log)));
        (exponent.as_number().is_none() && is_constant(&exponent, constant))
            .then_some((base, exponent))
    }
}

/// The argument of a logarithm that is a factor to the first power.
fn logarithm((atom, power): (&Atom, f64)) -> Option<(&Atom, &Expr)> {
    match atom {
        Atom::Call(f, args) if f.name == "log" && power == 1.0 => Some((atom, args.first()?)),
        _ => None,
    }
}

fn is_constant(e: &Expr, constant: &impl Fn(Signal) -> bool) -> bool {
    let mut all = true;
    e.for_each_signal(&mut |s| all &= constant(s));
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::term::{Language, SignalNames, VarId};

    struct Names;
    impl SignalNames for Names {
        fn variable(&self, var: VarId) -> &str {
            ["t", "x", "n", "K"][var.0 as usize]
        }

        fn is_constant(&self, var: VarId) -> bool {
            var.0 > 1
        }
    }

    fn signals() -> [Expr; 3] {
        [1, 2, 3].map(|v| Expr::signal(Signal::new(VarId(v))))
    }

    fn text(e: &Expr) -> String {
        Language(&Names).expr(e)
    }

    #[test]
    fn powers_print_as_they_were_written() {
        let [x, n, k] = signals();
        let raised = |b: &Expr, e: &Expr| b.clone().raised_to(e.clone()).unwrap();
        assert_eq!(text(&raised(&x, &n)), "x^n");
        let share = x.clone() / k.clone();
        assert_eq!(text(&raised(&share, &n)), "(x/K)^n");
        let more = n.clone() + Expr::number(1.0);
        assert_eq!(text(&raised(&x, &more)), "x^(1 + n)");
        assert_eq!(text(&raised(&x, &n.clone().scale(-2.0))), "x^(-2*n)");
        assert_eq!(text(&raised(&x, &n).pow(2.0)), "(x^n)^2");
        let hill = raised(&x, &n) / (raised(&k, &n) + raised(&x, &n));
        assert_eq!(text(&hill), "x^n/(x^n + K^n)");
        let of_log = Expr::call(Func::named("log").unwrap(), vec![k.clone()]);
        assert_eq!(text(&raised(&x, &of_log)), "x^log(K)");
    }

    #[test]
    fn what_varies_or_is_a_number_is_no_exponent() {
        let [x, n, k] = signals();
        let varies = n.raised_to(x.clone()).unwrap();
        assert_eq!(text(&varies), "exp(x*log(n))");
        let square = x.raised_to(Expr::number(2.0)).unwrap();
        assert_eq!(text(&square), "exp(2*log(x))");
        let plain = Expr::call(Func::named("exp").unwrap(), vec![k]);
        assert_eq!(text(&plain), "exp(K)");
    }
}
