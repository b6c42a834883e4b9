//! The optimality certificate of an equation: what the dual point proves about the terms that are printed.
//!
//! In: a problem, the dual point of its solver, the selection. Out: figures of the evidence, and the witness from which they can be
//! verified. Never changes coefficients.

use crate::selection::term_selection::TermSelection;
use crate::statistics::norm;
use sidc_solve as solve;
use sidc_solve::{Certificate, Problem, Refit, Solution};
use sidc_system::discovery::Proof;
use sidc_system::discovery::Witness;

/// The certificate of the printed answer if the solver proposed it and it is proved, else of the solver's proposal; and the
/// witness without its rows.
pub(crate) fn certify(
    problem: &Problem,
    solution: &Solution,
    selection: &TermSelection,
    polished: &Refit,
) -> (Proof, Witness) {
    let (own, moved) = certify_answer(problem, solution, selection, polished);
    let of_answer = selection.as_proposed && own.proves_optimal;
    let (certificate, tolerance) = if of_answer {
        (own, problem.tolerance)
    } else {
        certify_proposal(problem, solution)
    };
    let own_dual = || solution.dual.clone();
    let witness = Witness {
        tolerance,
        dual: moved.filter(|_| of_answer).unwrap_or_else(own_dual),
        proposal: (!of_answer).then(|| solution.coefficients.clone()),
        ..Witness::default()
    };
    let proof = Proof {
        tolerance: tolerance / norm(problem.target),
        gap: finite(certificate.gap),
        max_correlation: finite(certificate.largest_correlation),
        margin: finite(certificate.margin),
        rank: polished.rank,
        support: selection.support.len(),
        condition: finite(polished.condition),
        optimal: certificate.proves_optimal,
        unique: certificate.proves_unique,
        of_answer,
        grading: None,
        constrained: false,
    };
    (proof, witness)
}

/// The certificate of the solver's proposal, and the ε that it holds for. A solver that ended early has a larger residual than
/// was asked for, but its answer may still be optimal for that residual.
fn certify_proposal(problem: &Problem, solution: &Solution) -> (Certificate, f64) {
    let certify = |p: &Problem| solve::certify(p, &solution.coefficients, &solution.dual);
    let asked = certify(problem);
    if !asked.proves_optimal && asked.residual > problem.tolerance {
        let reached = certify(&Problem {
            tolerance: asked.residual,
            ..*problem
        });
        if reached.proves_optimal && !solution.coefficients.is_empty() {
            return (reached, asked.residual);
        }
    }
    (asked, problem.tolerance)
}

/// The certificate of the polished answer by the solver's dual point, or by that point moved to the vertex of the answer if this
/// gives a smaller gap; with the moved point in the second case.
fn certify_answer(
    problem: &Problem,
    solution: &Solution,
    selection: &TermSelection,
    polished: &Refit,
) -> (Certificate, Option<Vec<f64>>) {
    let support = &selection.support;
    let columns = support.iter().copied();
    let answer: Vec<(usize, f64)> = columns.zip(polished.coefficients.clone()).collect();
    let signs: Vec<f64> = polished.coefficients.iter().map(|a| a.signum()).collect();
    let certify = |dual: &[f64]| solve::certify_support(problem, &answer, dual, support.clone());
    let plain = certify(&solution.dual);
    if solution.dual.iter().all(|l| *l == 0.0) {
        // A heuristic gives no dual point, so there is nothing to certify with.
        return (plain, None);
    }
    let moved = solve::refine_dual(problem, support, &signs, &solution.dual);
    if moved == solution.dual {
        // Same point, same certificate; computing it again would price all columns.
        return (plain, None);
    }
    let refined = certify(&moved);
    if refined.gap.abs() < plain.gap.abs() {
        (refined, Some(moved))
    } else {
        (plain, None)
    }
}

/// A finite figure: JSON has no infinity.
pub(crate) fn finite(x: f64) -> f64 {
    if x.is_finite() { x } else { f64::MAX }
}
