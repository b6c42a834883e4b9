//! The optimality certificate of coupled equations.
//!
//! In: a constrained selection. Out: the same, or a better one that the joint conic problem proposes, with its certificate. Dual
//! points of the free problems are feasible for the joint dual too; the joint problem is solved only where they prove nothing.
//! Never drops a constraint.

use crate::constrained::constrained_selection::{ConstrainedSelection, Supports};
use crate::constrained::coupled_problem::{CoupledProblem, Member, pools, search};
use crate::constrained::data_conflict;
use crate::constrained::thresholds::JOINT_CERTIFICATE;
use crate::refusal::Refusal;
use crate::regression::certificate::finite;
use crate::regression::estimate::{Estimate, pairs};
use crate::selection::thresholds::TERM_SELECTION;
use crate::statistics::norm;
use sidc_progress::EquationObserver;
use sidc_solve as solve;
use sidc_solve::{
    ConstrainedCertificate, ConstrainedProblem, ConstrainedSolution, LinearConstraint, Outcome,
    Problem, Status as Solved, certify_constrained, solve_constrained,
};
use sidc_system::discovery::Discovery;
use sidc_system::discovery::Proof;
use sidc_system::discovery::Witness;

/// The certificate of a constrained answer, and how it was found.
pub(crate) struct JointCertificate {
    proof: ConstrainedCertificate,
    of_answer: bool,
    joint: Option<ConstrainedSolution>,
    tolerances: Vec<f64>,
}

/// Certifies a selection by the dual points of the free problems or, if they do not prove it, of the joint problem.
///
/// # Errors
/// The data contradict the constraints.
pub(crate) fn prove(
    names: &Discovery,
    case: &CoupledProblem,
    rows: &[LinearConstraint],
    mut chosen: ConstrainedSelection,
    free: &Supports,
    watcher: &mut EquationObserver,
) -> Result<(ConstrainedSelection, JointCertificate), Box<Refusal>> {
    let members = case.members;
    let mut tolerances: Vec<f64> = members.iter().map(|m| m.design.tolerance).collect();
    let joint = joint(members, rows, &tolerances);
    if let Some(proof) = bounded_by_free(members, &joint, &chosen) {
        let proved = JointCertificate {
            proof,
            of_answer: true,
            joint: None,
            tolerances,
        };
        return Ok((chosen, proved));
    }
    let start = starts(free, &chosen);
    let reaches = |(m, square): (&Member, &f64)| {
        square.sqrt() <= m.design.tolerance * (1.0 + JOINT_CERTIFICATE.within_tolerance)
    };
    if !members.iter().zip(&chosen.fit.squares).all(reaches) {
        tolerances = data_conflict::relaxed_tolerances(names, case, &joint, &start)?;
    }
    let joint = self::joint(members, rows, &tolerances);
    let solution = solve_constrained(&joint, &start, watcher);
    let wider = pools(members, rows, Some(&solution));
    if solution.outcome == Outcome::Solved && wider != pools(members, rows, None) {
        let proposals = significant(members, &solution);
        let from = [chosen.supports.clone(), proposals];
        chosen = search(members, rows, &wider, &from, watcher).unwrap_or(chosen);
    }
    let (duals, multipliers) = (&solution.duals, &solution.multipliers);
    let own = certify_constrained(&joint, &pairs_of_blocks(&chosen), duals, multipliers);
    let of_answer = own.proves_optimal;
    let proof = match of_answer {
        true => own,
        false => certify_constrained(&joint, &solution.coefficients, duals, multipliers),
    };
    let proved = JointCertificate {
        proof,
        of_answer,
        joint: Some(solution),
        tolerances,
    };
    Ok((chosen, proved))
}

fn joint<'m>(
    members: &'m [Member],
    rows: &[LinearConstraint],
    tolerances: &[f64],
) -> ConstrainedProblem<'m> {
    let blocks = members.iter().zip(tolerances);
    ConstrainedProblem {
        blocks: blocks
            .map(|(m, tolerance)| Problem {
                tolerance: *tolerance,
                ..m.design.problem()
            })
            .collect(),
        rows: rows.to_vec(),
    }
}

