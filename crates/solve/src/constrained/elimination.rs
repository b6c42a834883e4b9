//! Elimination of linear equations: some variables as linear functions of the free ones.
//!
//! In: dense rows `c·z = d`. Out: `z = constant + matrix · u` over the free variables u, or that the equations are inconsistent.

use nalgebra::DMatrix;

use super::problem::LinearConstraint;
use crate::thresholds::{LINEAR_CONSTRAINTS, NUMERICAL_RANK};

/// One linear equation or inequality in n variables: a hyperplane.
#[derive(Clone, Debug)]
pub(super) struct Hyperplane {
    pub weights: Vec<f64>,
    pub right: f64,
}

impl Hyperplane {
    pub fn value(&self, z: &[f64]) -> f64 {
        self.weights.iter().zip(z).map(|(w, z)| w * z).sum()
    }

    /// The largest summand, which rounding is relative to.
    pub fn largest_summand(&self, z: &[f64]) -> f64 {
        let summands = self.weights.iter().zip(z).map(|(w, z)| (w * z).abs());
        summands.fold(self.right.abs(), f64::max)
    }
}

/// All solutions of the equations: every u gives one.
#[derive(Clone, Debug)]
pub struct SolutionSpace {
    /// Length n; zero on the free variables.
    pub constant: Vec<f64>,
    /// n × free variables.
    pub matrix: DMatrix<f64>,
}

/// The coefficients of one block of `columns` columns for which all rows hold as equations; `None` if there are none.
pub fn solution_space<'r>(
    columns: usize,
    rows: impl IntoIterator<Item = &'r LinearConstraint>,
) -> Option<SolutionSpace> {
    let plane = |row: &LinearConstraint| {
        let mut weights = vec![0.0; columns];
        for (_, column, weight) in &row.entries {
            if let Some(w) = weights.get_mut(*column) {
                *w += weight;
            }
        }
        let right = row.right;
        Hyperplane { weights, right }
    };
    let planes: Vec<Hyperplane> = rows.into_iter().map(plane).collect();
    eliminate(columns, &planes.iter().collect::<Vec<_>>())
}

/// Gauss–Jordan with complete pivoting (Golub & Van Loan, section 3.4); `None` for inconsistent equations.
pub(super) fn eliminate(n: usize, planes: &[&Hyperplane]) -> Option<SolutionSpace> {
    let mut rows: Vec<Vec<f64>> = planes.iter().map(|p| normalised(p, n)).collect();
    let scale = rows.iter().map(|r| r[n].abs()).fold(0.0, f64::max);
    let mut pivots: Vec<usize> = Vec::new();
    while let Some((row, variable)) = pivot(&rows, pivots.len(), n) {
        let place = pivots.len();
        rows.swap(place, row);
        let pivot = rows[place][variable];
        rows[place].iter_mut().for_each(|w| *w /= pivot);
        let lead = rows[place].clone();
        for (k, other) in rows.iter_mut().enumerate() {
            let factor = other[variable];
            if k != place && factor != 0.0 {
                other
                    .iter_mut()
                    .zip(&lead)
                    .for_each(|(o, l)| *o -= factor * l);
                other[variable] = 0.0;
            }
        }
        pivots.push(variable);
    }
    let dependent = rows.iter().skip(pivots.len());
    if dependent
        .map(|r| r[n].abs())
        .any(|d| d > LINEAR_CONSTRAINTS.contradiction * scale)
    {
        return None;
    }
    let free: Vec<usize> = (0..n).filter(|v| !pivots.contains(v)).collect();
    let mut constant = vec![0.0; n];
    let mut matrix = DMatrix::zeros(n, free.len());
    for (k, &v) in free.iter().enumerate() {
        matrix[(v, k)] = 1.0;
    }
    for (row, &v) in rows.iter().zip(&pivots) {
        constant[v] = row[n];
        for (k, &f) in free.iter().enumerate() {
            matrix[(v, k)] = -row[f];
        }
    }
    Some(SolutionSpace { constant, matrix })
}

/// Weights and right side, divided by the largest weight.
fn normalised(plane: &Hyperplane, n: usize) -> Vec<f64> {
    let mut row = plane.weights.clone();
    row.resize(n, 0.0);
    let largest = row.iter().fold(0.0_f64, |m, w| m.max(w.abs()));
    row.push(plane.right);
    if largest > 0.0 {
        row.iter_mut().for_each(|w| *w /= largest);
    }
    row
}

/// The place of the largest weight among the rows from `first` on.
fn pivot(rows: &[Vec<f64>], first: usize, n: usize) -> Option<(usize, usize)> {
    let mut best = (NUMERICAL_RANK.dependent, None);
    for (k, row) in rows.iter().enumerate().skip(first) {
        for (v, w) in row.iter().take(n).enumerate() {
            if w.abs() > best.0 {
                best = (w.abs(), Some((k, v)));
            }
        }
    }
    best.1
}
