//! What the library lacks, where its terms do not explain the target.
//!
//! In: a library, an equation that is doubted, rows with the target as read. Out: a simple term of the measured signals that explains
//! what is left, or that the variable has a higher or a lower order than declared, or neither. Suggests; never changes the equation.

use crate::Weights;
use crate::dictionary::{evaluate, subtract};
use crate::frame::{Basis, norm};
use sidc_data::{Origin, Samples};
use sidc_lang::library::Library;
use sidc_lang::term::{Expr, Func, Signal, Term, VarId};
use sidc_solve::simd::dot;
use sidc_system::discovery::Equation;

/// Largest library whose whole span is taken off.
const SPAN: usize = 150;
/// Factor by which a missing term has to lower what is left beside the noise.
const LOWERED: f64 = 4.0;
/// Part of the target left under which nothing is missing.
const CLOSE: f64 = 1e-4;
/// Relative residual of the target's own derivative that speaks for a higher order: without noise, and at most.
const FOLLOWS: f64 = 0.15;
const FOLLOWS_AT_MOST: f64 = 0.4;
/// The same of a lower derivative for a lower order.
const GIVEN: f64 = 1e-3;
const GIVEN_AT_MOST: f64 = 0.15;
/// Rows looked at.
const ROWS: usize = 1500;
/// Signals that simple terms are made of.
const SIGNALS: usize = 8;

#[derive(Clone, Debug)]
pub(super) enum Shortfall {
    /// This term lowers what is left, a part of the target, by this factor.
    Term { term: Term, factor: f64, part: f64 },
    /// The target's derivative follows from the target and the library but for a rest.
    Higher { rest: f64, part: f64 },
    /// The derivative under the target follows from the library's other terms.
    Lower { rest: f64 },
    /// Nothing simple.
    Unknown { part: f64 },
}

/// What is asked.
pub(super) struct Asked<'a> {
    pub library: &'a Library,
    pub equation: &'a Equation,
    /// Whether something is left that the equation does not explain.
    pub unexplained: bool,
}

/// A target on some rows, and the span of the library there.
struct Left {
    samples: Samples,
    terms: Vec<Term>,
    weights: Vec<f64>,
    basis: Basis,
    /// What the span leaves of the target, weighted.
    left: Vec<f64>,
    /// Length of what noise makes of that.
    noise: f64,
    part: f64,
}

pub(super) fn shortfall(asked: &Asked, all: &Samples) -> Option<Shortfall> {
    let target = asked.equation.target;
    let left = Left::new(asked, all)?;
    if let Some(rest) = lower(&left, target) {
        return Some(Shortfall::Lower { rest });
    }
    let part = left.part;
    let size = norm(&left.left) / part.max(f64::MIN_POSITIVE);
    if !asked.unexplained || part < CLOSE.max(3.0 * left.noise / size) {
        return None;
    }
    if let Some((term, factor)) = missing(asked, &left) {
        return Some(Shortfall::Term { term, factor, part });
    }
    Some(match higher(&left, all, target) {
        Some(rest) if rest < part => Shortfall::Higher { rest, part },
        _ => Shortfall::Unknown { part },
    })
}

impl Left {
    fn new(asked: &Asked, all: &Samples) -> Option<Left> {
        let target = asked.equation.target;
        let step = all.len().div_ceil(ROWS).max(1);
        let rows: Vec<usize> = (0..all.len()).step_by(step).collect();
        let samples = all.select(&rows);
        let mut y = samples.column(target)?.values.clone();
        let fixed = asked.equation.terms.iter().filter(|t| t.fixed);
        subtract(&mut y, fixed.map(|t| (t.coefficient, &t.term)), &samples);
        let weights = Weights::new(&samples, target, asked.library, &y);
        let weighted =
            |v: &[f64]| -> Vec<f64> { v.iter().zip(&weights.row).map(|(v, w)| v * w).collect() };
        let y = weighted(&y);
        let terms: Vec<Term> = match asked.library.len() {
            n if n <= SPAN && 3 * n <= rows.len() => {
                asked.library.terms().map(|(_, t)| t).collect()
            }
            _ => (asked.equation.terms.iter())
                .map(|t| t.term.clone())
                .collect(),
        };
        let columns: Vec<Vec<f64>> = terms
            .iter()
            .map(|t| weighted(&evaluate(t, &samples)))
            .collect();
        if columns.iter().flatten().chain(&y).any(|v| !v.is_finite()) {
            return None;
        }
        let basis = Basis::of(columns.iter().map(|c| &c[..]));
        let left = basis.outside(&y);
        Some(Left {
            part: norm(&left) / norm(&y).max(f64::MIN_POSITIVE),
            noise: weights.target_error * (rows.len() as f64).sqrt(),
            weights: weights.row,
            samples,
            terms,
            basis,
            left,
        })
    }
}

