//! Misspecification: a library that lacks a term, or a variable whose order is declared wrong.
//!
//! In: a library, a doubted equation, rows with the measured target. Out: a simple term of the measured signals that explains the
//! residual, or a higher or lower order of the variable, or neither. Never changes the equation.

use super::lacking_terms::Residual;
use crate::Weights;
use crate::dictionary::{evaluate, subtract};
use crate::identifiability::thresholds::MISSPECIFICATION;
use crate::scaled_design::OrthonormalBasis;
use crate::statistics::norm;
use sidc_data::{Origin, Samples};
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_lang::term::{Signal, Term};
use sidc_solve::simd::dot;
use sidc_system::discovery::Equation;

/// Parts and residuals are relative to the target, or to the derivative that is explained.
#[derive(Clone, Debug)]
pub enum Misspecification {
    /// This term divides the residual, which is that part of the target, by this factor.
    MissingTerm { term: Term, factor: f64, part: f64 },
    /// The derivative of the target is a function of the target and the library, up to a residual.
    OrderTooLow { residual: f64, part: f64 },
    /// The derivative below the target is a function of the library's other terms.
    OrderTooHigh { residual: f64 },
    /// No simple explanation.
    Unknown { part: f64 },
}

/// What the model states of an equation, and whether the equation found explains the target.
pub struct Specification<'a> {
    pub model: &'a Model,
    pub library: &'a Library,
    pub equation: &'a Equation,
    pub unexplained: bool,
}

/// The target on some rows, projected off the span of the library.
struct Projection {
    samples: Samples,
    terms: Vec<Term>,
    /// Whether these are all terms of the library, so that what is left is left by all of it.
    whole: bool,
    weights: Vec<f64>,
    basis: OrthonormalBasis,
    /// Weighted.
    residual: Vec<f64>,
    /// The length of the residual that noise explains.
    noise: f64,
    /// The residual relative to the target.
    part: f64,
}

pub fn find_misspecification(
    specification: &Specification,
    all: &Samples,
) -> Option<Misspecification> {
    let target = specification.equation.target;
    let projection = Projection::new(specification, all)?;
    if let Some(residual) = lower_order(&projection, target) {
        return Some(Misspecification::OrderTooHigh { residual });
    }
    let part = projection.part;
    let size = norm(&projection.residual) / part.max(f64::MIN_POSITIVE);
    let noise = MISSPECIFICATION.noise * projection.noise / size;
    if !specification.unexplained || part < MISSPECIFICATION.negligible.max(noise) {
        return None;
    }
    if let Some((term, factor)) = missing_term(specification, &projection) {
        return Some(Misspecification::MissingTerm { term, factor, part });
    }
    match higher_order(&projection, all, target) {
        Some(residual) if residual < part => Some(Misspecification::OrderTooLow { residual, part }),
        // Terms of the library that were not found may explain it.
        _ => projection
            .whole
            .then_some(Misspecification::Unknown { part }),
    }
}

