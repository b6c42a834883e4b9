//! Sparse solvers: numbers in, numbers and a status out; no names, no files.
//!
//! A solver is one file that implements [`Solver`] and one line in [`SOLVERS`].

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod certificate;
mod clarabel;
pub mod dictionary;
mod frame;
mod homotopy;
mod joint;
pub mod lanes;
mod lasso_gap;
mod least_squares;
pub mod linalg;
mod memory;
mod omp;
#[cfg(test)]
mod planted;
mod polish;
mod pool;
pub mod quadratic;
mod reduce;
mod stlsq;
pub mod threads;
pub mod white;
mod working_set;

use sidc_progress::Observer;

use crate::dictionary::Dictionary;

pub use certificate::{Certificate, certify, certify_support, refine_dual, support};
pub use clarabel::Clarabel;
pub use homotopy::{Homotopy, Knot, lasso, lasso_path};
pub use joint::{
    Fit, FitBlock, Joint, JointProof, JointSolution, Outcome, Row, Sense, certify_joint, conflict,
    fit, nearest, solve_joint,
};
pub use lasso_gap::{LassoCertificate, certify_lasso};
pub use least_squares::{LeastSquares, least_squares};
pub use memory::Memory;
pub use omp::Omp;
pub use polish::{Polished, polish};
pub use stlsq::Stlsq;

/// With ε = 0, a residual up to this part of ‖y‖ is rounding and not a contradiction.
pub const CONSISTENT: f64 = 1e-9;

/// `min ‖D a‖₁ s.t. ‖Φ a − y‖₂ ≤ ε`, D the column norms: basis pursuit (ε = 0) or basis pursuit denoising on unit columns.
pub struct Problem<'a> {
    pub dictionary: &'a dyn Dictionary,
    /// y, length M.
    pub target: &'a [f64],
    /// ε ≥ 0, in the units of y.
    pub tolerance: f64,
}

impl Problem<'_> {
    /// y − Φ a, for the coefficients that are not zero, in raw units.
    pub fn left(&self, coefficients: &[(usize, f64)]) -> Vec<f64> {
        let mut left = self.target.to_vec();
        let mut column = vec![0.0; left.len()];
        for (j, a) in coefficients {
            self.dictionary.column(*j, &mut column);
            reduce::add_scaled(&mut left, -a, &column);
        }
        left
    }

    /// |a_j|‖φ_j‖ of the coefficients given, in their order; zero past the last column.
    pub fn shares(&self, coefficients: &[(usize, f64)]) -> impl Iterator<Item = f64> {
        let norms = self.dictionary.norms();
        let share = |(j, a): &(usize, f64)| a.abs() * norms.get(*j).copied().unwrap_or(0.0);
        coefficients.iter().map(share)
    }
}

/// What a solver found. Always finite; `status` says how far to believe it.
#[derive(Clone, Debug)]
pub struct Solution {
    /// The coefficients that are not zero, by rising column, in the units of the raw columns.
    pub coefficients: Vec<(usize, f64)>,
    /// λ, length M: a dual point, near-feasible for |φ_jᵀλ| ≤ ‖φ_j‖.
    pub dual: Vec<f64>,
    pub status: Status,
    pub iterations: usize,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Status {
    /// The solver's own stopping test was met.
    Solved,
    /// It stopped short: the relative gap and residual it reached.
    Inaccurate {
        gap: f64,
        residual: f64,
    },
    /// Φ a = y (within ε) has no solution; the smallest residual found.
    Inconsistent {
        residual: f64,
    },
    Interrupted,
    /// The solver does not take problems of this kind or size; the reason is a sentence for users.
    Refused {
        reason: String,
    },
}

impl Solution {
    /// a_j, zero where nothing was found.
    pub fn coefficient(&self, column: usize) -> f64 {
        let at = self.coefficients.binary_search_by_key(&column, |(j, _)| *j);
        at.ok()
            .and_then(|k| self.coefficients.get(k))
            .map_or(0.0, |(_, a)| *a)
    }

    /// a = 0, λ = 0.
    pub(crate) fn zero(problem: &Problem, status: Status) -> Solution {
        Solution {
            coefficients: Vec::new(),
            dual: vec![0.0; problem.dictionary.rows()],
            status,
            iterations: 0,
        }
    }
}

impl Status {
    /// Nothing usable was reached, for example because an input is not finite.
    pub(crate) fn broken() -> Status {
        Status::Inaccurate {
            gap: f64::INFINITY,
            residual: f64::INFINITY,
        }
    }
}

pub trait Solver: Sync {
    /// What `--solver` takes.
    fn name(&self) -> &'static str;
    /// One line for help texts.
    fn about(&self) -> &'static str;
    /// True if it solves the problem stated and gives a dual point that can prove so. False for a heuristic: its answer
    /// fits, but another may be smaller or sparser, and its dual is zero.
    fn exact(&self) -> bool {
        true
    }
    /// Tells the observer of every iteration; where it ends the work, the answer is what there is by then.
    fn solve(&self, problem: &Problem, observer: &mut dyn Observer) -> Solution;
}

/// Every solver; the first is the default, heuristics come last.
pub static SOLVERS: &[&dyn Solver] = &[&Homotopy, &Clarabel, &Omp, &Stlsq];

/// Looks a solver up by name.
///
/// ```
/// use sidc_solve::dictionary::Dense;
/// use sidc_progress::Unwatched;
/// use sidc_solve::{Problem, solver};
///
/// // Columns (1, 0, 0), (0, 1, 0) and (1, 1, 1): the target is twice the last.
/// let phi = Dense::new(3, vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 1.0]);
/// let problem = Problem { dictionary: &phi, target: &[2.0, 2.0, 2.0], tolerance: 0.0 };
/// for name in ["homotopy", "clarabel", "omp"] {
///     let found = solver(name).map(|s| s.solve(&problem, &mut Unwatched));
///     assert!(found.is_some_and(|s| (s.coefficient(2) - 2.0).abs() < 1e-6));
/// }
/// assert!(solver("magic").is_none());
/// ```
pub fn solver(name: &str) -> Option<&'static dyn Solver> {
    SOLVERS.iter().copied().find(|s| s.name() == name)
}
