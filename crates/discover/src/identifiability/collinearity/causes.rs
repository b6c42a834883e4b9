//! Why a relation holds: recognised from its terms, the ranges of its signals, and whether it holds for other values too.
//!
//! In: a relation between terms, the design it was found on. Out: a [`Cause`], with what advice needs of it. Tests run from the
//! certain (a constant signal, an identity) to the merely likely; the first that holds names the cause.

use super::identity_test::{Validity, proportional_with_one_sign, validity};
use super::relation::{ReducedRelation, RelationCause};
use crate::identifiability::excitation::{central_range, range};
use crate::identifiability::thresholds::{COLLINEARITY, NULL_VECTORS};
use crate::scaled_design::ScaledDesign;
use sidc_lang::model::VarKind;
use sidc_lang::term::{Atom, Expr, Signal, Term};
use sidc_system::discovery::Cause;

/// The cause of a relation.
pub fn cause(design: &ScaledDesign, reduced: &ReducedRelation) -> RelationCause {
    let plain = |cause| RelationCause { cause, about: None };
    let because = |cause, about| RelationCause {
        cause,
        about: Some(about),
    };
    let one_sign = |signals: &[Signal]| RelationCause {
        cause: Cause::OneSign,
        about: signal_of_one_sign(design, &signals_in_functions_first(reduced, signals)),
    };
    let mut signals = reduced.signals();
    // An unknown constant is no signal that an experiment could vary, so the relation is judged at the value found for it.
    let unknowns = &design.model.unknowns;
    signals.retain(|s| unknowns.iter().all(|u| u.var != s.var));
    if let Some(constant) = signals.iter().find_map(|s| constant_signal(design, *s)) {
        return because(Cause::ConstantSignal, constant);
    }
    let exact = reduced.residual < COLLINEARITY.exact;
    if exact {
        match validity(design, reduced, &signals) {
            Validity::AllValues => return plain(Cause::Identity),
            Validity::SameSigns => return one_sign(&signals),
            Validity::DataOnly => {}
        }
    }
    if proportional_with_one_sign(design, reduced, &signals) {
        return one_sign(&signals);
    }
    if let Some(argument) = common_argument(reduced, &signals) {
        let (least, most) = range(&argument, &design.samples);
        let near_zero = least.abs().max(most.abs()) < COLLINEARITY.away_from_zero * (most - least);
        // Powers do not become more collinear near zero, as functions do, so only a narrow range explains their relation.
        if is_powers(reduced) || !near_zero {
            let (least, most) = central_range(&argument, &design.samples);
            return because(Cause::NarrowRange, (argument, least, most));
        }
        return because(Cause::SmallRange, (argument, least, most));
    }
    if let Some(order) = lower_order(design, reduced) {
        return order;
    }
    if is_law_of_motion(design, reduced, &signals) {
        return plain(Cause::Law);
    }
    if let Some(input) = signals.iter().find(|s| is_input(design, **s)) {
        let input = Expr::signal(*input);
        let (least, most) = range(&input, &design.samples);
        return because(Cause::Feedback, (input, least, most));
    }
    let states = signals.iter().all(|s| design.is_state(*s) && s.shift == 0);
    let linear = |t: &Term| t.is_one() || is_bare(t);
    // Many functions with a common factor are nearly collinear: such a sum counts only if it is exact.
    let no_factor = reduced.common.is_one() || exact;
    let sum = no_factor && reduced.terms.iter().all(|(_, t)| linear(t));
    // States on a common curve satisfy many relations approximately. Only a sum, or an exact relation of few terms, is a conserved
    // quantity.
    let short = reduced.has_constant()
        && reduced.terms.len() <= COLLINEARITY.conserved_terms
        && reduced.residual < NULL_VECTORS.rounding;
    if states && !signals.is_empty() && (sum || short) {
        return plain(Cause::Conserved);
    }
    plain(Cause::Coincidence)
}

/// Whether all terms are products of powers of signals.
fn is_powers(reduced: &ReducedRelation) -> bool {
    let mut atoms = reduced.terms.iter().flat_map(|(_, t)| t.factors());
    atoms.all(|(atom, _)| matches!(atom, Atom::Signal(_)))
}

/// Whether a term is a single signal.
pub fn is_bare(t: &Term) -> bool {
    let mut factors = t.factors();
    match (factors.next(), factors.next()) {
        (Some((Atom::Signal(_), power)), None) => power == 1.0,
        _ => false,
    }
}

