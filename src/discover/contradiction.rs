//! Constraints that the data contradict: no candidate terms make up for what a constraint takes from the fit.
//!
//! In: tied equations whose chosen terms leave more than the data's errors. Out: tolerances that admit the constraints, or an
//! error with a smallest set of constraints at fault, and what the data want instead.

use super::Discovery;
use super::Refusal;
use super::constraints::{coefficient, figure, written};
use super::together::{Link, Member};
use super::weights::norm;
use crate::lang::diagnostic::Diagnostic;
use crate::lang::model::{Coefficient, Constraint};
use crate::solve::{Joint, Row, nearest};
use crate::term::SignalNames;

/// Square of the deviation, in standard errors, that true constraints do not reach.
const SIGNIFICANT: f64 = 30.0;
/// Relative residual under which numbers, not data, decide.
const NUMERICAL: f64 = 1e-6;
/// Room that the tolerance leaves over the smallest residual there is.
const ROOM: f64 = 1.001;

/// (column, coefficient) of one equation's terms, by rising column.
pub(super) type Pairs = Vec<(usize, f64)>;

/// Tied equations and their free answers.
pub(super) struct Case<'m, 'c, 't, 'a> {
    pub members: &'m [Member<'t, 'a>],
    pub links: &'m [Link<'c>],
    pub free: &'m [Pairs],
}

/// ε of each block, widened as far as the constraints need and the data's errors allow.
///
/// # Errors
/// The constraints cost more than these errors.
pub(super) fn widened(
    names: &Discovery,
    case: &Case,
    joint: &Joint,
    start: &[Vec<usize>],
) -> Result<Vec<f64>, Box<Refusal>> {
    let reached = nearest(joint, start);
    if allowed(case, &reached) {
        let blocks = case.members.iter().zip(&reached);
        return Ok(blocks
            .map(|(m, r)| {
                let (own, size) = (m.prepared.tolerance, norm(&m.prepared.aim));
                let needed = r * size;
                if needed > own { ROOM * needed } else { own }
            })
            .collect());
    }
    let set = smallest(case, joint, start);
    Err(Box::new(Refusal::Contradiction(contradiction(
        names, case, &set, &reached,
    ))))
}

/// True if every block's relative residual is within what its errors explain.
fn allowed(case: &Case, reached: &[f64]) -> bool {
    case.members.iter().zip(reached).all(|(m, r)| {
        let p = &m.prepared;
        let criterion = &m.proposed.criterion;
        let size = norm(&p.aim);
        let noise = p.tolerance.powi(2) * (1.0 + SIGNIFICANT / criterion.samples);
        let floor = criterion.floor * criterion.rows;
        (r * size).powi(2) <= noise.max(floor).max((NUMERICAL * size).powi(2))
    })
}

/// Deletion filter: what contradicts the data without a constraint does not need it.
fn smallest(case: &Case, joint: &Joint, start: &[Vec<usize>]) -> Vec<usize> {
    let mut kept: Vec<usize> = (0..case.links.len()).collect();
    for k in 0..case.links.len() {
        let without: Vec<usize> = kept.iter().copied().filter(|i| *i != k).collect();
        let rows: Vec<Row> = without.iter().map(|i| case.links[*i].row.clone()).collect();
        let blocks = joint.blocks.iter().map(|b| crate::solve::Problem {
            dictionary: b.dictionary,
            target: b.target,
            tolerance: b.tolerance,
        });
        let lesser = Joint {
            blocks: blocks.collect(),
            rows,
        };
        if !allowed(case, &nearest(&lesser, start)) {
            kept = without;
        }
    }
    kept
}

fn contradiction(names: &Discovery, case: &Case, set: &[usize], reached: &[f64]) -> Diagnostic {
    let links: Vec<&Link> = set.iter().map(|k| &case.links[*k]).collect();
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
            written(names, link.constraint),
            wanted(names, case.members, link.constraint, case.free)
        );
        d = d.at(link.constraint.span, label);
    }
    for (b, (m, r)) in case.members.iter().zip(reached).enumerate() {
        let mut entries = links.iter().flat_map(|l| &l.row.entries);
        if entries.any(|e| e.0 == b) {
            let size = norm(&m.prepared.aim);
            d = d.fact(format!(
                "{}: the residual is at best {r:.1e} of the target under the constraints, {:.1e} without",
                names.name(m.task.target),
                m.proposed.polished.residual / size
            ));
        }
    }
    d.help("look at signs, units and the system itself; leave the constraint out to see the equations that the data want")
}

/// `coef(dx, x) = -10, coef(dy, x) = 0`: what the free answers give a constraint's coefficients, known parts included.
pub(super) fn wanted(
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
    let parts = parts.map(|c| format!("{} = {}", coefficient(names, c), figure(value(c))));
    parts.collect::<Vec<String>>().join(", ")
}
