//! Basis pursuit on several blocks whose coefficients are tied by linear constraints: the problem, and what a solver found.

use crate::problem::Problem;
use crate::thresholds::LINEAR_CONSTRAINTS;

/// The relation of the left side of a constraint to its right side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    Equal,
    AtMost,
    /// Strictly less: solved as [`Sense::AtMost`]; strict only in [`irreducible_infeasible_set`](crate::irreducible_infeasible_set).
    Below,
}

/// `Σ weight · a_{block, column}  SENSE  right`, coefficients in the units of the raw columns.
#[derive(Clone, Debug)]
pub struct LinearConstraint {
    /// (block, column, weight); no (block, column) twice.
    pub entries: Vec<(usize, usize, f64)>,
    pub sense: Sense,
    pub right: f64,
}

impl LinearConstraint {
    /// Left side minus right side, and the size of the largest summand, which rounding is relative to.
    pub fn excess(&self, coefficient: &dyn Fn(usize, usize) -> f64) -> (f64, f64) {
        let (mut sum, mut largest) = (-self.right, self.right.abs());
        for (block, column, weight) in &self.entries {
            let summand = weight * coefficient(*block, *column);
            sum += summand;
            largest = largest.max(summand.abs());
        }
        (sum, largest)
    }

    /// Whether it holds to rounding.
    pub fn holds(&self, coefficient: &dyn Fn(usize, usize) -> f64) -> bool {
        let (sum, largest) = self.excess(coefficient);
        let rounding = LINEAR_CONSTRAINTS.violation * largest;
        match self.sense {
            Sense::Equal => sum.abs() <= rounding,
            Sense::AtMost | Sense::Below => sum <= rounding,
        }
    }

    /// Whether it holds as an equation, to rounding.
    pub fn is_touched(&self, coefficient: &dyn Fn(usize, usize) -> f64) -> bool {
        let (sum, largest) = self.excess(coefficient);
        sum.abs() <= LINEAR_CONSTRAINTS.violation * largest
    }
}

/// `min Σ_e ‖D_e a_e‖₁/‖y_e‖ s.t. ‖Φ_e a_e − y_e‖₂ ≤ ε_e` and the rows.
pub struct ConstrainedProblem<'a> {
    pub blocks: Vec<Problem<'a>>,
    pub rows: Vec<LinearConstraint>,
}

/// What the conic solver found; [`certify_constrained`](crate::certify_constrained) says what it is worth.
#[derive(Clone, Debug)]
pub struct ConstrainedSolution {
    /// For each block the coefficients that are not zero, by rising column, in the units of the raw columns.
    pub coefficients: Vec<Vec<(usize, f64)>>,
    /// λ_e of each block, length M_e.
    pub duals: Vec<Vec<f64>>,
    /// ν of each row; at most zero for inequalities.
    pub multipliers: Vec<f64>,
    pub outcome: Outcome,
    pub iterations: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The conic solver met its own test, and no column of the dictionaries was left to add.
    Solved,
    /// It stopped before.
    Inaccurate,
    /// Rows and data admit no coefficients.
    Infeasible,
    Interrupted,
}

impl ConstrainedProblem<'_> {
    /// Columns of a block that constraints name.
    pub(super) fn named_columns(&self, block: usize) -> Vec<usize> {
        let entries = self.rows.iter().flat_map(|r| &r.entries);
        entries
            .filter(|(b, _, _)| *b == block)
            .map(|(_, j, _)| *j)
            .collect()
    }
}
