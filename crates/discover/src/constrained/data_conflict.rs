//! Constraints that contradict the data: no candidate terms fit within the errors of the data while they hold.
//!
//! In: a coupled problem whose constrained fit leaves more than its tolerances. Out: tolerances that admit the constraints, or an
//! error with an irreducible set of constraints at fault. Never changes an answer.

use crate::constrained::constraint_check::constraint_text;
use crate::constrained::coupled_problem::{CoupledProblem, GroupConstraint, free_values};
use crate::constrained::thresholds::DATA_CONFLICT;
use crate::refusal::Refusal;
use crate::regression::thresholds::TOLERANCE;
use crate::statistics::norm;
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::term::SignalNames;
use sidc_solve::{ConstrainedProblem, LinearConstraint, least_residuals};
use sidc_system::discovery::Discovery;

/// The tolerance of each block, relaxed as far as the constraints need.
///
/// # Errors
/// The constraints need more than the errors of the data allow.
pub(crate) fn relaxed_tolerances(
    names: &Discovery,
    case: &CoupledProblem,
    joint: &ConstrainedProblem,
    start: &[Vec<usize>],
) -> Result<Vec<f64>, Box<Refusal>> {
    let reached = least_residuals(joint, start);
    if within_errors(case, &reached) {
        let blocks = case.members.iter().zip(&reached);
        return Ok(blocks
            .map(|(m, r)| {
                let (own, size) = (m.design.tolerance, norm(&m.design.target));
                let needed = r * size;
                if needed > own {
                    TOLERANCE.room * needed
                } else {
                    own
                }
            })
            .collect());
    }
    let set = minimal_conflict(case, joint, start);
    Err(Box::new(Refusal::Contradiction(contradiction(
        names, case, &set, &reached,
    ))))
}

/// True if the errors of the data explain the relative residual of every block.
fn within_errors(case: &CoupledProblem, reached: &[f64]) -> bool {
    case.members.iter().zip(reached).all(|(m, r)| {
        let p = &m.design;
        let criterion = &m.selected.criterion;
        let size = norm(&p.target);
        let noise = p.tolerance.powi(2) * (1.0 + DATA_CONFLICT.impossible / criterion.samples);
        let floor = criterion.floor * criterion.rows;
        (r * size).powi(2)
            <= noise
                .max(floor)
                .max((DATA_CONFLICT.numerical * size).powi(2))
    })
}

/// An irreducible set of constraints that contradicts the data, by the deletion filter (Chinneck & Dravnieks 1991): a constraint
/// without which the others still contradict the data is dropped.
fn minimal_conflict(
    case: &CoupledProblem,
    joint: &ConstrainedProblem,
    start: &[Vec<usize>],
) -> Vec<usize> {
    let mut kept: Vec<usize> = (0..case.links.len()).collect();
    for k in 0..case.links.len() {
        let without: Vec<usize> = kept.iter().copied().filter(|i| *i != k).collect();
        let rows: Vec<LinearConstraint> =
            without.iter().map(|i| case.links[*i].row.clone()).collect();
        let blocks = joint.blocks.iter().map(|b| sidc_solve::Problem {
            dictionary: b.dictionary,
            target: b.target,
            tolerance: b.tolerance,
        });
        let lesser = ConstrainedProblem {
            blocks: blocks.collect(),
            rows,
        };
        if !within_errors(case, &least_residuals(&lesser, start)) {
            kept = without;
        }
    }
    kept
}

fn contradiction(
    names: &Discovery,
    case: &CoupledProblem,
    set: &[usize],
    reached: &[f64],
) -> Diagnostic {
    let links: Vec<&GroupConstraint> = set.iter().map(|k| &case.links[*k]).collect();
    let mut d = Diagnostic::error(
        "constraints-contradict-data",
        match links.len() {
            1 => "no combination of the candidate terms fits the data under this constraint",
            _ => "no combination of the candidate terms fits the data under these constraints",
        },
    );
    for link in &links {
        let label = format!(
            "{}; the data give {}",
            constraint_text(names, link.constraint),
            free_values(names, case.members, link.constraint, case.free)
        );
        d = d.at(link.constraint.span, label);
    }
    for (b, (m, r)) in case.members.iter().zip(reached).enumerate() {
        let mut entries = links.iter().flat_map(|l| &l.row.entries);
        if entries.any(|e| e.0 == b) {
            let size = norm(&m.design.target);
            d = d.fact(format!(
                "{}: the residual is at best {r:.1e} of the target under the constraints, {:.1e} without",
                names.name(m.task.target),
                m.selected.polished.residual / size
            ));
        }
    }
    d.help("look at signs, units and the system itself; leave the constraint out to see the equations that the data want")
}
