//! Equations of one coupled group with their constraints, and what every later step asks of them.
//!
//! In: designs, free selections and constraints of a group. Out: whether coefficients satisfy a constraint, the columns that
//! take part, and the search over supports. Never decides which answer stands.

use crate::constrained::constrained_selection::{
    self, ConstrainedSearch, ConstrainedSelection, Supports,
};
use crate::constrained::constraint_check::{coefficient_text, six_digits};
use crate::constrained::thresholds::CONSTRAINTS;
use crate::regression::design::Design;
use crate::regression::estimate::Selected;
use crate::regression::task::Task;
use crate::selection::term_selection;
use sidc_lang::model::{Coefficient, Constraint};
use sidc_progress::{EquationObserver, Stage};
use sidc_solve::{ConstrainedSolution, LinearConstraint, Sense};
use sidc_system::discovery::Discovery;

/// An equation of the group with its free selection.
pub(crate) struct Member<'t, 'a> {
    pub place: usize,
    pub task: &'t Task<'a>,
    pub design: Design,
    pub selected: Selected,
}

/// A constraint of the group; blocks of `row` are places among its members.
pub(crate) struct GroupConstraint<'a> {
    pub constraint: &'a Constraint,
    pub row: LinearConstraint,
}

/// (column, coefficient) of the terms of one equation, by rising column.
pub(crate) type Pairs = Vec<(usize, f64)>;

/// The group with its free answers.
pub(crate) struct CoupledProblem<'m, 'c, 't, 'a> {
    pub members: &'m [Member<'t, 'a>],
    pub links: &'m [GroupConstraint<'c>],
    pub free: &'m [Pairs],
}

fn coefficient(found: &[Pairs], block: usize, column: usize) -> f64 {
    let found = found.get(block).map_or(&[][..], Vec::as_slice);
    let at = found.binary_search_by_key(&column, |(j, _)| *j).ok();
    at.and_then(|k| found.get(k)).map_or(0.0, |(_, a)| *a)
}

/// The columns of free answers, block by block.
pub(crate) fn free_supports(free: &[Pairs]) -> Supports {
    let columns = |a: &Pairs| a.iter().map(|(j, _)| *j).collect();
    free.iter().map(columns).collect()
}

/// Left side minus right side of a row, and the size of the largest summand.
pub(crate) fn violation(row: &LinearConstraint, found: &[Pairs]) -> (f64, f64) {
    let (mut sum, mut largest) = (-row.right, row.right.abs());
    for (block, column, weight) in &row.entries {
        let summand = weight * coefficient(found, *block, *column);
        sum += summand;
        largest = largest.max(summand.abs());
    }
    (sum, largest)
}

pub(crate) fn holds(row: &LinearConstraint, found: &[Pairs]) -> bool {
    let (sum, largest) = violation(row, found);
    match row.sense {
        Sense::Equal => sum.abs() <= CONSTRAINTS.solved_rounding * largest,
        Sense::AtMost | Sense::Below => sum <= 0.0,
    }
}

/// Columns of each block that take part: those of the free selection, those in rows, and proposals of a joint solution.
pub(crate) fn pools(
    members: &[Member],
    rows: &[LinearConstraint],
    joint: Option<&ConstrainedSolution>,
) -> Supports {
    let named = |b: usize| {
        let entries = rows.iter().flat_map(|r| &r.entries);
        entries.filter(move |e| e.0 == b).map(|e| e.1)
    };
    members
        .iter()
        .enumerate()
        .map(|(b, m)| {
            let phi = m.design.phi.as_ref();
            let proposed =
                term_selection::proposed_columns(phi, &m.selected.proposal.solution.coefficients);
            let mut pool = term_selection::candidate_pool(phi, &proposed);
            pool.extend(&m.selected.selection.support);
            pool.extend(named(b));
            pool.extend_from_slice(m.task.library.required());
            if let Some(coefficients) = joint.and_then(|j| j.coefficients.get(b)) {
                pool.extend(term_selection::candidate_pool(
                    phi,
                    &term_selection::proposed_columns(phi, coefficients),
                ));
            }
            pool.sort_unstable();
            pool.dedup();
            pool
        })
        .collect()
}

/// The search over the supports of all members, among the columns of `pools`.
pub(crate) fn constrained_search<'r>(
    members: &[Member],
    rows: &'r [LinearConstraint],
    pools: &Supports,
) -> ConstrainedSearch<'r> {
    let blocks = members.iter().zip(pools).map(|(m, pool)| {
        let (criterion, polished) = (&m.selected.criterion, &m.selected.polished);
        let square = polished.residual.powi(2);
        let freedom = (m.design.target.len() - polished.rank.min(m.design.target.len() - 1)) as f64;
        // Inverse variance of a row; correlated rows count for less.
        let independent = criterion.samples / criterion.rows;
        let weight = independent / (square / criterion.rows + criterion.floor);
        let phi = m.design.phi.as_ref();
        constrained_selection::block(phi, &m.design.target, pool, weight, square / freedom)
    });
    ConstrainedSearch {
        blocks: blocks.collect(),
        criteria: members.iter().map(|m| m.selected.criterion).collect(),
        rows,
        required: members
            .iter()
            .map(|m| m.task.library.required().to_vec())
            .collect(),
    }
}

pub(crate) fn search(
    members: &[Member],
    rows: &[LinearConstraint],
    pools: &Supports,
    starts: &[Supports],
    watcher: &mut EquationObserver,
) -> Option<ConstrainedSelection> {
    let search = constrained_search(members, rows, pools);
    search.run(starts, watcher.during(Stage::Choosing))
}

/// `coef(dx, x) = -10, coef(dy, x) = 0`: the coefficients of a constraint in the free answers, known parts included.
pub(crate) fn free_values(
    names: &Discovery,
    members: &[Member],
    constraint: &Constraint,
    free: &[Pairs],
) -> String {
    let value = |c: &Coefficient| -> f64 {
        let of = members.iter().zip(free);
        let of = of.filter(|(m, _)| m.task.target == c.target);
        of.map(|(m, found)| m.task.value(found, &c.term)).sum()
    };
    let parts = constraint.coefficients.iter();
    let parts = parts.map(|c| format!("{} = {}", coefficient_text(names, c), six_digits(value(c))));
    parts.collect::<Vec<String>>().join(", ")
}
