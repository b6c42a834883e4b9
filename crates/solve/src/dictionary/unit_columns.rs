//! Columns of a dictionary brought to length one.

use nalgebra::DMatrix;

use super::operator::Dictionary;
use crate::thresholds::NUMERICAL_RANK;

/// Indices of the columns that are not all zero.
pub(crate) fn usable_columns(dictionary: &dyn Dictionary) -> Vec<usize> {
    (0..dictionary.cols())
        .filter(|&j| dictionary.norm(j) > NUMERICAL_RANK.zero_column)
        .collect()
}

/// The chosen columns, each divided by its norm: M × the number of `kept`.
pub(crate) fn unit_columns(
    dictionary: &dyn Dictionary,
    kept: &[usize],
    norms: &[f64],
) -> DMatrix<f64> {
    let mut unit = DMatrix::zeros(dictionary.rows(), kept.len());
    let mut column = vec![0.0; dictionary.rows()];
    for (k, (&j, &length)) in kept.iter().zip(norms).enumerate() {
        dictionary.column(j, &mut column);
        for (entry, value) in unit.column_mut(k).iter_mut().zip(&column) {
            *entry = value / length;
        }
    }
    unit
}
