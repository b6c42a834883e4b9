//! Standard terms: what textbooks write into laws, whatever the user's library holds.
//!
//! In: signals. Out: terms of them, the simplest first. Evaluates nothing.

use sidc_lang::model::Model;
use sidc_lang::term::{Expr, Func, Signal, Term, UnitRule};

/// Functions of one signal that occur in laws.
const FUNCTIONS: [&str; 8] = ["sin", "cos", "abs", "sign", "exp", "tanh", "sqrt", "log"];

/// Those that are also multiplied with signals: `dx*abs(dx)`, `u*cos(x)`.
const FACTORS: [&str; 5] = ["sin", "cos", "abs", "sign", "exp"];

/// Monomials up to degree 3, functions, reciprocals, and products of a signal with a function. No function that takes a pure number is of
/// a signal that `has_unit`: such a term would be no term of the model.
pub(crate) fn standard_terms(signals: &[Signal], has_unit: &impl Fn(Signal) -> bool) -> Vec<Term> {
    let bare: Vec<Term> = signals.iter().map(|s| Term::signal(*s)).collect();
    let mut all = vec![Term::one()];
    all.extend(bare.iter().cloned());
    for (i, a) in bare.iter().enumerate() {
        all.extend(bare[i..].iter().map(|b| a.mul(b)));
    }
    all.extend(calls(&FUNCTIONS, signals, has_unit));
    all.extend(bare.iter().map(|a| a.pow(-1.0)));
    for f in calls(&FACTORS, signals, has_unit) {
        all.extend(bare.iter().map(|a| a.mul(&f)));
    }
    for (i, a) in bare.iter().enumerate() {
        for (j, b) in bare.iter().enumerate().skip(i) {
            all.extend(bare[j..].iter().map(|c| a.mul(b).mul(c)));
        }
    }
    all
}

/// Whether a signal is declared in a unit that is no pure number, nor an angle in rad.
pub(crate) fn has_unit(model: &Model, signal: Signal) -> bool {
    model.unit(signal).is_some_and(|u| !u.is_pure_number())
}

/// Every function of every signal, but those that take a pure number of signals that `has_unit`.
pub(crate) fn calls(
    names: &[&str],
    signals: &[Signal],
    has_unit: &impl Fn(Signal) -> bool,
) -> Vec<Term> {
    let functions = names.iter().filter_map(|name| Func::named(name));
    let of = |f, s: &Signal| Expr::call(f, vec![Expr::signal(*s)]).into_term().1;
    let fits = |f: Func, s: Signal| f.units != UnitRule::Pure || !has_unit(s);
    functions
        .flat_map(|f| {
            let own = signals.iter().filter(move |s| fits(f, **s));
            own.map(move |s| of(f, s))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sidc_lang::term::VarId;

    #[test]
    fn no_function_is_of_a_signal_with_a_unit_that_it_does_not_take() {
        let [angle, rate] = [0, 1].map(|der| Signal::derivative(VarId(1), der));
        let of =
            |has_unit: &dyn Fn(Signal) -> bool| standard_terms(&[angle, rate], &|s| has_unit(s));
        let all = of(&|_| false);
        let some = of(&|s| s == rate);
        let named = |name: &str, s: Signal| calls(&[name], &[s], &|_| false).pop().unwrap();
        for name in ["sin", "cos", "exp", "tanh", "log"] {
            assert!(
                all.contains(&named(name, rate)) && !some.contains(&named(name, rate)),
                "{name}"
            );
            assert!(some.contains(&named(name, angle)), "{name}");
        }
        for name in ["abs", "sign"] {
            assert!(some.contains(&named(name, rate)), "{name}");
        }
    }
}
