//! Standard terms: what textbooks write into laws, whatever the user's library holds.
//!
//! In: signals. Out: terms of them, the simplest first. Evaluates nothing.

use sidc_lang::term::{Expr, Func, Signal, Term};

/// Functions of one signal that occur in laws.
const FUNCTIONS: [&str; 8] = ["sin", "cos", "abs", "sign", "exp", "tanh", "sqrt", "log"];

/// Those that are also multiplied with signals: `dx*abs(dx)`, `u*cos(x)`.
const FACTORS: [&str; 5] = ["sin", "cos", "abs", "sign", "exp"];

/// Monomials up to degree 3, functions, reciprocals, and products of a signal with a function.
pub(crate) fn standard_terms(signals: &[Signal]) -> Vec<Term> {
    let bare: Vec<Term> = signals.iter().map(|s| Term::signal(*s)).collect();
    let mut all = vec![Term::one()];
    all.extend(bare.iter().cloned());
    for (i, a) in bare.iter().enumerate() {
        all.extend(bare[i..].iter().map(|b| a.mul(b)));
    }
    all.extend(calls(&FUNCTIONS, signals));
    all.extend(bare.iter().map(|a| a.pow(-1.0)));
    for f in calls(&FACTORS, signals) {
        all.extend(bare.iter().map(|a| a.mul(&f)));
    }
    for (i, a) in bare.iter().enumerate() {
        for (j, b) in bare.iter().enumerate().skip(i) {
            all.extend(bare[j..].iter().map(|c| a.mul(b).mul(c)));
        }
    }
    all
}

/// Every function of every signal.
pub(crate) fn calls(names: &[&str], signals: &[Signal]) -> Vec<Term> {
    let functions = names.iter().filter_map(|name| Func::named(name));
    let of = |f, s: &Signal| Expr::call(f, vec![Expr::signal(*s)]).into_term().1;
    functions
        .flat_map(|f| signals.iter().map(move |s| of(f, s)))
        .collect()
}
