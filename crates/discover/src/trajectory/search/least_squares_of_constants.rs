//! Constants that make the squares of some residuals least.
//!
//! In: constants with values and ranges, residuals as a function of the values. Out: the constants at the least sum that was reached.

use nalgebra::{DMatrix, DVector};

use super::unknown_constants::SoughtConstant;
use crate::trajectory::thresholds::CONSTANTS;
use sidc_system::least_squares::{
    Descent, LeastSquares, difference_equations, levenberg_marquardt,
};

/// Residuals at values of the constants, in their order; `None` where they cannot be computed.
type Residuals<'a> = &'a dyn Fn(&[f64]) -> Option<Vec<f64>>;

/// The constants at the least squares, within their ranges. `None` where nothing can be computed at their present values.
pub(super) fn least_squares_of_constants(
    constants: &[SoughtConstant],
    residuals: Residuals,
) -> Option<Vec<SoughtConstant>> {
    let start = constants.iter().map(|c| c.value);
    let start = DVector::from_iterator(constants.len(), start);
    let descent = Descent {
        steps: CONSTANTS.steps,
        converged: 0.0,
        still: 0.0,
    };
    let mut squares = Squares {
        constants,
        residuals,
    };
    let found = levenberg_marquardt(&mut squares, start, descent)?.point;
    Some(with_values(constants, found.as_slice()))
}

/// The constants with these values.
pub(super) fn with_values(constants: &[SoughtConstant], values: &[f64]) -> Vec<SoughtConstant> {
    let all = constants.iter().zip(values);
    all.map(|(c, value)| SoughtConstant {
        value: *value,
        ..*c
    })
    .collect()
}

struct Squares<'a> {
    constants: &'a [SoughtConstant],
    residuals: Residuals<'a>,
}

impl LeastSquares for Squares<'_> {
    type Point = DVector<f64>;
    type Fit = DVector<f64>;

    fn fit(&mut self, at: &DVector<f64>) -> Option<DVector<f64>> {
        (self.residuals)(at.as_slice()).map(DVector::from_vec)
    }

    fn value(&self, left: &DVector<f64>) -> f64 {
        left.norm_squared()
    }

    fn normal_equations(
        &mut self,
        at: &DVector<f64>,
        left: &DVector<f64>,
    ) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let by = f64::EPSILON.sqrt() * at.amax().max(f64::MIN_POSITIVE);
        difference_equations(self, at, left, (self.constants.len(), by), |left| left)
    }

    fn moved(&self, at: &DVector<f64>, step: &DVector<f64>) -> DVector<f64> {
        let all = self.constants.iter().zip(at.iter().zip(step.iter()));
        let moved = all.map(|(c, (value, by))| (value + by).clamp(c.range.0, c.range.1));
        DVector::from_iterator(at.len(), moved)
    }
}
