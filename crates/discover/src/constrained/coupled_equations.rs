//! One group of coupled equations from start to end: free selections, constrained selection, certificate, evidence.
//!
//! In: the tasks of the group and the constraints that couple them. Out: an equation or a failure for each, or that the data
//! contradict the constraints. Never changes free answers that satisfy the constraints.

use crate::constrained::constraint_check::doubt_equations;
use crate::constrained::constraint_rows::ConstraintRow;
use crate::constrained::constraint_strain;
use crate::constrained::coupled_problem::{
    CoupledProblem, GroupConstraint, Member, Pairs, free_supports, holds, pools, search,
};
use crate::constrained::joint_certificate;
use crate::refusal::Refusal;
use crate::regression::estimate::Estimate;
use crate::regression::task::Task;
use sidc_lang::library::Grading;
use sidc_lang::model::Constraint;
use sidc_progress::EquationObserver;
use sidc_solve::LinearConstraint;
use sidc_system::discovery::{Discovery, Equation, Failed, Reason};

/// Coupled equations.
pub(crate) struct CoupledGroup<'a> {
    /// Tasks with their places in the model, rising.
    pub tasks: Vec<(usize, Task<'a>)>,
    pub tied: Vec<&'a ConstraintRow<'a>>,
}

/// An equation or a failure, with its place in the model.
pub(crate) type Done = (usize, Result<Equation, Failed>);

/// The result of a group: its equations, and the doubts that constraints give them.
pub(crate) struct Concluded<'a> {
    pub done: Vec<Done>,
    pub doubts: Vec<(&'a Constraint, Reason)>,
}

impl<'a> CoupledGroup<'a> {
    /// # Errors
    /// Terms that the data cannot evaluate, or data that contradict the constraints.
    pub fn run(
        &self,
        names: &Discovery,
        watcher: &mut EquationObserver,
    ) -> Result<Concluded<'a>, Vec<Refusal>> {
        let (mut done, mut members, mut bad) = (Vec::new(), Vec::new(), Vec::new());
        for (place, task) in &self.tasks {
            watcher.set_equation(*place);
            match task.design(names, watcher) {
                Err(value) => bad.push(Refusal::Unevaluable((*place, value))),
                Ok(Err(failed)) => done.push((*place, Err(failed))),
                Ok(Ok(mut design)) => {
                    let selected = task.select(&mut design, &[Grading::PLAIN], watcher);
                    members.push(Member {
                        place: *place,
                        task,
                        design,
                        selected,
                    });
                }
            }
        }
        if !bad.is_empty() {
            return Err(bad);
        }
        let links = links(&self.tied, &members);
        let free: Vec<Pairs> = members.iter().map(|m| m.selected.pairs()).collect();
        let case = CoupledProblem {
            members: &members,
            links: &links,
            free: &free,
        };
        let (answers, pressing) = match solved(names, &case, watcher) {
            Ok(found) => found,
            Err(refusal) => return Err(vec![*refusal]),
        };
        let found: Vec<Pairs> = answers.iter().map(Estimate::pairs).collect();
        let doubts = constraint_strain::doubts(names, &case, &found, &pressing);
        for (m, answer) in members.iter().zip(&answers) {
            watcher.set_equation(m.place);
            let mut equation = m.task.conclude(names, &m.design, answer);
            equation.path = m.task.lasso_path(&m.design.problem(), watcher);
            done.push((m.place, Ok(equation)));
        }
        Ok(Concluded { done, doubts })
    }
}

/// Attaches the doubts of constraints to the equations of a complete discovery.
pub(crate) fn attach(d: &mut Discovery, doubts: &[(&Constraint, Reason)]) {
    for (constraint, reason) in doubts {
        doubt_equations(d, constraint, reason);
    }
}

/// The constraints all of whose equations take part, with blocks counted among these.
fn links<'a>(tied: &[&'a ConstraintRow<'a>], members: &[Member]) -> Vec<GroupConstraint<'a>> {
    let block = |place: usize| members.iter().position(|m| m.place == place);
    let entries = |t: &ConstraintRow| -> Option<Vec<(usize, usize, f64)>> {
        let entries = t.row.entries.iter();
        entries
            .map(|(p, j, w)| Some((block(*p)?, *j, *w)))
            .collect()
    };
    tied.iter()
        .filter_map(|t| {
            Some(GroupConstraint {
                constraint: t.constraint,
                row: LinearConstraint {
                    entries: entries(t)?,
                    sense: t.row.sense,
                    right: t.row.right,
                },
            })
        })
        .collect()
}

/// The estimates, and the constraints that are active. Free answers stand with their own certificates if they satisfy the
/// constraints or the run was stopped.
fn solved<'c>(
    names: &Discovery,
    case: &CoupledProblem<'_, 'c, '_, '_>,
    watcher: &mut EquationObserver,
) -> Result<(Vec<Estimate>, Vec<usize>), Box<Refusal>> {
    let CoupledProblem {
        members,
        links,
        free,
    } = *case;
    let as_free = || {
        let answers = members.iter();
        let answers = answers.map(|m| m.task.estimate(&m.design, &m.selected));
        (answers.collect::<Vec<Estimate>>(), Vec::new())
    };
    let obeyed = links.iter().all(|l| holds(&l.row, free));
    if obeyed || watcher.stop().is_some() {
        return Ok(as_free());
    }
    let rows: Vec<LinearConstraint> = links.iter().map(|l| l.row.clone()).collect();
    let supports = free_supports(free);
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
    let (chosen, proved) =
        joint_certificate::prove(names, case, &rows, chosen, &supports, watcher)?;
    let answers = members.iter().enumerate();
    let answers = answers.map(|(b, m)| joint_certificate::answer(b, m, &chosen, &proved, watcher));
    Ok((answers.collect(), chosen.fit.active.clone()))
}
