//! Small dense linear systems by Gaussian elimination with partial pivoting.
//!
//! In: a square matrix by rows, a right side. Out: the solution in place of the right side, or that there is none.
//! Never allocates.

use crate::simulate::thresholds::MASS_MATRIX;

/// Solves matrix · x = right; `right` becomes x. Rows are scaled by their largest entry first. Returns `false` where
/// the matrix is singular to twelve digits or not finite. `matrix` is n × n by rows and is overwritten.
pub(crate) fn solve(matrix: &mut [f64], right: &mut [f64]) -> bool {
    let n = right.len();
    if n == 1 {
        right[0] /= matrix[0];
        return matrix[0] != 0.0 && matrix[0].is_finite();
    }
    for (row, r) in matrix.chunks_exact_mut(n).zip(right.iter_mut()) {
        let size = row.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        if !(size > 0.0 && size.is_finite()) {
            return false;
        }
        row.iter_mut().for_each(|x| *x /= size);
        *r /= size;
    }
    if n == 2 {
        return two(matrix, right);
    }
    for k in 0..n {
        if !pivot(matrix, right, k) {
            return false;
        }
        for i in k + 1..n {
            let factor = matrix[i * n + k] / matrix[k * n + k];
            if factor != 0.0 {
                for j in k + 1..n {
                    matrix[i * n + j] -= factor * matrix[k * n + j];
                }
                right[i] -= factor * right[k];
            }
        }
    }
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| matrix[k * n + j] * right[j]).sum();
        right[k] = (right[k] - known) / matrix[k * n + k];
    }
    true
}

/// Swaps the largest entry at or below the diagonal of column `k` onto the diagonal. `false` if it is zero.
fn pivot(matrix: &mut [f64], right: &mut [f64], k: usize) -> bool {
    let n = right.len();
    let size = |i: &usize| matrix[i * n + k].abs();
    let best = (k..n)
        .max_by(|a, b| size(a).total_cmp(&size(b)))
        .unwrap_or(k);
    if size(&best).is_nan() || size(&best) <= MASS_MATRIX.pivot {
        return false;
    }
    if best != k {
        (0..n).for_each(|j| matrix.swap(k * n + j, best * n + j));
        right.swap(k, best);
    }
    true
}

/// Cramer's rule for two scaled rows.
fn two(matrix: &[f64], right: &mut [f64]) -> bool {
    let &[a, b, c, d] = matrix else { return false };
    let determinant = a * d - b * c;
    if determinant.is_nan() || determinant.abs() <= MASS_MATRIX.pivot {
        return false;
    }
    let (p, q) = (right[0], right[1]);
    right[0] = (p * d - b * q) / determinant;
    right[1] = (a * q - p * c) / determinant;
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solutions_solve_and_dependent_rows_are_seen() {
        for n in 1..6 {
            let entry = |i: usize, j: usize| f64::sin((1 + i * i + 3 * j) as f64 * (1 + j) as f64);
            let matrix: Vec<f64> = (0..n * n).map(|k| entry(k / n, k % n)).collect();
            let truth: Vec<f64> = (0..n).map(|i| 1.0 + i as f64).collect();
            let times = |i: usize| (0..n).map(|j| matrix[i * n + j] * truth[j]).sum::<f64>();
            let mut right: Vec<f64> = (0..n).map(times).collect();
            assert!(solve(&mut matrix.clone(), &mut right), "{n}");
            for (x, t) in right.iter().zip(&truth) {
                assert!((x - t).abs() < 1e-10 * t, "{n}: {right:?}");
            }
        }
        for n in 2..5 {
            // The last row is the sum of the others, but for rounding.
            let mut matrix: Vec<f64> = (0..n * n).map(|k| ((k * k) % 7) as f64 + 0.1).collect();
            for j in 0..n {
                matrix[(n - 1) * n + j] = (0..n - 1).map(|i| matrix[i * n + j]).sum();
            }
            assert!(!solve(&mut matrix, &mut vec![1.0; n]), "{n}");
        }
        assert!(!solve(&mut [0.0], &mut [1.0]));
        assert!(!solve(&mut [f64::NAN, 1.0, 1.0, 1.0], &mut [1.0, 1.0]));
    }
}
