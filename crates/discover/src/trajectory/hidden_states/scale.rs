//! The scale of hidden states in an answer: one rule, reported with it.
//!
//! In: a problem, the fit to it. Out: both in another scale. Laws made of powers of a hidden state hold for any multiple of it. The rule:
//! the first term of another law that contains the state gets the coefficient 1. It gets −1 where no real multiple of the state gives 1, or
//! where the state's own law is given and a negative multiple would be needed. That coefficient is then no estimate, and the errors of the
//! others are those given it.

use super::hidden_laws::hidden_laws;
use super::thresholds::HIDDEN;
use crate::trajectory::likelihood::fit;
use crate::trajectory::model::{CoefficientConstraints, LinearizationPoint, Problem};
use crate::trajectory::search::{Found, last_criterion};
use sidc_lang::model::Reset;
use sidc_lang::term::{Atom, Expr, Signal, Term, VarId};
use sidc_progress::Observer;
use sidc_solve::{LinearConstraint, Sense};

/// What fixes the scale of a hidden state.
#[derive(Clone, Debug, PartialEq)]
pub struct ReportedScale {
    pub state: Signal,
    /// The law and its term whose coefficient is set, and to what.
    pub target: Signal,
    pub term: Term,
    pub coefficient: f64,
}

/// The power of a variable in a term; `None` where it stands inside another expression.
fn power_in(term: &Term, var: VarId) -> Option<f64> {
    let own = |a: &Atom| matches!(a, Atom::Signal(s) if s.var == var);
    let rest = term.part(|a| !own(a));
    let mut inside = false;
    rest.for_each_signal(&mut |s| inside |= s.var == var);
    let factors = term.factors().filter(|(a, _)| own(a));
    (!inside).then(|| factors.map(|(_, p)| p).sum())
}

/// Whether the laws hold for any multiple of the hidden state of law `l`, whatever columns are chosen.
pub(super) fn is_free(problem: &Problem, l: usize) -> bool {
    let system = &problem.system;
    let var = system.laws[l].target.var;
    let silent = |e: &Expr| -> bool {
        let mut found = false;
        e.for_each_signal(&mut |s| found |= s.var == var);
        !found
    };
    let own = &system.laws[l];
    let homogeneous = |e: &Expr| e.terms().all(|(_, t)| power_in(t, var) == Some(1.0));
    // A jump to a number has that number's scale.
    let sets =
        |r: &Reset| r.jumps.iter().any(|(s, _)| s.var == var) || !r.expressions().all(silent);
    if system.resets.iter().any(sets) {
        return false;
    }
    let mut others = (0..system.laws.len()).filter(|other| *other != l);
    homogeneous(&own.known)
        && others.all(|other| silent(&system.laws[other].known))
        && system.columns.iter().all(|t| power_in(t, var).is_some())
}

/// The fit in the scales that the rule gives, with the coefficients that fix them; `None` where no scale is free, or where the fit in that
/// scale fails.
pub(crate) fn with_told_scales(
    problem: &Problem,
    found: &Found,
    observer: &mut dyn Observer,
) -> Option<(Problem, Found, Vec<ReportedScale>)> {
    let (given, sought) = hidden_laws(problem);
    let laws = given.into_iter().chain(sought);
    let (mut scaled, mut point) = (problem.clone(), found.best.point.clone());
    let mut told = Vec::new();
    for l in laws.filter(|l| is_free(problem, *l)) {
        told.extend(rescale(&mut scaled, &mut point, l));
    }
    if told.is_empty() {
        return None;
    }
    scaled.pins.clear();
    let criterion = last_criterion(problem, found.inefficiency);
    // How far a hidden state may slip depends on the course that the fit starts from, so the course is renewed.
    for _ in 0..HIDDEN.courses_renewed {
        let near = fit(&scaled, point, &criterion, f64::INFINITY, observer)?;
        scaled = scaled.with_hidden_of(&near, &[], None);
        point = near.point;
    }
    let found = found.refitted(&scaled, point, observer)?;
    Some((scaled, found, told))
}

/// Multiplies the hidden state of law `l`, so that the coefficient that fixes its scale is ±1.
fn rescale(
    problem: &mut Problem,
    point: &mut LinearizationPoint,
    l: usize,
) -> Option<ReportedScale> {
    let system = &problem.system;
    let law = system.laws[l].clone();
    let var = law.target.var;
    let power = |j: usize| power_in(&system.columns[j], var).unwrap_or(0.0);
    let active = point.active();
    let other = |j: &usize| !law.columns.contains(j) && power(*j) != 0.0;
    let (first, c) = active
        .iter()
        .copied()
        .find(|(j, a)| other(j) && *a != 0.0)?;
    let p = power(first);
    let odd = |p: f64| p.fract() == 0.0 && p as i64 % 2 != 0;
    // A negative multiple is possible only if all powers of the state are whole numbers.
    let whole = active.iter().all(|(j, _)| power(*j).fract() == 0.0);
    let signed = odd(p) && whole && !law.columns.is_empty();
    let size = c.abs().powf(1.0 / p);
    let by = if signed { c.signum() * size } else { size };
    if !by.is_finite() || by == 0.0 {
        return None;
    }
    let coefficients = active.iter().map(|(j, a)| {
        let own = if law.columns.contains(j) { by } else { 1.0 };
        a * own * raised(by, -power(*j))
    });
    point.coefficients = coefficients.collect();
    let set = if signed { 1.0 } else { c.signum() };
    let order = usize::from(law.target.der);
    let n = problem.system.states.len();
    let told = ReportedScale {
        state: Signal::new(var),
        target: problem.system.laws[problem.system.law_of(first)].target,
        term: problem.term(first).clone(),
        coefficient: set,
    };
    for i in law.state + 1 - order..=law.state {
        let times = |rows: &mut [f64], by: f64| {
            rows.iter_mut().skip(i).step_by(n).for_each(|x| *x *= by);
        };
        point.paths.iter_mut().for_each(|path| times(path, by));
        times(&mut point.sigma, by.abs());
        times(&mut problem.noise, by.abs());
        let curves = problem.smoothed.iter_mut();
        curves.for_each(|curve| times(&mut curve.states, by));
        problem.spread[i] *= by.abs();
    }
    let mut constraints = problem.system.constraints.clone();
    constraints.rows.push(LinearConstraint {
        entries: vec![(0, first, 1.0)],
        sense: Sense::Equal,
        right: set,
    });
    // The row that fixes the scale comes from no statement of the model.
    constraints.stated.push(usize::MAX);
    problem.system.constraints = CoefficientConstraints { ..constraints };
    Some(told)
}

/// A power that keeps the sign of a negative base with a whole exponent.
fn raised(base: f64, p: f64) -> f64 {
    match p.fract() == 0.0 {
        true => base.powi(p as i32),
        false => base.powf(p),
    }
}
