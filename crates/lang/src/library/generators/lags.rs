//! `lags(signals; a..b)`: each signal a … b samples back; 0 is the signal itself. Discrete time only.

use crate::library::generators::generator::{Generator, Misuse, whole_range};
use crate::model::NumberArg;
use crate::term::{Atom, Expr, Signal, Term};

pub(crate) struct Lags;

const USAGE: &str = "lags(signals; 0..3)";

impl Generator for Lags {
    fn name(&self) -> &'static str {
        "lags"
    }

    fn usage(&self) -> &'static str {
        USAGE
    }

    fn about(&self) -> &'static str {
        "each signal and its samples a … b steps back (discrete time)"
    }

    fn discrete_only(&self) -> bool {
        true
    }

    fn count(&self, atoms: usize, numbers: &[NumberArg]) -> Result<u128, Misuse> {
        let (from, to) = whole_range(numbers, "lag", 0, USAGE)?;
        Ok(atoms as u128 * u128::from(to - from + 1))
    }

    fn expand(&self, atoms: &[Expr], numbers: &[NumberArg]) -> Result<Vec<Term>, Misuse> {
        let (from, to) = whole_range(numbers, "lag", 0, USAGE)?;
        let mut terms = Vec::new();
        for atom in atoms {
            let signal = plain_signal(atom).ok_or_else(|| Misuse {
                message: "lags shifts signals; this argument is not one".into(),
                at: None,
                help: format!("write {USAGE} and build products around it: poly(lags(y; 0..2); 2)"),
            })?;
            terms.extend((from..=to).map(|k| {
                Term::signal(Signal {
                    shift: signal.shift - k as i32,
                    ..signal
                })
            }));
        }
        Ok(terms)
    }
}

/// The signal, if the expression is nothing else.
fn plain_signal(e: &Expr) -> Option<Signal> {
    let (weight, term) = e.clone().into_term();
    let mut factors = term.factors();
    match (weight, factors.next(), factors.next()) {
        (1.0, Some((Atom::Signal(s), 1.0)), None) => Some(*s),
        _ => None,
    }
}
