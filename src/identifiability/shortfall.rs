//! What the library lacks, where its terms do not explain the target.
//!
//! In: a frame whose equation leaves more than the data's error. Out: a simple term of the measured signals that explains what is
//! left, or that the target follows a law of its own (the variable has a higher order than declared), or neither. Suggests; never
//! changes the equation.

use super::frame::Frame;
use super::project::{Basis, dot, norm};
use crate::data::Samples;
use crate::dictionary::evaluate;
use crate::library::Library;
use crate::term::{Expr, Func, Signal, Term, VarId};

/// Largest library whose whole span is taken off.
const SPAN: usize = 150;
/// Factor by which a missing term has to lower what is left.
const LOWERED: f64 = 4.0;
/// Part of the target left under which nothing is missing.
const CLOSE: f64 = 1e-4;
/// Relative residual of the target's own derivative that speaks for a higher order.
const FOLLOWS: f64 = 0.15;
/// Rows looked at.
const ROWS: usize = 1500;

#[derive(Clone, Debug)]
pub(super) enum Shortfall {
    /// This term lowers what is left by this factor.
    Term(Term, f64),
    /// The target's derivative follows from the target and the library to this part.
    Order(f64),
    /// Nothing simple.
    Unknown,
}

/// What the library lacks, with what the equation leaves of the target.
pub(super) fn shortfall(frame: &Frame, library: &Library) -> Option<(Shortfall, f64)> {
    let step = frame.rows().div_ceil(ROWS).max(1);
    let rows: Vec<usize> = (0..frame.rows()).step_by(step).collect();
    let thin = |v: &[f64]| -> Vec<f64> { rows.iter().map(|r| v[*r]).collect() };
    let target = thin(&frame.target);
    let places: Vec<usize> = match frame.columns.len() {
        n if n <= SPAN && 3 * n <= rows.len() => (0..n).collect(),
        _ => frame.support.clone(),
    };
    let columns: Vec<Vec<f64>> = places.iter().map(|p| thin(frame.unit(*p))).collect();
    let basis = Basis::of(columns.iter().map(|c| &c[..]));
    let left = basis.outside(&target);
    let part = norm(&left) / norm(&target).max(f64::MIN_POSITIVE);
    let allowed = (3.0 * frame.evidence.target_error).max(CLOSE);
    if part < allowed {
        return None;
    }
    let samples = frame.samples.select(&rows);
    let weights = thin(&frame.weights);
    if let Some((term, factor)) = missing(frame, library, &samples, &weights, &basis, &left) {
        return Some((Shortfall::Term(term, factor), part));
    }
    let follows = follows(frame, &places);
    Some(match follows {
        Some(rest) if rest < FOLLOWS && rest < part => (Shortfall::Order(rest), part),
        _ => (Shortfall::Unknown, part),
    })
}

/// The simple term that explains most of what is left.
fn missing(
    frame: &Frame,
    library: &Library,
    samples: &Samples,
    weights: &[f64],
    basis: &Basis,
    left: &[f64],
) -> Option<(Term, f64)> {
    let square = dot(left, left);
    let mut best: Option<(f64, Term)> = None;
    for term in simple(frame) {
        if library.contains(&term).is_some() {
            continue;
        }
        let values = evaluate(&term, samples);
        let weighted: Vec<f64> = values.iter().zip(weights).map(|(v, w)| v * w).collect();
        let length = norm(&weighted);
        if !length.is_finite() || length == 0.0 {
            continue;
        }
        let own = basis.outside(&weighted);
        let room = dot(&own, &own);
        if room < 1e-16 * length * length {
            continue;
        }
        let gain = dot(&own, left).powi(2) / room;
        // Of two that do as well, the simpler one, which comes first.
        if best.as_ref().is_none_or(|(g, _)| gain > *g + 1e-3 * (square - g)) {
            best = Some((gain, term));
        }
    }
    let (gain, term) = best?;
    let factor = (square / (square - gain).max(1e-30 * square)).sqrt();
    (factor > LOWERED).then_some((term, factor))
}

/// Simple terms of the signals at hand, the simplest first.
fn simple(frame: &Frame) -> Vec<Term> {
    let target = frame.equation.target;
    let usable = |s: &Signal| {
        let own = s.var == target.var && (s.der >= target.der && s.shift >= target.shift);
        s.var != VarId::TIME && !own && s.shift <= 0 && (s.der == 0 || s.der < 2)
    };
    let signals: Vec<Signal> = (frame.samples.columns.iter())
        .map(|c| c.signal)
        .filter(usable)
        .take(8)
        .collect();
    let bare: Vec<Term> = signals.iter().map(|s| Term::signal(*s)).collect();
    let mut all = vec![Term::one()];
    all.extend(bare.iter().cloned());
    for (i, a) in bare.iter().enumerate() {
        all.extend(bare[i..].iter().map(|b| a.mul(b)));
    }
    let mut functions = Vec::new();
    for name in ["sin", "cos", "abs", "sign", "exp", "tanh", "sqrt", "log"] {
        let Some(f) = Func::named(name) else { continue };
        let of = |s: &Signal| Expr::call(f, vec![Expr::signal(*s)]).into_term().1;
        functions.extend(signals.iter().map(of));
    }
    all.extend(functions.iter().cloned());
    all.extend(bare.iter().map(|a| a.pow(-1.0)));
    for f in &functions {
        all.extend(bare.iter().map(|a| a.mul(f)));
    }
    for (i, a) in bare.iter().enumerate() {
        for (j, b) in bare.iter().enumerate().skip(i) {
            all.extend(bare[j..].iter().map(|c| a.mul(b).mul(c)));
        }
    }
    all
}

/// What the library, the target and their products with the bare signals leave of the target's own derivative.
fn follows(frame: &Frame, places: &[usize]) -> Option<f64> {
    let own = frame.equation.target;
    if own.der == 0 {
        return None;
    }
    let all = frame.all;
    let values = &all.column(own)?.values;
    let inner = (1..all.len().saturating_sub(1)).filter(|k| {
        let same = all.trajectory[k - 1] == all.trajectory[k + 1];
        same && all.time[k + 1] > all.time[k - 1]
    });
    let inner: Vec<usize> = inner.collect();
    let step = inner.len().div_ceil(ROWS).max(1);
    let rows: Vec<usize> = inner.into_iter().step_by(step).collect();
    let slope = |k: &usize| (values[k + 1] - values[k - 1]) / (all.time[k + 1] - all.time[k - 1]);
    let slopes: Vec<f64> = rows.iter().map(slope).collect();
    let samples = all.select(&rows);
    let mut terms: Vec<Term> = places.iter().map(|p| frame.term(*p).clone()).collect();
    let target = Term::signal(own);
    let bare = samples.columns.iter().map(|c| c.signal);
    let bare: Vec<Signal> = bare.filter(|s| *s != own && s.der == 0).take(4).collect();
    terms.push(target.clone());
    terms.extend(bare.iter().map(|s| target.mul(&Term::signal(*s))));
    terms.extend(bare.iter().map(|s| target.mul(&Term::signal(*s).pow(2.0))));
    if rows.len() < 3 * terms.len() {
        return None;
    }
    let columns: Vec<Vec<f64>> = terms.iter().map(|t| evaluate(t, &samples)).collect();
    if columns.iter().flatten().chain(&slopes).any(|v| !v.is_finite()) {
        return None;
    }
    let basis = Basis::of(columns.iter().map(|c| &c[..]));
    Some(norm(&basis.outside(&slopes)) / norm(&slopes).max(f64::MIN_POSITIVE))
}

