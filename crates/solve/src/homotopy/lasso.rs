//! The whole path, and the Lasso form: every knot is the answer to a family of problems.
//!
//! In: a problem (its ε ends the path). Out: knots from a = 0 on, each optimal over all columns. Between two knots the answer
//! is their linear interpolation in the penalty.

use super::super::frame::{is_finite, settle};
use super::super::reduce::norm;
use super::super::{CONSISTENT, Problem, Status};
use super::path::{End, Goal, Place, Turn};
use super::rounds::{Look, Rounds};
use super::unit;
use sidc_progress::Observer;

/// Excess over |φ_jᵀλ| ≤ ‖φ_j‖ with which a place is no knot.
const BROKEN: f64 = 1e-9;

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
    /// The column that comes in here: its coefficient is still zero.
    pub enters: Option<usize>,
    /// The column that leaves here: its coefficient is zero again.
    pub leaves: Option<usize>,
}

/// The answer at one penalty τ > 0, in the units of y, over columns of length one; a = 0 where τ ≥ max |φ_jᵀy|/‖φ_j‖.
/// The problem's own ε is not looked at. `None` if values are not finite, the observer stops it, or rounding ends the path.
pub fn lasso(problem: &Problem, penalty: f64, observer: &mut dyn Observer) -> Option<Knot> {
    let size = norm(problem.target);
    if !is_finite(problem, size) || penalty.is_nan() || penalty <= 0.0 {
        return None;
    }
    let target = unit(problem.target, size);
    let goal = Goal {
        tolerance: 0.0,
        penalty: penalty / size,
    };
    let rounds = Rounds::new(problem.dictionary, &target, goal);
    let Some(mut rounds) = rounds.filter(|r| r.level() > goal.penalty) else {
        return Some(nothing(problem, penalty, size));
    };
    let (place, status) = rounds.run(observer);
    (status == Status::Solved).then(|| knot(&rounds, &place, size))
}

/// All knots from a = 0 down to the problem's ε, at most `most`; the last is where ε is met, at τ = 0 if that leaves nothing of y.
/// Empty where a = 0 meets ε. Shorter where the observer stops it, where rounding ends the path, or where ε is out of reach: the
/// path then ends in a least-squares fit at τ = 0, which is no knot. Every knot is priced over all columns.
pub fn lasso_path(problem: &Problem, most: usize, observer: &mut dyn Observer) -> Vec<Knot> {
    let mut knots: Vec<Knot> = Vec::new();
    let Ok(size) = settle(problem) else {
        return knots;
    };
    let target = unit(problem.target, size);
    let goal = Goal {
        tolerance: problem.tolerance / size,
        penalty: 0.0,
    };
    let Some(mut rounds) = Rounds::new(problem.dictionary, &target, goal) else {
        return knots;
    };
    knots.push(Knot {
        enters: rounds.column(0),
        ..nothing(problem, rounds.level() * size, size)
    });
    while knots.len() < most {
        let place = rounds.walk(1, observer);
        match (place.end, rounds.look(&place)) {
            (End::Interrupted, _) | (_, Look::Fails) => break,
            // Knots at smaller penalties were met without the columns that joined.
            (_, Look::Changed) => knots.retain(|k| k.penalty >= rounds.level() * size),
            (End::Lost, Look::Stays) => break,
            // A column at hand is beyond its bound: its step was lost in rounding.
            (_, Look::Stays) if rounds.violation() > BROKEN => break,
            (End::Stuck, Look::Stays) if place.residual > CONSISTENT => break,
            (end, Look::Stays) => {
                knots.push(knot(&rounds, &place, size));
                if end != End::Due {
                    break;
                }
            }
        }
    }
    knots.truncate(most);
    knots
}

/// a = 0
fn nothing(problem: &Problem, penalty: f64, size: f64) -> Knot {
    Knot {
        penalty,
        residual: size,
        coefficients: Vec::new(),
        dual: problem.target.iter().map(|y| y / penalty).collect(),
        enters: None,
        leaves: None,
    }
}

fn knot(rounds: &Rounds, place: &Place, size: f64) -> Knot {
    Knot {
        penalty: place.level * size,
        residual: place.residual * size,
        coefficients: rounds.raw(&place.coefficients, size),
        dual: place.lambda.clone(),
        enters: match place.turn {
            Turn::Enters(k) => rounds.column(k),
            _ => None,
        },
        leaves: match place.turn {
            Turn::Leaves(k, _) => rounds.column(k),
            _ => None,
        },
    }
}
