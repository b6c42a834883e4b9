//! The model's constraints held against what was found. The search does not use them; an answer that breaks one is doubted.

use super::{Discovery, Reason, Status};
use crate::lang::model::{Coefficient, Constraint, Model, Relation};
use crate::term::{Language, SignalNames};

/// Part of the largest summand by which an equality may miss.
const EQUAL: f64 = 1e-2;

pub(super) fn judge(d: &mut Discovery, model: &Model) {
    for constraint in &model.constraints {
        if holds(d, constraint) {
            continue;
        }
        let reason = Reason::new("constraint-broken", text(d, constraint));
        for e in &mut d.equations {
            let concerned = constraint.coefficients.iter().any(|c| c.target == e.target);
            if concerned && e.status != Status::Known {
                e.status = Status::Doubt;
                e.reasons.push(reason.clone());
            }
        }
    }
}

/// The coefficient as found; 0 if the term is not in the equation.
fn found(d: &Discovery, c: &Coefficient) -> f64 {
    d.equations
        .iter()
        .filter(|e| e.target == c.target)
        .flat_map(|e| &e.terms)
        .filter(|t| t.term == c.term)
        .map(|t| t.coefficient)
        .sum()
}

fn holds(d: &Discovery, constraint: &Constraint) -> bool {
    let summands = constraint
        .coefficients
        .iter()
        .map(|c| c.weight * found(d, c));
    let (mut sum, mut largest) = (constraint.constant, constraint.constant.abs());
    for s in summands {
        sum += s;
        largest = largest.max(s.abs());
    }
    match constraint.relation {
        Relation::Less => sum < 0.0,
        Relation::LessOrEqual => sum <= 0.0,
        Relation::Equal => sum.abs() <= EQUAL * largest,
        Relation::GreaterOrEqual => sum >= 0.0,
        Relation::Greater => sum > 0.0,
    }
}

fn text(d: &Discovery, constraint: &Constraint) -> String {
    let parts: Vec<String> = constraint
        .coefficients
        .iter()
        .map(|c| {
            let (target, term) = (d.name(c.target), Language(d).term(&c.term));
            format!("coef({target}, {term}) = {:.6}", found(d, c))
        })
        .collect();
    format!(
        "a constraint of the model does not hold: {}",
        parts.join(", ")
    )
}
