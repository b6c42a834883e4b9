//! Equations that constraints tie: prepared together, solved together, concluded together.
//!
//! In: the tasks of one group and the rows that tie them. Out: an equation or a failure each; or that the data contradict the
//! constraints. Where the free answers obey the constraints already, they are the answers.

use super::constraints::doubt;
use super::contradiction::{Case, Pairs};
use super::equation::{Answer, Proposed, Task};
use super::prepared::Prepared;
use super::strain;
use super::support;
use super::tied_proof;
use super::tied_support::{self, Chosen, Supports, TiedSearch};
use super::ties::Tied;
use super::watch::{Stage, Watcher};
use super::{Discovery, Equation, Failed, Reason, Refusal};
use crate::lang::model::Constraint;
use crate::solve::{JointSolution, Row, Sense};

/// Part of its largest summand by which an equality may miss and still hold to rounding.
pub(super) const ROUNDING: f64 = 1e-12;

/// A group of tied equations.
pub(super) struct Group<'a> {
    /// Each with its place in the model, rising.
    pub tasks: Vec<(usize, Task<'a>)>,
    pub tied: Vec<&'a Tied<'a>>,
}

/// An equation under work.
pub(super) struct Member<'t, 'a> {
    place: usize,
    pub task: &'t Task<'a>,
    pub prepared: Prepared,
    pub proposed: Proposed,
}

/// A constraint among members: `row` counts blocks by their place among these.
pub(super) struct Link<'a> {
    pub constraint: &'a Constraint,
    pub row: Row,
}

/// An equation or a failure, with the place in the model.
pub(super) type Done = (usize, Result<Equation, Failed>);

/// What a group came to: its equations, and the doubts that constraints give them.
pub(super) struct Concluded<'a> {
    pub done: Vec<Done>,
    pub doubts: Vec<(&'a Constraint, Reason)>,
}

impl<'a> Group<'a> {
    /// # Errors
    /// Terms that the data cannot evaluate, or data that contradict the constraints.
    pub fn run(
        &self,
        names: &Discovery,
        watcher: &mut Watcher,
    ) -> Result<Concluded<'a>, Vec<Refusal>> {
        let (mut done, mut members, mut bad) = (Vec::new(), Vec::new(), Vec::new());
        for (place, task) in &self.tasks {
            watcher.turn_to(*place);
            match task.prepare(names, watcher) {
                Err(value) => bad.push(Refusal::Unevaluable((*place, value))),
                Ok(Err(failed)) => done.push((*place, Err(failed))),
                Ok(Ok(mut prepared)) => {
                    let proposed = task.propose(&mut prepared, watcher);
                    members.push(Member {
                        place: *place,
                        task,
                        prepared,
                        proposed,
                    });
                }
            }
        }
        if !bad.is_empty() {
            return Err(bad);
        }
        let links = links(&self.tied, &members);
        let free: Vec<Pairs> = members.iter().map(|m| m.proposed.pairs()).collect();
        let case = Case {
            members: &members,
            links: &links,
            free: &free,
        };
        let (answers, pressing) = match solved(names, &case, watcher) {
            Ok(found) => found,
            Err(refusal) => return Err(vec![*refusal]),
        };
        let found: Vec<Pairs> = answers.iter().map(Answer::pairs).collect();
        let doubts = strain::doubts(names, &case, &found, &pressing);
        for (m, answer) in members.iter().zip(&answers) {
            watcher.turn_to(m.place);
            let mut equation = m.task.conclude(names, &m.prepared, answer);
            equation.path = m.task.path(&m.prepared, watcher);
            done.push((m.place, Ok(equation)));
        }
        Ok(Concluded { done, doubts })
    }
}

/// Attaches doubts once all equations are there.
pub(super) fn attach(d: &mut Discovery, doubts: &[(&Constraint, Reason)]) {
    for (constraint, reason) in doubts {
        doubt(d, constraint, reason);
    }
}

/// The constraints whose equations are all under work.
fn links<'a>(tied: &[&'a Tied<'a>], members: &[Member]) -> Vec<Link<'a>> {
    let block = |place: usize| members.iter().position(|m| m.place == place);
    let entries = |t: &Tied| -> Option<Vec<(usize, usize, f64)>> {
        let entries = t.row.entries.iter();
        entries
            .map(|(p, j, w)| Some((block(*p)?, *j, *w)))
            .collect()
    };
    tied.iter()
        .filter_map(|t| {
            Some(Link {
                constraint: t.constraint,
                row: Row {
                    entries: entries(t)?,
                    sense: t.row.sense,
                    right: t.row.right,
                },
            })
        })
        .collect()
}

