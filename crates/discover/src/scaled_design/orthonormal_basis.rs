//! Gram–Schmidt orthogonalisation, column by column.
//!
//! In: columns of M numbers. Out: residuals of projections, and the combination of the columns that is nearest to zero. Every
//! column is orthogonalised twice (Kahan's "twice is enough"), so that clean data keep their digits. Never sees a name.

use nalgebra::DMatrix;

use super::thresholds::SCALED_DESIGN;
use crate::statistics::norm;
use sidc_solve::simd::{axpy, dot};

/// An orthonormal basis of some columns: the factors Q and R of their matrix.
#[derive(Clone, Default)]
pub struct OrthonormalBasis {
    /// Columns of Q; zero where a column depends on those before it.
    directions: Vec<Vec<f64>>,
    /// Columns of R, from the first entry to the diagonal.
    triangle: Vec<Vec<f64>>,
}

impl OrthonormalBasis {
    /// The basis of all columns in their order.
    pub fn of<'a>(columns: impl IntoIterator<Item = &'a [f64]>) -> OrthonormalBasis {
        let mut basis = OrthonormalBasis::default();
        for column in columns {
            basis.push(column);
        }
        basis
    }

    /// Adds a column, and returns the length of its residual on the columns before.
    pub fn push(&mut self, column: &[f64]) -> f64 {
        let (mut residual, coordinates) = self.project(column);
        let length = norm(&residual);
        let mut row = coordinates;
        row.push(length);
        self.triangle.push(row);
        if length > SCALED_DESIGN.independence * norm(column) {
            residual.iter_mut().for_each(|x| *x /= length);
        } else {
            residual.fill(0.0);
        }
        self.directions.push(residual);
        length
    }

    /// The part of a vector that is orthogonal to all columns.
    pub fn residual(&self, vector: &[f64]) -> Vec<f64> {
        self.project(vector).0
    }

    /// Residual and coordinates.
    fn project(&self, vector: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut residual = vector.to_vec();
        let mut coordinates = vec![0.0; self.directions.len()];
        for _ in 0..2 {
            for (direction, sum) in self.directions.iter().zip(&mut coordinates) {
                let along = dot(direction, &residual);
                *sum += along;
                axpy(-along, direction, &mut residual);
            }
        }
        (residual, coordinates)
    }

    /// The combination of the columns that is nearest to zero, and its length: the right singular vector of the smallest singular
    /// value, scaled so that the largest weight is 1.
    pub fn near_dependency(&self) -> Option<(Vec<f64>, f64)> {
        let n = self.triangle.len();
        let entry = |i: usize, j: usize| {
            let row = self.triangle.get(j)?;
            row.get(i).copied()
        };
        let r = DMatrix::from_fn(n, n, |i, j| entry(i, j).unwrap_or(0.0));
        if n == 0 || r.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let svd = r.svd(false, true);
        let at = svd.singular_values.imin();
        let weights: Vec<f64> = svd.v_t?.row(at).iter().copied().collect();
        let largest = weights
            .iter()
            .copied()
            .max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        let size = svd.singular_values.get(at)? / largest.abs();
        (size.is_finite()).then(|| (weights.iter().map(|w| w / largest).collect(), size))
    }

    pub fn directions(&self) -> &[Vec<f64>] {
        &self.directions
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_near_dependency_keeps_its_digits() {
        let x: Vec<f64> = (0..50).map(|i| f64::from(i) / 50.0).collect();
        let y: Vec<f64> = x.iter().map(|x| (7.0 * x).sin()).collect();
        let sum: Vec<f64> = x.iter().zip(&y).map(|(x, y)| 2.0 * x - y).collect();
        let (weights, size) = OrthonormalBasis::of([&x[..], &y[..], &sum[..]])
            .near_dependency()
            .unwrap();
        assert!(size < 1e-14);
        assert!((weights[0] - 1.0).abs() < 1e-13 && (weights[2] + 0.5).abs() < 1e-13);
        let left = OrthonormalBasis::of([&x[..], &y[..]]).residual(&sum);
        assert!(norm(&left) < 1e-14);
    }
}
