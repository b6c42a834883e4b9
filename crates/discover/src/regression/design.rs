//! The regression problem of one equation: design matrix, target, row weights, tolerance.
//!
//! In: Φ and a target, from instants or from integrals. Out: the problem with its tolerance. Never selects terms.

use crate::regression::row_sampling::Split;
use crate::regression::thresholds::TOLERANCE;
use crate::row_weights::Weights;
use crate::statistics::norm;
use sidc_data::Samples;
use sidc_solve as solve;
use sidc_solve::Problem;
use sidc_solve::dictionary::Dictionary;

/// What the rows of the design matrix are.
pub(crate) enum RowKind {
    /// Instants; `y` is the target minus its known terms, unweighted.
    Samples {
        split: Split,
        used: Samples,
        y: Vec<f64>,
    },
    /// Whitened integrals against test functions that reach this many samples to each side.
    Integrals { rows: usize, reach: usize },
}

/// A regression problem, ready for a solver.
pub(crate) struct Design {
    pub basis: RowKind,
    pub weights: Weights,
    pub phi: Box<dyn Dictionary>,
    /// The target with weighted rows, length M.
    pub target: Vec<f64>,
    /// ε
    pub tolerance: f64,
}

impl Design {
    /// `phi` and `target` have weighted rows. The tolerance comes from the errors of the data or the residual of the whole
    /// library.
    pub fn new(
        basis: RowKind,
        mut weights: Weights,
        phi: Box<dyn Dictionary>,
        target: Vec<f64>,
    ) -> Design {
        let whitened = matches!(basis, RowKind::Integrals { .. });
        let correlation = weights.correlation;
        let (tolerance, drift) = tolerance(phi.as_ref(), &target, &mut weights);
        if whitened {
            // Whitened errors are independent; correlation left in the residual comes from missing terms.
            weights.correlation = correlation;
        } else {
            weights.add_drift(drift);
        }
        Design {
            basis,
            weights,
            phi,
            target,
            tolerance,
        }
    }

    pub fn problem(&self) -> Problem<'_> {
        Problem {
            dictionary: self.phi.as_ref(),
            target: &self.target,
            tolerance: self.tolerance,
        }
    }
}

/// ε: the estimated error of the data, or the noise that the fit of the whole library shows, if rows outnumber terms and that is
/// larger; and the variance of errors that last longer than the target.
fn tolerance(phi: &dyn Dictionary, y: &[f64], weights: &mut Weights) -> (f64, f64) {
    let (m, n) = (phi.rows(), phi.cols());
    if m <= n {
        return (weights.tolerance, 0.0);
    }
    let fit = solve::minimum_norm_least_squares(phi, y);
    let size = norm(y);
    let drift = weights.raise_correlation(&fit.rest, y);
    let free = (m - fit.rank.min(m - 1)) as f64;
    let noise = fit.residual * (m as f64 / free).sqrt();
    if noise > TOLERANCE.visible_noise * size {
        weights.lower_floor(noise / (m as f64).sqrt());
    }
    let tolerance = (TOLERANCE.room * noise)
        .max(weights.tolerance)
        .max(TOLERANCE.relative_floor * size);
    (tolerance, drift)
}
