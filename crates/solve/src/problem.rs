//! Basis pursuit as numbers: the problem, and what a solver found.

use crate::dictionary::Dictionary;
use crate::simd::axpy;

/// `min ‖D a‖₁ s.t. ‖Φ a − y‖₂ ≤ ε`, D the columns' weights: basis pursuit (ε = 0) or basis pursuit denoising. The weights are the
/// columns' lengths, or more where columns are graded.
pub struct Problem<'a> {
    pub dictionary: &'a dyn Dictionary,
    /// y, length M.
    pub target: &'a [f64],
    /// ε ≥ 0, in the units of y.
    pub tolerance: f64,
}

impl Problem<'_> {
    /// y − Φ a, for the coefficients that are not zero, in raw units.
    pub fn residual(&self, coefficients: &[(usize, f64)]) -> Vec<f64> {
        let mut residual = self.target.to_vec();
        let mut column = vec![0.0; residual.len()];
        for (j, a) in coefficients {
            self.dictionary.column(*j, &mut column);
            axpy(-a, &column, &mut residual);
        }
        residual
    }

    /// |a_j| w_j of the coefficients given, in their order; zero past the last column.
    pub fn contributions(&self, coefficients: &[(usize, f64)]) -> impl Iterator<Item = f64> {
        let contribution = |(j, a): &(usize, f64)| a.abs() * self.dictionary.weight(*j);
        coefficients.iter().map(contribution)
    }
}

/// What a solver found. Always finite; `status` says what it is worth.
#[derive(Clone, Debug)]
pub struct Solution {
    /// The coefficients that are not zero, by rising column, in the units of the raw columns.
    pub coefficients: Vec<(usize, f64)>,
    /// λ, length M: a dual point, near-feasible for |φ_jᵀλ| ≤ w_j.
    pub dual: Vec<f64>,
    pub status: Status,
    pub iterations: usize,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Status {
    /// The solver's own stopping test was met.
    Solved,
    /// It stopped before, with this relative gap and residual.
    Inaccurate {
        gap: f64,
        residual: f64,
    },
    /// Φ a = y (within ε) has no solution; the smallest residual found.
    Inconsistent {
        residual: f64,
    },
    Interrupted,
    /// The solver does not accept problems of this size; the reason is a sentence for users.
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
    /// Nothing usable was found, for example because an input is not finite.
    pub(crate) fn broken_down() -> Status {
        Status::Inaccurate {
            gap: f64::INFINITY,
            residual: f64::INFINITY,
        }
    }
}
