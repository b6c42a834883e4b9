//! The numerical rank of a matrix: how many singular values or eigenvalues exceed a given part of the largest.
//!
//! In: a matrix. Out: a number. No value is computed. Householder reflections reduce the matrix to two diagonals, and the signs of
//! the pivots of a tridiagonal T − xI count the eigenvalues below x, a Sturm sequence (Golub & Van Loan, sections 5.4, 8.3 and 8.4).

use nalgebra::DMatrix;

use super::householder::{reflect, reflector};
use super::vectors::dot_in_lanes;
use crate::simd::{axpy, wide};
use crate::thresholds::FACTORISATION;

/// Singular values above `part` of the largest, of a matrix that is not wide.
pub fn rank(a: DMatrix<f64>, part: f64) -> usize {
    // The symmetric matrix (0 B; Bᵀ 0) of a bidiagonal B has the eigenvalues ±σ. Interleaving its rows makes it tridiagonal with a
    // diagonal of zeros (Golub–Kahan form).
    let beside = wide(|| bidiagonal(a));
    let diagonal = vec![0.0; beside.len() + 1];
    count_above(&diagonal, &beside, part)
}

/// Eigenvalues above `part` of the largest, of a symmetric matrix whose lower triangle is read.
pub fn symmetric_rank(a: DMatrix<f64>, part: f64) -> usize {
    let (diagonal, beside) = wide(|| tridiagonal(a));
    count_above(&diagonal, &beside, part)
}

/// Eigenvalues above `part` of the largest of a tridiagonal matrix; the largest is positive.
fn count_above(diagonal: &[f64], beside: &[f64], part: f64) -> usize {
    let over = |x: f64| diagonal.len() - count_below(diagonal, beside, x);
    let size = |v: &[f64]| v.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let (mut low, mut high): (f64, f64) = (0.0, size(diagonal) + 2.0 * size(beside));
    if high == 0.0 || !high.is_finite() || over(0.0) == 0 {
        return 0;
    }
    for _ in 0..FACTORISATION.bisections {
        let middle = 0.5 * (low + high);
        match over(middle) {
            0 => high = middle,
            _ => low = middle,
        }
    }
    over(part * high)
}

/// Eigenvalues below x.
fn count_below(diagonal: &[f64], beside: &[f64], x: f64) -> usize {
    let squares = std::iter::once(0.0).chain(beside.iter().map(|b| b * b));
    let mut pivot = 1.0;
    let mut count = 0;
    for (d, square) in diagonal.iter().zip(squares) {
        pivot = d - x - square / pivot;
        if pivot == 0.0 {
            pivot = f64::MIN_POSITIVE;
        }
        count += usize::from(pivot < 0.0);
    }
    count
}

/// The two diagonals of UᵀAV, interleaved.
#[inline(always)]
fn bidiagonal(mut a: DMatrix<f64>) -> Vec<f64> {
    let (m, n) = a.shape();
    let mut out = Vec::with_capacity(2 * n);
    // The reflection from the right, I − τ r rᵀ, and A r: applied when the columns are next read.
    let (mut tau, mut row, mut image) = (0.0, vec![0.0; n], vec![0.0; m]);
    for k in 0..n.min(m) {
        let (done, rest) = a.as_mut_slice().split_at_mut((k + 1) * m);
        let v = &mut done[k * m + k..];
        axpy(-tau * row[0], &image[k..], v);
        let left = reflector(v);
        out.push(v[0]);
        for (column, r) in rest.chunks_exact_mut(m).zip(&mut row[1..]) {
            axpy(-tau * *r, &image[k..], &mut column[k..]);
            reflect(v, left, &mut column[k..]);
            *r = column[k];
        }
        row.remove(0);
        tau = reflector(&mut row);
        let Some(first) = row.first_mut() else { break };
        out.push(std::mem::replace(first, 1.0));
        image[k + 1..].fill(0.0);
        for (column, r) in rest.chunks_exact(m).zip(&row) {
            axpy(*r, &column[k + 1..], &mut image[k + 1..]);
        }
    }
    out
}

/// The diagonals of QᵀAQ.
#[inline(always)]
fn tridiagonal(mut a: DMatrix<f64>) -> (Vec<f64>, Vec<f64>) {
    let n = a.nrows();
    let (mut diagonal, mut beside) = (Vec::with_capacity(n), Vec::with_capacity(n));
    // The pending rank-two update: A − v wᵀ − w vᵀ.
    let (mut v, mut w) = (vec![0.0; n], vec![0.0; n]);
    let (mut next, mut image) = (vec![0.0; n], vec![0.0; n]);
    for k in 0..n {
        let (done, rest) = a.as_mut_slice().split_at_mut((k + 1) * n);
        let column = &mut done[k * n + k..];
        rank_two_update(column, &v[k..], &w[k..]);
        diagonal.push(column[0]);
        let tau = reflector(&mut column[1..]);
        let Some(first) = column.get_mut(1) else {
            break;
        };
        beside.push(std::mem::replace(first, 1.0));
        next[k + 1..].copy_from_slice(&column[1..]);
        image[k + 1..].fill(0.0);
        for (j, column) in (k + 1..n).zip(rest.chunks_exact_mut(n)) {
            let column = &mut column[j..];
            rank_two_update(column, &v[j..], &w[j..]);
            axpy(next[j], column, &mut image[j..]);
            image[j] += dot_in_lanes::<16, f64>(&column[1..], &next[j + 1..]);
        }
        let half = 0.5 * tau * dot_in_lanes::<16, f64>(&image[k + 1..], &next[k + 1..]);
        for i in k + 1..n {
            v[i] = next[i];
            w[i] = tau * (image[i] - half * next[i]);
        }
    }
    (diagonal, beside)
}

/// The rank-two update of a column from its diagonal on, less v wᵀ + w vᵀ.
#[inline(always)]
fn rank_two_update(column: &mut [f64], v: &[f64], w: &[f64]) {
    let (p, q) = (w[0], v[0]);
    for ((c, v), w) in column.iter_mut().zip(v).zip(w) {
        *c -= p * v + q * w;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::products::tests::matrix;

    /// Columns without a pattern; each a tenth of the one before; every third one twice.
    #[test]
    fn ranks_count_values() {
        for (m, n) in [(1, 1), (5, 3), (40, 40), (47, 40)] {
            for kind in 0..3 {
                let mut a = matrix(m, n);
                for j in 1..n {
                    match kind {
                        1 => a.column_mut(j).scale_mut(0.1_f64.powi(j as i32)),
                        2 if j % 3 == 0 => a.set_column(j, &a.column(j - 1).into_owned()),
                        _ => {}
                    }
                }
                for part in [1e-10, 1e-3, 0.3] {
                    let count = |values: &[f64]| {
                        let most = values.iter().copied().fold(0.0, f64::max);
                        values.iter().filter(|v| **v > part * most).count()
                    };
                    let values = a.singular_values();
                    assert_eq!(rank(a.clone(), part), count(values.as_slice()));
                    let gram = a.tr_mul(&a);
                    let values = gram.symmetric_eigenvalues();
                    assert_eq!(symmetric_rank(gram, part), count(values.as_slice()));
                }
            }
        }
        assert_eq!(rank(DMatrix::zeros(3, 2), 0.1), 0);
        assert_eq!(rank(DMatrix::zeros(0, 0), 0.1), 0);
        assert_eq!(symmetric_rank(DMatrix::zeros(0, 0), 0.1), 0);
    }
}