/// The certificate by dual points of the free problems, as they are or moved to the vertex of the answer, if one proves it.
fn bounded_by_free(
    members: &[Member],
    joint: &ConstrainedProblem,
    chosen: &ConstrainedSelection,
) -> Option<ConstrainedCertificate> {
    let silent = |m: &Member| m.selected.proposal.solution.dual.iter().all(|l| *l == 0.0);
    if members.iter().any(silent) {
        return None;
    }
    let blocks = || members.iter().zip(&chosen.supports).zip(&chosen.fit.values);
    let plain = blocks().map(|((m, _), _)| m.selected.proposal.solution.dual.clone());
    let refined = blocks().map(|((m, support), values)| {
        let signs: Vec<f64> = values.iter().map(|a| a.signum()).collect();
        let dual = &m.selected.proposal.solution.dual;
        solve::refine_dual(&m.design.problem(), support, &signs, dual)
    });
    let certify = |duals: Vec<Vec<f64>>| {
        let sizes = members.iter().map(|m| norm(&m.design.target));
        let scaled = duals.iter().zip(sizes);
        let scaled: Vec<Vec<f64>> = scaled
            .map(|(d, size)| d.iter().map(|l| l / size).collect())
            .collect();
        certify_constrained(
            joint,
            &pairs_of_blocks(chosen),
            &scaled,
            &vec![0.0; joint.rows.len()],
        )
    };
    let proofs = [certify(plain.collect()), certify(refined.collect())];
    let proofs = proofs.into_iter().filter(|p| p.proves_optimal);
    proofs.max_by(|a, b| narrowest(a).total_cmp(&narrowest(b)))
}

/// The smallest dual margin of all blocks.
fn narrowest(proof: &ConstrainedCertificate) -> f64 {
    proof.margins.iter().copied().fold(1.0, f64::min)
}

/// The first working set of the conic solver.
fn starts(free: &Supports, chosen: &ConstrainedSelection) -> Supports {
    let both = free.iter().zip(&chosen.supports);
    both.map(|(a, b)| a.iter().chain(b).copied().collect())
        .collect()
}

/// The columns of a joint solution whose share is above rounding.
fn significant(members: &[Member], solution: &ConstrainedSolution) -> Supports {
    let blocks = members.iter().zip(&solution.coefficients);
    blocks
        .map(|(m, coefficients)| {
            let phi = m.design.phi.as_ref();
            let size = |(j, a): &(usize, f64)| a.abs() * phi.norm(*j);
            let largest = coefficients.iter().map(size).fold(0.0, f64::max);
            let mut strong: Vec<&(usize, f64)> = coefficients.iter().collect();
            strong.retain(|c| size(c) > JOINT_CERTIFICATE.negligible_share * largest);
            strong.sort_by(|a, b| size(b).total_cmp(&size(a)));
            let strong = strong.into_iter().take(TERM_SELECTION.max_terms);
            let mut columns: Vec<usize> = strong.map(|(j, _)| *j).collect();
            columns.sort_unstable();
            columns
        })
        .collect()
}

/// The estimate of one member with its part of the certificate.
pub(crate) fn answer(
    b: usize,
    member: &Member,
    chosen: &ConstrainedSelection,
    proved: &JointCertificate,
    watcher: &EquationObserver,
) -> Estimate {
    let support = chosen.supports[b].clone();
    let problem = member.design.problem();
    let polished = solve::refit(problem.dictionary, problem.target, &support);
    let proof = &proved.proof;
    let smallest = narrowest(proof);
    let full = polished.rank == support.len();
    let solution = &member.selected.proposal.solution;
    let free = member.task.options.solver;
    let (solver, exact, iterations, status) = match &proved.joint {
        None => (free.name(), free.exact(), 0, Solved::Solved),
        Some(joint) => (
            solve::Solver::name(&solve::Clarabel),
            true,
            joint.iterations,
            status(joint, proof),
        ),
    };
    Estimate {
        proof: Proof {
            tolerance: proved.tolerances[b] / norm(problem.target),
            gap: finite(proof.gap),
            max_correlation: finite(proof.largest_correlation),
            margin: finite(proof.margins[b]),
            rank: polished.rank,
            support: support.len(),
            condition: finite(polished.condition),
            optimal: proof.proves_optimal,
            unique: proved.of_answer
                && full
                && smallest > 0.0
                && proof.gap.max(0.0) / smallest <= JOINT_CERTIFICATE.elsewhere,
            of_answer: proved.of_answer,
            grading: None,
            constrained: true,
        },
        // The multipliers of the constraints are not kept, so this certificate cannot be verified later.
        witness: Witness::default(),
        coefficients: chosen.fit.values[b].clone(),
        standard_errors: chosen.fit.standard_errors[b].clone(),
        ties: chosen.ties[b].clone(),
        searched: chosen.searched[b],
        solver,
        exact,
        proposed: support.len(),
        iterations: solution.iterations + iterations,
        stopped: watcher.stop(),
        status,
        support,
    }
}

fn status(joint: &ConstrainedSolution, proof: &ConstrainedCertificate) -> Solved {
    match joint.outcome {
        Outcome::Solved => Solved::Solved,
        Outcome::Interrupted => Solved::Interrupted,
        Outcome::Inaccurate | Outcome::Infeasible => Solved::Inaccurate {
            gap: proof.gap,
            residual: 0.0,
        },
    }
}

/// (column, coefficient) of each block of the selection.
fn pairs_of_blocks(chosen: &ConstrainedSelection) -> Vec<Vec<(usize, f64)>> {
    let blocks = chosen.supports.iter().zip(&chosen.fit.values);
    blocks.map(|(s, v)| pairs(s, v)).collect()
}
