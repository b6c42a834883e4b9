//! Integrals of terms against test functions, by Gauss–Legendre quadrature between samples.
//!
//! In: a segment with every signal at the nodes, test functions, terms. Out: ∫ψ φ dt for each test function. Chooses nothing.

use crate::dictionary::evaluate;
use sidc_lang::term::Term;

use super::integration_by_parts::integrate_by_parts;
use super::segments::Segment;
use super::signal_sources::EquationSignals;
use super::test_functions::{GAUSS_NODES, TestFunction};

/// ∫ψ φ dt of one term for every test function, by parts where possible.
pub(super) fn integral(
    term: &Term,
    sources: &EquationSignals,
    segment: &Segment,
    windows: &[TestFunction],
) -> Vec<f64> {
    let measure = measure(&segment.time);
    let mut out = vec![0.0; windows.len()];
    let lowered = integrate_by_parts(term, sources).filter(|_| sources.target.1 > 1);
    let Some(lowered) = lowered else {
        let mut values = evaluate(term, &segment.nodes);
        project(windows, &measure, &mut values, &mut out);
        return out;
    };
    let mut values = vec![0.0; segment.nodes.len()];
    for (weight, term) in lowered.rest.terms() {
        let part = evaluate(term, &segment.nodes);
        values
            .iter_mut()
            .zip(part)
            .for_each(|(v, p)| *v -= weight * p);
    }
    project(windows, &measure, &mut values, &mut out);
    let moved = evaluate(&lowered.moved, &segment.nodes);
    let moved: Vec<f64> = moved.iter().zip(&measure).map(|(v, m)| v * m).collect();
    for (o, w) in out.iter_mut().zip(windows) {
        *o -= dot(&w.slopes, &moved[GAUSS_NODES.len() * w.first..]);
    }
    out
}

/// Quadrature weights of all nodes: ∫ f dt = Σ weight · f.
pub(super) fn measure(time: &[f64]) -> Vec<f64> {
    let steps = time.windows(2).map(|w| 0.5 * (w[1] - w[0]));
    steps
        .flat_map(|h| GAUSS_NODES.map(|(_, w)| h * w))
        .collect()
}

/// ∫ψ f dt for every test function; `values` of f are weighted in place.
pub(super) fn project(
    windows: &[TestFunction],
    measure: &[f64],
    values: &mut [f64],
    out: &mut [f64],
) {
    values.iter_mut().zip(measure).for_each(|(v, m)| *v *= m);
    for (o, w) in out.iter_mut().zip(windows) {
        *o = dot(&w.values, &values[GAUSS_NODES.len() * w.first..]);
    }
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
