//! Doubts about constraints that the data pull against: active bounds, and equalities that cost the fit too much.
//!
//! In: a coupled problem, its free answers and the constrained ones. Out: a doubt for each such constraint. Never changes an answer.

use crate::constrained::constraint_check::constraint_text;
use crate::constrained::coupled_problem::{
    CoupledProblem, GroupConstraint, Member, Pairs, constrained_search, free_supports, free_values,
    violation,
};
use crate::constrained::thresholds::{CONSTRAINTS, DATA_CONFLICT};
use sidc_lang::model::Constraint;
use sidc_solve::{Sense, constrained_least_squares};
use sidc_system::discovery::{Discovery, Reason, ReasonCode};

/// Doubts for active inequalities, for strict ones met only at their bound, and for equalities far from the free fit. `pressing`
/// are the places of active constraints.
pub(crate) fn doubts<'a>(
    names: &Discovery,
    case: &CoupledProblem<'_, 'a, '_, '_>,
    answers: &[Pairs],
    pressing: &[usize],
) -> Vec<(&'a Constraint, Reason)> {
    let CoupledProblem {
        members,
        links,
        free,
    } = *case;
    // Free answers that stand satisfy every constraint, so all distances are zero.
    let far = match free == answers {
        true => Vec::new(),
        false => distances(members, links, free),
    };
    let mut out = Vec::new();
    for (k, link) in links.iter().enumerate() {
        let (sum, largest) = violation(&link.row, answers);
        let strict = link.row.sense == Sense::Below;
        let text = |how: &str| {
            format!(
                "{} {how}; the data alone give {}",
                constraint_text(names, link.constraint),
                free_values(names, members, link.constraint, free)
            )
        };
        if pressing.contains(&k) || strict && sum.abs() <= CONSTRAINTS.solved_rounding * largest {
            let reason = Reason::new(ReasonCode::AtBound, text("is met only at its bound"));
            out.push((link.constraint, reason));
        } else if let Some(d) = far.get(k).filter(|d| **d > DATA_CONFLICT.strained) {
            let far = match *d < DATA_CONFLICT.far {
                true => format!("{d:.0}"),
                false => format!("more than {}", DATA_CONFLICT.far),
            };
            let how = format!("is {far} standard errors from the data");
            out.push((
                link.constraint,
                Reason::new(ReasonCode::ConstraintStrained, text(&how)),
            ));
        }
    }
    out
}

/// The distance of each constraint from the free fit, in standard errors: the root of what the constraint alone adds to the
/// weighted sum of squares, on the terms selected freely and those that it names.
fn distances(members: &[Member], links: &[GroupConstraint], free: &[Pairs]) -> Vec<f64> {
    links
        .iter()
        .map(|link| {
            let rows = [link.row.clone()];
            let mut supports = free_supports(free);
            for (b, column, _) in &link.row.entries {
                if let Some(s) = supports.get_mut(*b) {
                    s.push(*column);
                    s.sort_unstable();
                    s.dedup();
                }
            }
            let search = constrained_search(members, &rows, &supports);
            let squares = |rows: &[sidc_solve::LinearConstraint]| -> Option<f64> {
                let found = constrained_least_squares(&search.blocks, &supports, rows)?;
                let blocks = search.blocks.iter().zip(&found.squares);
                Some(blocks.map(|(b, s)| b.weight * s).sum())
            };
            match (squares(&rows), squares(&[])) {
                (Some(with), Some(without)) => (with - without).max(0.0).sqrt(),
                _ => 0.0,
            }
        })
        .collect()
}
