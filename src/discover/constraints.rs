//! The model's constraints as text, and held against what was found: the last check, after they were solved.

use super::{Discovery, Reason, Status};
use crate::lang::model::{Coefficient, Constraint, Model, Relation};
use crate::term::{Language, SignalNames};

/// Part of the largest summand by which a relation may miss.
const EQUAL: f64 = 1e-9;

/// Doubts the equations of every constraint that does not hold. A strict bound that is reached has a doubt of its own.
pub(super) fn judge(d: &mut Discovery, model: &Model) {
    for constraint in &model.constraints {
        if !holds(d, constraint) {
            let reason = Reason::new("constraint-broken", text(d, constraint));
            doubt(d, constraint, &reason);
        }
    }
}

/// Gives the reason to every equation that the constraint is about.
pub(super) fn doubt(d: &mut Discovery, constraint: &Constraint, reason: &Reason) {
    for e in &mut d.equations {
        let concerned = constraint.coefficients.iter().any(|c| c.target == e.target);
        if concerned && e.status != Status::Known {
            e.status = Status::Doubt;
            e.reasons.push(reason.clone());
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
        Relation::Less | Relation::LessOrEqual => sum <= EQUAL * largest,
        Relation::Equal => sum.abs() <= EQUAL * largest,
        Relation::GreaterOrEqual | Relation::Greater => sum >= -EQUAL * largest,
    }
}

fn text(d: &Discovery, constraint: &Constraint) -> String {
    format!(
        "{} does not hold: {}",
        written(d, constraint),
        values(d, constraint)
    )
}

/// `coef(dx, x) = 0.5, coef(dy, x) = 0`
fn values(d: &Discovery, constraint: &Constraint) -> String {
    let parts: Vec<String> = constraint
        .coefficients
        .iter()
        .map(|c| format!("{} = {}", coefficient(d, c), figure(found(d, c))))
        .collect();
    parts.join(", ")
}

/// `coef(dx, x)`
pub(super) fn coefficient(names: &impl SignalNames, c: &Coefficient) -> String {
    let (target, term) = (names.name(c.target), Language(names).term(&c.term));
    format!("coef({target}, {term})")
}

/// `coef(dx, x) - 2*coef(dy, x) <= 0.5`: the constraint with its coefficients on the left, the first of them positive.
pub(super) fn written(names: &impl SignalNames, constraint: &Constraint) -> String {
    let first = constraint.coefficients.first().map_or(1.0, |c| c.weight);
    let flip = if first < 0.0 { -1.0 } else { 1.0 };
    let mut out = String::new();
    for (i, c) in constraint.coefficients.iter().enumerate() {
        let weight = flip * c.weight;
        out.push_str(match (i, weight < 0.0) {
            (0, _) => "",
            (_, true) => " - ",
            (_, false) => " + ",
        });
        if weight.abs() != 1.0 {
            out.push_str(&format!("{}*", weight.abs()));
        }
        out.push_str(&coefficient(names, c));
    }
    let relation = match (constraint.relation, flip < 0.0) {
        (Relation::Less, false) | (Relation::Greater, true) => "<",
        (Relation::LessOrEqual, false) | (Relation::GreaterOrEqual, true) => "<=",
        (Relation::Equal, _) => "=",
        (Relation::GreaterOrEqual, false) | (Relation::LessOrEqual, true) => ">=",
        (Relation::Greater, false) | (Relation::Less, true) => ">",
    };
    // Adding zero turns −0 into 0.
    let right = -flip * constraint.constant + 0.0;
    format!("{out} {relation} {right}")
}

/// Six significant digits; −0 is 0.
pub(super) fn figure(x: f64) -> f64 {
    format!("{x:.5e}").parse::<f64>().unwrap_or(x) + 0.0
}
