//! What the dual point proves about the equation printed, in the figures of its evidence.

use super::Proof;
use super::support::Choice;
use super::weights::norm;
use super::witness::Witness;
use crate::solve::{self, Certificate, Polished, Problem, Solution};

/// The certificate of the printed answer if it is the solver's own, else of the solver's; and what it takes to check it, but
/// for the rows.
pub(super) fn prove(
    problem: &Problem,
    solution: &Solution,
    choice: &Choice,
    polished: &Polished,
) -> (Proof, Witness) {
    let (own, moved) = certify_answer(problem, solution, choice, polished);
    let of_answer = choice.as_proposed && own.proves_optimal;
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
        support: choice.support.len(),
        condition: finite(polished.condition),
        optimal: certificate.proves_optimal,
        unique: certificate.proves_unique,
        of_answer,
        constrained: false,
    };
    (proof, witness)
}

/// What a solver that ended early found may still be the best of all that fit as well as it does: its certificate, and the ε
/// that it is for.
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

/// The polished answer with the solver's dual point, or with that point moved onto the answer's vertex if that proves more; and that
/// point, if it is the one.
fn certify_answer(
    problem: &Problem,
    solution: &Solution,
    choice: &Choice,
    polished: &Polished,
) -> (Certificate, Option<Vec<f64>>) {
    let support = &choice.support;
    let columns = support.iter().copied();
    let answer: Vec<(usize, f64)> = columns.zip(polished.coefficients.clone()).collect();
    let signs: Vec<f64> = polished.coefficients.iter().map(|a| a.signum()).collect();
    let certify = |dual: &[f64]| solve::certify_support(problem, &answer, dual, support.clone());
    let plain = certify(&solution.dual);
    if solution.dual.iter().all(|l| *l == 0.0) {
        // A solver without a dual point claims no proof, and none is made up for it.
        return (plain, None);
    }
    let moved = solve::refine_dual(problem, support, &signs, &solution.dual);
    if moved == solution.dual {
        // Nothing to prove anew: every certificate is a look at all columns.
        return (plain, None);
    }
    let refined = certify(&moved);
    if refined.gap.abs() < plain.gap.abs() {
        (refined, Some(moved))
    } else {
        (plain, None)
    }
}

/// Figures in a result must be numbers.
pub(super) fn finite(x: f64) -> f64 {
    if x.is_finite() { x } else { f64::MAX }
}
