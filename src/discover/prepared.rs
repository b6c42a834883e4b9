//! An equation before its solver starts: rows, Φ, and what the data's errors allow.
//!
//! In: Φ and a target, however their rows were come by. Out: the problem with its tolerance. Chooses nothing.

use super::rows::Split;
use super::weights::{Weights, norm};
use crate::data::Samples;
use crate::dictionary::Dictionary;
use crate::solve::{self, Problem};

/// Smallest ε of a tall system, relative: below it, rounding decides.
const EXACT: f64 = 1e-9;
/// Room that the noise tolerance leaves over the smallest residual there is.
const ROOM: f64 = 1.001;
/// Relative residual of the whole library above which noise is plain to see.
const VISIBLE: f64 = 1e-2;

/// What the rows are.
pub(super) enum Basis {
    /// Instants, with the target there, known parts taken off, unweighted.
    Samples {
        split: Split,
        used: Samples,
        y: Vec<f64>,
    },
    /// Integrals against windows that reach so many samples to each side, whitened.
    Integrals { rows: usize, reach: usize },
}

/// Rows, Φ and what the data's errors allow: all that is there before a solver starts.
pub(super) struct Prepared {
    pub basis: Basis,
    pub weights: Weights,
    pub phi: Box<dyn Dictionary>,
    /// y, rows weighted.
    pub aim: Vec<f64>,
    /// ε
    pub tolerance: f64,
}

impl Prepared {
    /// Φ and y, rows weighted; the tolerance is what errors, or the whole library's residual, allow.
    pub fn new(
        basis: Basis,
        mut weights: Weights,
        phi: Box<dyn Dictionary>,
        aim: Vec<f64>,
    ) -> Prepared {
        let whitened = matches!(basis, Basis::Integrals { .. });
        let correlation = weights.correlation;
        let tolerance = tolerance(phi.as_ref(), &aim, &mut weights);
        if whitened {
            // Errors are independent as far as is known; what else is left is no noise.
            weights.correlation = correlation;
        }
        Prepared {
            basis,
            weights,
            phi,
            aim,
            tolerance,
        }
    }

    pub fn problem(&self) -> Problem<'_> {
        Problem {
            dictionary: self.phi.as_ref(),
            target: &self.aim,
            tolerance: self.tolerance,
        }
    }
}

/// ε: the data's own estimated error, or, where more rows than terms show a larger one, that.
fn tolerance(phi: &dyn Dictionary, y: &[f64], weights: &mut Weights) -> f64 {
    let (m, n) = (phi.rows(), phi.cols());
    if m <= n {
        return weights.tolerance;
    }
    let fit = solve::least_squares(phi, y);
    let size = norm(y);
    let exact = Problem {
        dictionary: phi,
        target: y,
        tolerance: 0.0,
    };
    weights.seen_residual(&exact.left(&fit.coefficients));
    let free = (m - fit.rank.min(m - 1)) as f64;
    let noise = fit.residual * (m as f64 / free).sqrt();
    if noise > VISIBLE * size {
        weights.seen_noise(noise / (m as f64).sqrt());
    }
    (ROOM * noise).max(weights.tolerance).max(EXACT * size)
}