impl Projection {
    fn new(specification: &Specification, all: &Samples) -> Option<Projection> {
        let target = specification.equation.target;
        let step = all.len().div_ceil(MISSPECIFICATION.max_rows).max(1);
        let rows: Vec<usize> = (0..all.len()).step_by(step).collect();
        let samples = all.select(&rows);
        let mut y = samples.column(target)?.values.clone();
        let fixed = specification.equation.terms.iter().filter(|t| t.fixed);
        subtract(&mut y, fixed.map(|t| (t.coefficient, &t.term)), &samples);
        let weights = Weights::new(&samples, target, specification.library, &y);
        let weighted =
            |v: &[f64]| -> Vec<f64> { v.iter().zip(&weights.row).map(|(v, w)| v * w).collect() };
        let y = weighted(&y);
        let n = specification.library.len();
        let whole =
            n <= MISSPECIFICATION.span_terms && MISSPECIFICATION.span_rows * n <= rows.len();
        let terms: Vec<Term> = match whole {
            true => specification.library.terms().map(|(_, t)| t).collect(),
            false => (specification.equation.terms.iter())
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
        let basis = OrthonormalBasis::of(columns.iter().map(|c| &c[..]));
        let residual = basis.residual(&y);
        Some(Projection {
            part: norm(&residual) / norm(&y).max(f64::MIN_POSITIVE),
            noise: weights.target_error * (rows.len() as f64).sqrt(),
            weights: weights.row,
            samples,
            terms,
            whole,
            basis,
            residual,
        })
    }
}

/// The simple term that explains most of the residual, and the factor by which it lowers it.
fn missing_term(specification: &Specification, l: &Projection) -> Option<(Term, f64)> {
    let square = dot(&l.residual, &l.residual);
    let mut best: Option<(f64, Term)> = None;
    let residual = Residual {
        model: specification.model,
        target: specification.equation.target,
        library: specification.library,
        samples: &l.samples,
        weights: &l.weights,
        basis: &l.basis,
        values: &l.residual,
    };
    for (gain, term) in residual.gains(MISSPECIFICATION.dependent) {
        // Of two that do equally well, the simpler one, which comes first.
        let better = |g: f64| gain > g + MISSPECIFICATION.complexity * (square - g);
        if best.as_ref().is_none_or(|(g, _)| better(*g)) {
            best = Some((gain, term));
        }
    }
    let (gain, term) = best?;
    let noise = l.noise * l.noise;
    let least = MISSPECIFICATION.least_residual * square;
    let beyond_noise = (square - noise) / (square - gain - noise).max(least);
    let factor = (square / (square - gain).max(1e-30 * square)).sqrt();
    let improvement = MISSPECIFICATION.improvement * MISSPECIFICATION.improvement;
    (beyond_noise > improvement).then_some((term, factor))
}

/// The estimated error of a signal relative to the signal.
fn relative_error(samples: &Samples, s: Signal) -> f64 {
    match samples.column(s).map(|c| (&c.origin, &c.values)) {
        Some((Origin::Estimated { error, .. }, values)) => norm(error) / norm(values),
        Some((Origin::Measured { noise: Some(noise) }, values)) => {
            noise.rms(values) * (values.len() as f64).sqrt() / norm(values)
        }
        _ => 0.0,
    }
}

/// The residual of the derivative below the target as a function of the library's other terms, if it is small.
fn lower_order(l: &Projection, target: Signal) -> Option<f64> {
    let below = Signal::derivative(target.var, target.der.checked_sub(1).filter(|d| *d > 0)?);
    let values = &l.samples.column(below)?.values;
    let free_of_it = |t: &&Term| {
        let mut mentions = false;
        t.for_each_signal(&mut |s| mentions |= s.var == target.var && s.der >= below.der);
        !mentions
    };
    let columns = l
        .terms
        .iter()
        .filter(free_of_it)
        .map(|t| evaluate(t, &l.samples));
    let columns: Vec<Vec<f64>> = columns.collect();
    if columns.is_empty() || MISSPECIFICATION.lower_order_rows * columns.len() > values.len() {
        return None;
    }
    let basis = OrthonormalBasis::of(columns.iter().map(|c| &c[..]));
    let residual = norm(&basis.residual(values)) / norm(values).max(f64::MIN_POSITIVE);
    let allowed = MISSPECIFICATION
        .lower_order
        .max(MISSPECIFICATION.lower_order_noise * relative_error(&l.samples, below))
        .min(MISSPECIFICATION.max_lower_order);
    (residual < allowed).then_some(residual)
}

/// The residual of the target's derivative as a function of the library, the target and products of the target with signals, if it
/// is small.
fn higher_order(l: &Projection, all: &Samples, target: Signal) -> Option<f64> {
    if target.der == 0 {
        return None;
    }
    let above = Signal::derivative(target.var, target.der + 1);
    let (samples, slopes) = match all.column(above) {
        Some(_) => (l.samples.clone(), l.samples.column(above)?.values.clone()),
        None => central_differences(all, target)?,
    };
    let bare = samples.columns.iter().map(|c| c.signal);
    let bare = bare
        .filter(|s| *s != target && s.der == 0)
        .take(MISSPECIFICATION.higher_order_signals);
    let target = Term::signal(target);
    let bare: Vec<Term> = bare.map(Term::signal).collect();
    let mut terms = l.terms.clone();
    terms.push(target.clone());
    terms.extend(bare.iter().map(|s| target.mul(s)));
    terms.extend(bare.iter().map(|s| target.mul(&s.pow(2.0))));
    if slopes.len() < MISSPECIFICATION.higher_order_rows * terms.len() {
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
    let basis = OrthonormalBasis::of(columns.iter().map(|c| &c[..]));
    let residual = norm(&basis.residual(&slopes)) / norm(&slopes).max(f64::MIN_POSITIVE);
    let allowed = MISSPECIFICATION
        .higher_order
        .max(MISSPECIFICATION.higher_order_noise * relative_error(&samples, above))
        .min(MISSPECIFICATION.max_higher_order);
    (residual < allowed).then_some(residual)
}

/// Central differences of a signal, on rows that have both neighbours.
fn central_differences(all: &Samples, signal: Signal) -> Option<(Samples, Vec<f64>)> {
    let values = &all.column(signal)?.values;
    let inner = (1..all.len().saturating_sub(1)).filter(|k| {
        let same = all.trajectory[k - 1] == all.trajectory[k + 1];
        same && all.time[k + 1] > all.time[k - 1]
    });
    let inner: Vec<usize> = inner.collect();
    let step = inner.len().div_ceil(MISSPECIFICATION.max_rows).max(1);
    let rows: Vec<usize> = inner.into_iter().step_by(step).collect();
    let slope = |k: &usize| (values[k + 1] - values[k - 1]) / (all.time[k + 1] - all.time[k - 1]);
    let slopes = rows.iter().map(slope).collect();
    Some((all.select(&rows), slopes))
}
