//! What is proved of the answer of tied equations.
//!
//! In: a constrained choice. Out: the same, or a better one from what the joint problem proposes, with its proof. The dual points of
//! the free problems bound the tied one too; only where these do not do, the joint problem is solved.

use super::Discovery;
use super::Proof;
use super::Refusal;
use super::contradiction::{self, Case};
use super::equation::Answer;
use super::proof::finite;
use super::support;
use super::tied_support::{Chosen, Supports};
use super::together::{Member, pools, search};
use super::watch::Watcher;
use super::weights::norm;
use super::witness::Witness;
use crate::solve::{
    self, Joint, JointProof, JointSolution, Outcome, Problem, Row, Status as Solved, certify_joint,
    solve_joint,
};

/// Residual beyond ε, relative, that counts as within it.
const WITHIN: f64 = 1e-6;
/// Share of the ℓ1 norm that another minimiser may have off the support, for uniqueness.
const ELSEWHERE: f64 = 1e-3;
/// Coefficients on unit columns below this part of the largest are the conic solver's rounding.
const NEGLIGIBLE: f64 = 1e-6;

/// The proof of a joint answer, and how it was come by.
pub(super) struct Proved {
    proof: JointProof,
    of_answer: bool,
    joint: Option<JointSolution>,
    tolerances: Vec<f64>,
}

/// Proves what can be proved: by the dual points of the free problems, which bound the tied one too, or by solving that.
pub(super) fn prove(
    names: &Discovery,
    case: &Case,
    rows: &[Row],
    mut chosen: Chosen,
    free: &Supports,
    watcher: &mut Watcher,
) -> Result<(Chosen, Proved), Box<Refusal>> {
    let members = case.members;
    let mut tolerances: Vec<f64> = members.iter().map(|m| m.prepared.tolerance).collect();
    let joint = joint(members, rows, &tolerances);
    if let Some(proof) = bounded_by_free(members, &joint, &chosen) {
        let proved = Proved {
            proof,
            of_answer: true,
            joint: None,
            tolerances,
        };
        return Ok((chosen, proved));
    }
    let start = starts(free, &chosen);
    let reaches =
        |(m, square): (&Member, &f64)| square.sqrt() <= m.prepared.tolerance * (1.0 + WITHIN);
    if !members.iter().zip(&chosen.fit.squares).all(reaches) {
        tolerances = contradiction::widened(names, case, &joint, &start)?;
    }
    let joint = self::joint(members, rows, &tolerances);
    let solution = watcher.solving(|monitor| solve_joint(&joint, &start, monitor));
    let wider = pools(members, rows, Some(&solution));
    if solution.outcome == Outcome::Solved && wider != pools(members, rows, None) {
        let proposals = significant(members, &solution);
        let from = [chosen.supports.clone(), proposals];
        chosen = search(members, rows, &wider, &from, watcher).unwrap_or(chosen);
    }
    let (duals, multipliers) = (&solution.duals, &solution.multipliers);
    let own = certify_joint(&joint, &pairs(&chosen), duals, multipliers);
    let of_answer = own.proves_optimal;
    let proof = match of_answer {
        true => own,
        false => certify_joint(&joint, &solution.coefficients, duals, multipliers),
    };
    let proved = Proved {
        proof,
        of_answer,
        joint: Some(solution),
        tolerances,
    };
    Ok((chosen, proved))
}

fn joint<'m>(members: &'m [Member], rows: &[Row], tolerances: &[f64]) -> Joint<'m> {
    let blocks = members.iter().zip(tolerances);
    Joint {
        blocks: blocks
            .map(|(m, tolerance)| Problem {
                tolerance: *tolerance,
                ..m.prepared.problem()
            })
            .collect(),
        rows: rows.to_vec(),
    }
}

