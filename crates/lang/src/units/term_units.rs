//! Units of terms, from the units of their signals.
//!
//! In: a term, and the unit of each signal. Out: its unit; `None` if a signal has none or a number may carry one.

use crate::term::{Atom, Expr, Signal, Term, UnitRule};
use crate::units::unit::Unit;

/// What time is counted in: samples in discrete time, seconds if no unit was declared.
pub fn of_time(discrete: bool, declared: Option<&Unit>) -> String {
    match declared {
        _ if discrete => "samples".into(),
        Some(unit) => unit.to_string(),
        None => "s".into(),
    }
}

/// The unit of a derivative: the variable's unit per the unit of time to the power `order`.
pub fn derivative(variable: &Unit, time: &Unit, order: u8) -> Option<Unit> {
    variable.per(&time.power(f64::from(order))?)
}

/// The unit of a term's coefficient: target per term, simplified. A term that is a pure number leaves the target's unit as declared.
pub fn coefficient(target: &Unit, term: &Unit) -> Option<Unit> {
    if term.is_one() {
        return Some(target.clone());
    }
    target.per(term).map(Unit::shortened)
}

/// The unit of a product of powers.
pub fn of_term(term: &Term, signal: &impl Fn(Signal) -> Option<Unit>) -> Option<Unit> {
    let mut out = Unit::one();
    for (atom, power) in term.factors() {
        out = out.times(&of_atom(atom, signal)?.power(power)?)?;
    }
    Some(out)
}

fn of_atom(atom: &Atom, signal: &impl Fn(Signal) -> Option<Unit>) -> Option<Unit> {
    match atom {
        Atom::Signal(s) => signal(*s),
        Atom::Sum(e) => of_sum(e, signal),
        Atom::Call(f, args) => match f.units {
            UnitRule::Pure | UnitRule::Lost => Some(Unit::one()),
            UnitRule::Kept => args.iter().find_map(|a| of_sum(a, signal)),
            UnitRule::Root => of_sum(args.first()?, signal)?.power(0.5),
        },
    }
}

/// The unit of the first summand that has one, since all summands have the same. A number in front of a term may carry a unit, so
/// only terms with weight ±1 count.
fn of_sum(e: &Expr, signal: &impl Fn(Signal) -> Option<Unit>) -> Option<Unit> {
    let bare = e.terms().filter(|(k, t)| k.abs() == 1.0 && !t.is_one());
    bare.into_iter().find_map(|(_, t)| of_term(t, signal))
}
