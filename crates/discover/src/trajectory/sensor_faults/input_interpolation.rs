//! Interpolation of inputs between their samples: how much of the coefficients' errors it causes.
//!
//! In: a problem, what was found. Out: variances of the coefficients that hold this too. Where a record is as likely under inputs that run
//! along cubics, the coefficients of that fit are as good as those found. Both count by their likelihood (Hoeting, Madigan, Raftery and
//! Volinsky 1999, Bayesian model averaging): the variance is that of the fit plus weight × (difference)². Changes no coefficient.

use crate::trajectory::likelihood::fit;
use crate::trajectory::model::{Problem, Record};
use crate::trajectory::search::{Found, last_criterion};
use crate::trajectory::thresholds::INTERPOLATION;
use sidc_lang::term::Signal;
use sidc_progress::Observer;

/// Adds to the variances of the coefficients what they owe to inputs that are straight between samples.
pub fn widen_by_interpolation(problem: &Problem, found: &mut Found, observer: &mut dyn Observer) {
    let best = &found.best;
    if !bends(problem) || best.variances.len() != best.support().len() || !observer.go_on() {
        return;
    }
    let records = problem.records.iter().map(|r| Record {
        curved: true,
        ..r.clone()
    });
    let mut curved = problem.clone();
    curved.records = records.collect();
    let criterion = last_criterion(problem, found.inefficiency);
    let from = best.point.clone();
    let Some(curved) = fit(&curved, from, &criterion, f64::INFINITY, observer) else {
        return;
    };
    let evidence = (curved.value - best.value) / found.inefficiency;
    let weight = 1.0 / (1.0 + (0.5 * evidence).exp());
    if best.support() != curved.support() || !weight.is_finite() {
        return;
    }
    let pairs = best.coefficients().iter().zip(curved.coefficients());
    let moved: Vec<f64> = pairs.map(|(a, b)| weight * (a - b).powi(2)).collect();
    for (variance, moved) in found.best.variances.iter_mut().zip(moved) {
        *variance += moved;
    }
}

/// True if some exogenous signal is neither held nor straight by itself.
fn bends(problem: &Problem) -> bool {
    let bent = |record: &Record, x: usize| {
        let Some(o) = record.exogenous.get(x).filter(|o| !o.held) else {
            return false;
        };
        let size = o.values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        let second = |w: &[f64]| (w[2] - 2.0 * w[1] + w[0]).abs();
        let largest = o.values.windows(3).map(second).fold(0.0, f64::max);
        largest > INTERPOLATION.straight * size
    };
    let signals = problem.system.exogenous.iter().enumerate();
    let mut signals = signals.filter(|(_, s)| **s != Signal::TIME);
    signals.any(|(x, _)| problem.records.iter().any(|r| bent(r, x)))
}