/// The proof of the answer by dual points of the free problems, if they prove it: as they are, or moved to its vertex.
fn bounded_by_free(members: &[Member], joint: &Joint, chosen: &Chosen) -> Option<JointProof> {
    let silent = |m: &Member| m.proposed.solution.dual.iter().all(|l| *l == 0.0);
    if members.iter().any(silent) {
        return None;
    }
    let blocks = || members.iter().zip(&chosen.supports).zip(&chosen.fit.values);
    let plain = blocks().map(|((m, _), _)| m.proposed.solution.dual.clone());
    let refined = blocks().map(|((m, support), values)| {
        let signs: Vec<f64> = values.iter().map(|a| a.signum()).collect();
        let dual = &m.proposed.solution.dual;
        solve::refine_dual(&m.prepared.problem(), support, &signs, dual)
    });
    let certify = |duals: Vec<Vec<f64>>| {
        let sizes = members.iter().map(|m| norm(&m.prepared.aim));
        let scaled = duals.iter().zip(sizes);
        let scaled: Vec<Vec<f64>> = scaled
            .map(|(d, size)| d.iter().map(|l| l / size).collect())
            .collect();
        certify_joint(joint, &pairs(chosen), &scaled, &vec![0.0; joint.rows.len()])
    };
    let proofs = [certify(plain.collect()), certify(refined.collect())];
    let proofs = proofs.into_iter().filter(|p| p.proves_optimal);
    proofs.max_by(|a, b| narrowest(a).total_cmp(&narrowest(b)))
}

/// The smallest margin of all blocks.
fn narrowest(proof: &JointProof) -> f64 {
    proof.margins.iter().copied().fold(1.0, f64::min)
}

/// Columns for the conic solver to begin with.
fn starts(free: &Supports, chosen: &Chosen) -> Supports {
    let both = free.iter().zip(&chosen.supports);
    both.map(|(a, b)| a.iter().chain(b).copied().collect())
        .collect()
}

/// The columns of a joint solution that are more than rounding.
fn significant(members: &[Member], solution: &JointSolution) -> Supports {
    let blocks = members.iter().zip(&solution.coefficients);
    blocks
        .map(|(m, coefficients)| {
            let phi = m.prepared.phi.as_ref();
            let size = |(j, a): &(usize, f64)| a.abs() * phi.norms()[*j];
            let largest = coefficients.iter().map(size).fold(0.0, f64::max);
            let mut strong: Vec<&(usize, f64)> = coefficients.iter().collect();
            strong.retain(|c| size(c) > NEGLIGIBLE * largest);
            strong.sort_by(|a, b| size(b).total_cmp(&size(a)));
            let strong = strong.into_iter().take(support::MOST_TERMS);
            let mut columns: Vec<usize> = strong.map(|(j, _)| *j).collect();
            columns.sort_unstable();
            columns
        })
        .collect()
}

/// A member's answer with its part of the proof.
pub(super) fn answer(
    b: usize,
    member: &Member,
    chosen: &Chosen,
    proved: &Proved,
    watcher: &Watcher,
) -> Answer {
    let support = chosen.supports[b].clone();
    let problem = member.prepared.problem();
    let polished = solve::polish(problem.dictionary, problem.target, &support);
    let proof = &proved.proof;
    let smallest = narrowest(proof);
    let full = polished.rank == support.len();
    let solution = &member.proposed.solution;
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
    Answer {
        proof: Proof {
            tolerance: proved.tolerances[b] / norm(problem.target),
            gap: finite(proof.gap),
            max_correlation: finite(proof.largest_price),
            margin: finite(proof.margins[b]),
            rank: polished.rank,
            support: support.len(),
            condition: finite(polished.condition),
            optimal: proof.proves_optimal,
            unique: proved.of_answer
                && full
                && smallest > 0.0
                && proof.gap.max(0.0) / smallest <= ELSEWHERE,
            of_answer: proved.of_answer,
            constrained: true,
        },
        // The multipliers of the constraints are not kept: nothing of this proof can be checked by itself.
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

fn status(joint: &JointSolution, proof: &JointProof) -> Solved {
    match joint.outcome {
        Outcome::Solved => Solved::Solved,
        Outcome::Interrupted => Solved::Interrupted,
        Outcome::Inaccurate | Outcome::Infeasible => Solved::Inaccurate {
            gap: proof.gap,
            residual: 0.0,
        },
    }
}

/// The answer as (column, coefficient) of each block.
fn pairs(chosen: &Chosen) -> Vec<Vec<(usize, f64)>> {
    let blocks = chosen.supports.iter().zip(&chosen.fit.values);
    blocks
        .map(|(s, v)| s.iter().copied().zip(v.iter().copied()).collect())
        .collect()
}