fn is_input(design: &ScaledDesign, s: Signal) -> bool {
    let kind = design.model.var(s.var).map(|v| v.kind);
    matches!(
        kind,
        Some(VarKind::Input | VarKind::Param | VarKind::Unknown)
    )
}

/// A signal that does not vary, with its range.
fn constant_signal(design: &ScaledDesign, s: Signal) -> Option<(Expr, f64, f64)> {
    let e = Expr::signal(s);
    let (least, most) = range(&e, &design.samples);
    let size = least.abs().max(most.abs());
    let part = match is_input(design, s) {
        true => COLLINEARITY.constant_input,
        false => COLLINEARITY.constant_signal,
    };
    (most - least <= part * size).then_some((e, least, most))
}

/// The first signal that never changes its sign, or else the first.
fn signal_of_one_sign(design: &ScaledDesign, signals: &[Signal]) -> Option<(Expr, f64, f64)> {
    let ranged = signals.iter().map(|s| {
        let e = Expr::signal(*s);
        let (least, most) = range(&e, &design.samples);
        (e, least, most)
    });
    let mut all: Vec<(Expr, f64, f64)> = ranged.collect();
    let at = all.iter().position(|(_, a, b)| *a >= 0.0 || *b <= 0.0);
    (!all.is_empty()).then(|| all.swap_remove(at.unwrap_or(0)))
}

/// Signals inside functions first, since the sign matters to abs, sign and roots.
fn signals_in_functions_first(reduced: &ReducedRelation, signals: &[Signal]) -> Vec<Signal> {
    let mut inside = Vec::new();
    for (atom, _) in reduced.terms.iter().flat_map(|(_, t)| t.factors()) {
        if !matches!(atom, Atom::Signal(_)) {
            atom.for_each_signal(&mut |s| inside.push(s));
        }
    }
    let (mut first, others): (Vec<_>, Vec<_>) = signals.iter().partition(|s| inside.contains(s));
    first.extend(others);
    first
}

/// What all terms are functions of: a single signal, or the common argument of their functions.
fn common_argument(reduced: &ReducedRelation, signals: &[Signal]) -> Option<Expr> {
    if let [one] = signals {
        return Some(Expr::signal(*one));
    }
    let mut arguments: Vec<&Expr> = Vec::new();
    for (atom, _) in reduced.terms.iter().flat_map(|(_, t)| t.factors()) {
        match atom {
            Atom::Call(_, args) => arguments.extend(args.iter()),
            Atom::Sum(e) => arguments.push(e),
            Atom::Signal(_) => return None,
        }
    }
    let first = *arguments.first()?;
    arguments.iter().all(|a| *a == first).then(|| first.clone())
}

/// A derivative of the target's variable that is a function of lower ones and other signals: a law of that order.
fn lower_order(design: &ScaledDesign, reduced: &ReducedRelation) -> Option<RelationCause> {
    let target = design.equation.target;
    let of_target = |s: &Signal| s.var == target.var && s.shift == 0;
    let signals = reduced.signals();
    let highest = signals
        .iter()
        .filter(|s| of_target(s))
        .map(|s| s.der)
        .max()?;
    let bare = Term::signal(Signal::derivative(target.var, highest));
    let containing = reduced.terms.iter().filter(|(_, t)| {
        let mut mentions = false;
        t.for_each_signal(&mut |s| mentions |= of_target(&s) && s.der == highest);
        mentions
    });
    let containing: Vec<&Term> = containing.map(|(_, t)| t).collect();
    let linear = containing.len() == 1 && *containing[0] == bare;
    (highest > 0 && highest < target.der && linear).then(|| {
        let e = Expr::from(bare);
        let (least, most) = range(&e, &design.samples);
        RelationCause {
            cause: Cause::WrongOrder,
            about: Some((e, least, most)),
        }
    })
}

/// Whether it contains the highest derivative of some variable, or only derivatives of one variable: a law of motion.
fn is_law_of_motion(design: &ScaledDesign, reduced: &ReducedRelation, signals: &[Signal]) -> bool {
    let targets = design.model.equations.iter().map(|e| e.target);
    let targets: Vec<Signal> = targets.filter(|t| t.der > 0 || t.shift > 0).collect();
    let of_one = |s: &Signal| signals.iter().all(|t| t.var == s.var) && s.der > 0;
    signals.iter().any(|s| targets.contains(s) || of_one(s)) && reduced.terms.len() > 1
}