/// The answers, and the links that press on them. Free answers that obey stand with their own proofs, as do those of a run that
/// is stopped.
fn solved<'c>(
    names: &Discovery,
    case: &Case<'_, 'c, '_, '_>,
    watcher: &mut Watcher,
) -> Result<(Vec<Answer>, Vec<usize>), Box<Refusal>> {
    let Case {
        members,
        links,
        free,
    } = *case;
    let as_free = || {
        let answers = members.iter();
        let answers = answers.map(|m| m.task.answer(&m.prepared, &m.proposed));
        (answers.collect::<Vec<Answer>>(), Vec::new())
    };
    let obeyed = links.iter().all(|l| holds(&l.row, free));
    if obeyed || watcher.stop().is_some() {
        return Ok(as_free());
    }
    let rows: Vec<Row> = links.iter().map(|l| l.row.clone()).collect();
    let supports: Supports = free
        .iter()
        .map(|a| a.iter().map(|(j, _)| *j).collect())
        .collect();
    let pools = pools(members, &rows, None);
    let Some(chosen) = search(
        members,
        &rows,
        &pools,
        std::slice::from_ref(&supports),
        watcher,
    ) else {
        return Ok(as_free());
    };
    let (chosen, proved) = tied_proof::prove(names, case, &rows, chosen, &supports, watcher)?;
    let answers = members.iter().enumerate();
    let answers = answers.map(|(b, m)| tied_proof::answer(b, m, &chosen, &proved, watcher));
    Ok((answers.collect(), chosen.fit.pressing.clone()))
}

fn coefficient(found: &[Pairs], block: usize, column: usize) -> f64 {
    let found = found.get(block).map_or(&[][..], Vec::as_slice);
    let at = found.binary_search_by_key(&column, |(j, _)| *j).ok();
    at.and_then(|k| found.get(k)).map_or(0.0, |(_, a)| *a)
}

/// Left side minus right side, and the size of the largest summand.
pub(super) fn left_over(row: &Row, found: &[Pairs]) -> (f64, f64) {
    let (mut sum, mut largest) = (-row.right, row.right.abs());
    for (block, column, weight) in &row.entries {
        let summand = weight * coefficient(found, *block, *column);
        sum += summand;
        largest = largest.max(summand.abs());
    }
    (sum, largest)
}

fn holds(row: &Row, found: &[Pairs]) -> bool {
    let (sum, largest) = left_over(row, found);
    match row.sense {
        Sense::Equal => sum.abs() <= ROUNDING * largest,
        Sense::AtMost | Sense::Below => sum <= 0.0,
    }
}

/// Columns of each block that take part: those of a free choice, those that rows name, and what a joint solution proposes.
pub(super) fn pools(members: &[Member], rows: &[Row], joint: Option<&JointSolution>) -> Supports {
    let named = |b: usize| {
        let entries = rows.iter().flat_map(|r| &r.entries);
        entries.filter(move |e| e.0 == b).map(|e| e.1)
    };
    members
        .iter()
        .enumerate()
        .map(|(b, m)| {
            let phi = m.prepared.phi.as_ref();
            let proposed = support::proposals(phi, &m.proposed.solution.coefficients);
            let mut pool = support::pool(phi, &proposed);
            pool.extend(&m.proposed.choice.support);
            pool.extend(named(b));
            if let Some(coefficients) = joint.and_then(|j| j.coefficients.get(b)) {
                pool.extend(support::pool(phi, &support::proposals(phi, coefficients)));
            }
            pool.sort_unstable();
            pool.dedup();
            pool
        })
        .collect()
}

/// The search over the supports of members, among the columns of `pools`.
pub(super) fn tied_search<'r>(
    members: &[Member],
    rows: &'r [Row],
    pools: &Supports,
) -> TiedSearch<'r> {
    let blocks = members.iter().zip(pools).map(|(m, pool)| {
        let (criterion, polished) = (&m.proposed.criterion, &m.proposed.polished);
        let square = polished.residual.powi(2);
        let freedom = (m.prepared.aim.len() - polished.rank.min(m.prepared.aim.len() - 1)) as f64;
        // A row counts by what is known of its error, correlated rows for less.
        let independent = criterion.samples / criterion.rows;
        let weight = independent / (square / criterion.rows + criterion.floor);
        let phi = m.prepared.phi.as_ref();
        tied_support::block(phi, &m.prepared.aim, pool, weight, square / freedom)
    });
    TiedSearch {
        blocks: blocks.collect(),
        criteria: members.iter().map(|m| m.proposed.criterion).collect(),
        rows,
    }
}

pub(super) fn search(
    members: &[Member],
    rows: &[Row],
    pools: &Supports,
    starts: &[Supports],
    watcher: &mut Watcher,
) -> Option<Chosen> {
    let search = tied_search(members, rows, pools);
    search.run(starts, &mut || watcher.at(Stage::Choosing).is_none())
}
