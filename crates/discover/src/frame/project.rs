//! Columns made orthogonal one after another, and what is left of others beside them.
//!
//! In: columns of M numbers. Out: projections, the combination that is nearest to nothing. Orthogonalised twice
//! (Kahan's "twice is enough"), so that clean data keep their digits. Never sees a name.

use nalgebra::DMatrix;

use sidc_solve::simd::{axpy, dot};

/// A column of which less than this is left, relative, depends on those before it.
const DEPENDENT: f64 = 1e-13;

/// An orthonormal basis of some columns, with the triangle that made it.
#[derive(Clone, Default)]
pub struct Basis {
    directions: Vec<Vec<f64>>,
    /// Coordinates of each column given, as long as the basis was by then; `None` entries were dependent.
    triangle: Vec<Vec<f64>>,
}

impl Basis {
    /// The basis of all columns in their order.
    pub fn of<'a>(columns: impl IntoIterator<Item = &'a [f64]>) -> Basis {
        let mut basis = Basis::default();
        for column in columns {
            basis.push(column);
        }
        basis
    }

    /// Takes a column in: the length of what the others did not hold of it.
    pub fn push(&mut self, column: &[f64]) -> f64 {
        let (mut left, coordinates) = self.split(column);
        let length = norm(&left);
        let mut row = coordinates;
        row.push(length);
        self.triangle.push(row);
        if length > DEPENDENT * norm(column) {
            left.iter_mut().for_each(|x| *x /= length);
        } else {
            left.fill(0.0);
        }
        self.directions.push(left);
        length
    }

    /// What is left of a vector.
    pub fn outside(&self, vector: &[f64]) -> Vec<f64> {
        self.split(vector).0
    }

    fn split(&self, vector: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut left = vector.to_vec();
        let mut coordinates = vec![0.0; self.directions.len()];
        for _ in 0..2 {
            for (direction, sum) in self.directions.iter().zip(&mut coordinates) {
                let along = dot(direction, &left);
                *sum += along;
                axpy(-along, direction, &mut left);
            }
        }
        (left, coordinates)
    }

    /// The combination of the columns given, largest weight 1, that is nearest to nothing, and its length.
    pub fn least(&self) -> Option<(Vec<f64>, f64)> {
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
        let most = weights
            .iter()
            .copied()
            .max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        let size = svd.singular_values.get(at)? / most.abs();
        (size.is_finite()).then(|| (weights.iter().map(|w| w / most).collect(), size))
    }

    pub fn directions(&self) -> &[Vec<f64>] {
        &self.directions
    }
}

pub fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_combination_nearest_to_nothing_keeps_its_digits() {
        let x: Vec<f64> = (0..50).map(|i| f64::from(i) / 50.0).collect();
        let y: Vec<f64> = x.iter().map(|x| (7.0 * x).sin()).collect();
        let sum: Vec<f64> = x.iter().zip(&y).map(|(x, y)| 2.0 * x - y).collect();
        let (weights, size) = Basis::of([&x[..], &y[..], &sum[..]]).least().unwrap();
        assert!(size < 1e-14);
        assert!((weights[0] - 1.0).abs() < 1e-13 && (weights[2] + 0.5).abs() < 1e-13);
        let left = Basis::of([&x[..], &y[..]]).outside(&sum);
        assert!(norm(&left) < 1e-14);
    }
}
