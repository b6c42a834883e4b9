//! The last check: every constraint of the model is held against the equations found, however they were found.
//!
//! In: a discovery and its model. Out: doubts; the text of constraints. Never changes coefficients.

use crate::constrained::thresholds::CONSTRAINTS;
use sidc_lang::model::{Coefficient, Constraint, Model, Relation};
use sidc_lang::number::rounded;
use sidc_lang::term::{Language, SignalNames};
use sidc_system::discovery::{Discovery, Reason, ReasonCode, Status};

/// Doubts the equations of every constraint that does not hold. A strict bound that is met exactly counts as holding here; it has
/// its own doubt, `at-bound`.
pub(crate) fn doubt_broken(d: &mut Discovery, model: &Model) {
    for constraint in &model.constraints {
        if !holds(d, constraint) {
            let reason = Reason::new(ReasonCode::ConstraintBroken, text(d, constraint));
            doubt_equations(d, constraint, &reason);
        }
    }
}

/// Gives the reason to every equation that the constraint names.
pub(crate) fn doubt_equations(d: &mut Discovery, constraint: &Constraint, reason: &Reason) {
    for e in &mut d.equations {
        let concerned = constraint.coefficients.iter().any(|c| c.target == e.target);
        if concerned && e.status != Status::Known {
            e.doubt(reason.clone());
        }
    }
}

/// The coefficient found; 0 if the term is not in the equation.
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
        Relation::Less | Relation::LessOrEqual => sum <= CONSTRAINTS.reported_rounding * largest,
        Relation::Equal => sum.abs() <= CONSTRAINTS.reported_rounding * largest,
        Relation::GreaterOrEqual | Relation::Greater => {
            sum >= -CONSTRAINTS.reported_rounding * largest
        }
    }
}

fn text(d: &Discovery, constraint: &Constraint) -> String {
    format!(
        "{} does not hold: {}",
        constraint_text(d, constraint),
        values(d, constraint)
    )
}

/// `coef(dx, x) = 0.5, coef(dy, x) = 0`
fn values(d: &Discovery, constraint: &Constraint) -> String {
    let parts: Vec<String> = constraint
        .coefficients
        .iter()
        .map(|c| format!("{} = {}", coefficient_text(d, c), six_digits(found(d, c))))
        .collect();
    parts.join(", ")
}

/// `coef(dx, x)`
pub(crate) fn coefficient_text(names: &impl SignalNames, c: &Coefficient) -> String {
    let (target, term) = (names.name(c.target), Language(names).term(&c.term));
    format!("coef({target}, {term})")
}

/// `coef(dx, x) - 2*coef(dy, x) <= 0.5`: the constraint with its coefficients on the left, the first of them positive.
pub(crate) fn constraint_text(names: &impl SignalNames, constraint: &Constraint) -> String {
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
        out.push_str(&coefficient_text(names, c));
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
pub(crate) fn six_digits(x: f64) -> f64 {
    rounded(x, 6) + 0.0
}