/// The simple term that explains most of what is left.
fn missing(asked: &Asked, l: &Left) -> Option<(Term, f64)> {
    let square = dot(&l.left, &l.left);
    let mut best: Option<(f64, Term)> = None;
    for term in simple(asked, &l.samples) {
        if asked.library.contains(&term).is_some() {
            continue;
        }
        let values = evaluate(&term, &l.samples);
        let weighted: Vec<f64> = values.iter().zip(&l.weights).map(|(v, w)| v * w).collect();
        let length = norm(&weighted);
        if !length.is_finite() || length == 0.0 {
            continue;
        }
        let own = l.basis.outside(&weighted);
        let room = dot(&own, &own);
        if room < 1e-16 * length * length {
            continue;
        }
        let gain = dot(&own, &l.left).powi(2) / room;
        // Of two that do as well, the simpler one, which comes first.
        if best
            .as_ref()
            .is_none_or(|(g, _)| gain > *g + 1e-2 * (square - g))
        {
            best = Some((gain, term));
        }
    }
    let (gain, term) = best?;
    let noise = l.noise * l.noise;
    let beside = (square - noise) / (square - gain - noise).max(1e-3 * square);
    let factor = (square / (square - gain).max(1e-30 * square)).sqrt();
    (beside > LOWERED * LOWERED).then_some((term, factor))
}

/// Simple terms of the signals at hand, the simplest first.
fn simple(asked: &Asked, samples: &Samples) -> Vec<Term> {
    let target = asked.equation.target;
    let usable = |s: &Signal| {
        let own = s.var == target.var && s.der >= target.der && s.shift >= target.shift;
        s.var != VarId::TIME && !own && s.shift <= 0 && s.der < 2
    };
    let held = samples.columns.iter().map(|c| c.signal).filter(usable);
    let signals: Vec<Signal> = held.take(SIGNALS).collect();
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

/// Estimated error of a signal over its size.
fn error(samples: &Samples, s: Signal) -> f64 {
    match samples.column(s).map(|c| (&c.origin, &c.values)) {
        Some((Origin::Estimated { error, .. }, values)) => norm(error) / norm(values),
        Some((Origin::Measured { noise: Some(sigma) }, values)) => {
            sigma * (values.len() as f64).sqrt() / norm(values)
        }
        _ => 0.0,
    }
}

/// What the library's terms without the derivative under the target leave of it, if that is next to nothing.
fn lower(l: &Left, target: Signal) -> Option<f64> {
    let under = Signal::derivative(target.var, target.der.checked_sub(1).filter(|d| *d > 0)?);
    let values = &l.samples.column(under)?.values;
    let without = |t: &&Term| {
        let mut mentions = false;
        t.for_each_signal(&mut |s| mentions |= s.var == target.var && s.der >= under.der);
        !mentions
    };
    let columns = l
        .terms
        .iter()
        .filter(without)
        .map(|t| evaluate(t, &l.samples));
    let columns: Vec<Vec<f64>> = columns.collect();
    if columns.is_empty() || 10 * columns.len() > values.len() {
        return None;
    }
    let basis = Basis::of(columns.iter().map(|c| &c[..]));
    let rest = norm(&basis.outside(values)) / norm(values).max(f64::MIN_POSITIVE);
    let allowed = GIVEN.max(3.0 * error(&l.samples, under)).min(GIVEN_AT_MOST);
    (rest < allowed).then_some(rest)
}

/// What the library, the target and their products with bare signals leave of the target's own derivative, if that is little.
fn higher(l: &Left, all: &Samples, own: Signal) -> Option<f64> {
    if own.der == 0 {
        return None;
    }
    let above = Signal::derivative(own.var, own.der + 1);
    let (samples, slopes) = match all.column(above) {
        Some(_) => (l.samples.clone(), l.samples.column(above)?.values.clone()),
        None => differences(all, own)?,
    };
    let target = Term::signal(own);
    let bare = samples.columns.iter().map(|c| c.signal);
    let bare = bare.filter(|s| *s != own && s.der == 0).take(4);
    let bare: Vec<Term> = bare.map(Term::signal).collect();
    let mut terms = l.terms.clone();
    terms.push(target.clone());
    terms.extend(bare.iter().map(|s| target.mul(s)));
    terms.extend(bare.iter().map(|s| target.mul(&s.pow(2.0))));
    if slopes.len() < 3 * terms.len() {
        return None;
    }
    let columns: Vec<Vec<f64>> = terms.iter().map(|t| evaluate(t, &samples)).collect();
    if columns
        .iter()
        .flatten()
        .chain(&slopes)
        .any(|v| !v.is_finite())
    {
        return None;
    }
    let basis = Basis::of(columns.iter().map(|c| &c[..]));
    let rest = norm(&basis.outside(&slopes)) / norm(&slopes).max(f64::MIN_POSITIVE);
    let allowed = FOLLOWS
        .max(2.0 * error(&samples, above))
        .min(FOLLOWS_AT_MOST);
    (rest < allowed).then_some(rest)
}

/// Central differences of a signal, on rows with both neighbours.
fn differences(all: &Samples, own: Signal) -> Option<(Samples, Vec<f64>)> {
    let values = &all.column(own)?.values;
    let inner = (1..all.len().saturating_sub(1)).filter(|k| {
        let same = all.trajectory[k - 1] == all.trajectory[k + 1];
        same && all.time[k + 1] > all.time[k - 1]
    });
    let inner: Vec<usize> = inner.collect();
    let step = inner.len().div_ceil(ROWS).max(1);
    let rows: Vec<usize> = inner.into_iter().step_by(step).collect();
    let slope = |k: &usize| (values[k + 1] - values[k - 1]) / (all.time[k + 1] - all.time[k - 1]);
    let slopes = rows.iter().map(slope).collect();
    Some((all.select(&rows), slopes))
}
