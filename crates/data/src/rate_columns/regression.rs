//! Coefficients of a few columns from sums of products, with standard errors that allow for autocorrelation.
//!
//! In: whitened sums, a target, columns. Out: coefficients, standard errors, the likelihood. Knows no meaning of a column.

use nalgebra::{DMatrix, DVector};

use super::local_level::{Products, Whitened};
use super::thresholds::RATES;

/// A least-squares fit.
#[derive(Clone, Debug)]
pub(super) struct Regression {
    pub coefficients: Vec<f64>,
    /// The larger of the ordinary least-squares error and the sandwich error from the scatter between the parts of the
    /// record.
    pub errors: Vec<f64>,
    /// −2 log likelihood, but for a constant.
    pub deviance: f64,
}

/// `None` if the columns are dependent.
pub(super) fn regress(data: &Whitened, target: usize, columns: &[usize]) -> Option<Regression> {
    let sum = data.sum();
    let p = columns.len();
    let free = data.rows.checked_sub(p).filter(|n| *n > 0)? as f64;
    let scale: Vec<f64> = columns.iter().map(|c| sum[*c][*c].sqrt()).collect();
    if scale.iter().any(|s| !(*s > 0.0 && s.is_finite())) {
        return None;
    }
    let gram = |of: &Products| {
        DMatrix::from_fn(p, p, |i, j| {
            of[columns[i]][columns[j]] / (scale[i] * scale[j])
        })
    };
    let right = |of: &Products| DVector::from_fn(p, |i, _| of[columns[i]][target] / scale[i]);
    let whole = gram(&sum);
    let inverse = match p {
        0 => DMatrix::zeros(0, 0),
        _ => {
            let factor = whole.clone().cholesky()?;
            let independent = |i: usize| factor.l_dirty()[(i, i)].powi(2) > RATES.independent;
            if !(0..p).all(independent) {
                return None;
            }
            factor.inverse()
        }
    };
    let found = &inverse * right(&sum);
    let total = sum[target][target];
    let explained = found.dot(&right(&sum));
    let left = (total - explained)
        .max(f64::EPSILON * total)
        .max(f64::MIN_POSITIVE);
    // The scatter of the parts' scores estimates the covariance of the coefficients (sandwich formula).
    let mut meat = DMatrix::zeros(p, p);
    for part in &data.parts {
        let score = right(part) - gram(part) * &found;
        meat += &score * score.transpose();
    }
    let parts = data.parts.len() as f64;
    let sandwich = &inverse * meat * &inverse * (parts / (parts - 1.0));
    let error = |i: usize| {
        let usual = inverse[(i, i)] * left / free;
        usual.max(sandwich[(i, i)]).max(0.0).sqrt() / scale[i]
    };
    Some(Regression {
        coefficients: (0..p).map(|i| found[i] / scale[i]).collect(),
        errors: (0..p).map(error).collect(),
        deviance: data.rows as f64 * left.ln() + data.log_variance,
    })
}
