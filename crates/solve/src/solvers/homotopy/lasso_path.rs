//! The Lasso at one penalty, and the whole Lasso path.
//!
//! In: a problem (its ε ends the path). Out: knots from a = 0 on, each optimal over all columns. Between two knots the answer is
//! linear in the penalty.

use super::column_generation::{ColumnGeneration, Pricing};
use super::path::{ActiveSetChange, Goal, PathPoint, Stop};
use crate::linalg::{norm, quotient};
use crate::problem::{Problem, Status};
use crate::solvers::presolve::{is_finite, presolve};
use crate::thresholds::{CERTIFICATES, HOMOTOPY};
use sidc_progress::Observer;

/// The answer of `min ½‖Φa − y‖₂² + τ‖D a‖₁`, which also is that of `min ‖D a‖₁ s.t. ‖Φa − y‖₂ ≤ ε` at its own residual.
#[derive(Clone, Debug)]
pub struct Knot {
    /// τ, in the units of y.
    pub penalty: f64,
    /// ‖Φa − y‖₂, in the units of y.
    pub residual: f64,
    /// By rising column, in the units of the raw columns.
    pub coefficients: Vec<(usize, f64)>,
    /// λ = (y − Φa)/τ, length M: |φ_jᵀλ| ≤ ‖φ_j‖ for every column. At τ = 0 its limit.
    pub dual: Vec<f64>,
    /// The column that enters here: its coefficient is still zero.
    pub enters: Option<usize>,
    /// The column that leaves here: its coefficient is zero again.
    pub leaves: Option<usize>,
}

/// The answer at one penalty τ > 0, in the units of y, over columns of length one; a = 0 where τ ≥ max |φ_jᵀy|/‖φ_j‖.
/// The problem's own ε is ignored. `None` if values are not finite, the observer stops it, or rounding ends the path.
pub fn lasso(problem: &Problem, penalty: f64, observer: &mut dyn Observer) -> Option<Knot> {
    let target_norm = norm(problem.target);
    if !is_finite(problem, target_norm) || penalty.is_nan() || penalty <= 0.0 {
        return None;
    }
    let target = quotient(problem.target, target_norm);
    let goal = Goal {
        tolerance: 0.0,
        penalty: penalty / target_norm,
    };
    let path = ColumnGeneration::new(problem.dictionary, &target, goal);
    let Some(mut path) = path.filter(|r| r.penalty() > goal.penalty) else {
        return Some(zero(problem, penalty, target_norm));
    };
    let (point, status) = path.run(observer);
    (status == Status::Solved).then(|| knot(&path, &point, target_norm))
}

/// All knots from a = 0 down to the problem's ε, at most `most`. The last is where ε is met, at τ = 0 if the residual is zero.
/// Empty where a = 0 meets ε. Shorter where the observer stops it, where rounding ends the path, or where ε is out of reach: the
/// path then ends in a least-squares fit at τ = 0, which is no knot. Every knot is priced over all columns.
pub fn lasso_path(problem: &Problem, most: usize, observer: &mut dyn Observer) -> Vec<Knot> {
    let mut knots: Vec<Knot> = Vec::new();
    let Ok(target_norm) = presolve(problem) else {
        return knots;
    };
    let target = quotient(problem.target, target_norm);
    let goal = Goal {
        tolerance: problem.tolerance / target_norm,
        penalty: 0.0,
    };
    let Some(mut path) = ColumnGeneration::new(problem.dictionary, &target, goal) else {
        return knots;
    };
    knots.push(Knot {
        enters: path.column(0),
        ..zero(problem, path.penalty() * target_norm, target_norm)
    });
    while knots.len() < most {
        let point = path.advance(1, observer);
        match (point.stop, path.price_all(&point)) {
            (Stop::Interrupted, _) | (_, Pricing::Breakdown) => break,
            // Knots at smaller penalties were found without the columns that entered.
            (_, Pricing::PathChanged) => {
                knots.retain(|k| k.penalty >= path.penalty() * target_norm)
            }
            (Stop::Breakdown, Pricing::PathStays) => break,
            // A column of the working set violates its bound: its step was lost in rounding.
            (_, Pricing::PathStays) if path.violation() > HOMOTOPY.knot_violation => break,
            (Stop::ResidualOrthogonal, Pricing::PathStays)
                if point.residual > CERTIFICATES.consistent =>
            {
                break;
            }
            (end, Pricing::PathStays) => {
                knots.push(knot(&path, &point, target_norm));
                if end != Stop::PricingDue {
                    break;
                }
            }
        }
    }
    knots.truncate(most);
    knots
}

/// a = 0
fn zero(problem: &Problem, penalty: f64, target_norm: f64) -> Knot {
    Knot {
        penalty,
        residual: target_norm,
        coefficients: Vec::new(),
        dual: problem.target.iter().map(|y| y / penalty).collect(),
        enters: None,
        leaves: None,
    }
}

fn knot(path: &ColumnGeneration, point: &PathPoint, target_norm: f64) -> Knot {
    Knot {
        penalty: point.penalty * target_norm,
        residual: point.residual * target_norm,
        coefficients: path.raw(&point.coefficients, target_norm),
        dual: point.lambda.clone(),
        enters: match point.change {
            ActiveSetChange::Enters(k) => path.column(k),
            _ => None,
        },
        leaves: match point.change {
            ActiveSetChange::Leaves(k, _) => path.column(k),
            _ => None,
        },
    }
}
