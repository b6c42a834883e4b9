//! How many singular values or eigenvalues of a matrix count as not zero: those above a part of the largest.
//!
//! In: a matrix. Out: a number. None of the values is worked out: Householder reflections leave two diagonals, and the signs of the
//! pivots of a tridiagonal matrix minus x count its eigenvalues below x (Golub & Van Loan, sections 5.4, 8.3 and 8.4).

use nalgebra::DMatrix;

use super::dot;
use super::householder::{reflect, reflector};
use crate::lanes::{axpy, wide};

/// Halvings of the interval around the largest value: it need not be known better than the part of it.
const HALVINGS: usize = 40;

/// Singular values above `part` of the largest, of a matrix that is not wide.
pub fn rank(a: DMatrix<f64>, part: f64) -> usize {
    // The symmetric matrix of a bidiagonal one and its transpose, in the order that makes it tridiagonal, has each value twice,
    // with both signs, and a diagonal of zeros.
    let beside = wide(|| bidiagonal(a));
    let diagonal = vec![0.0; beside.len() + 1];
    above(&diagonal, &beside, part)
}

/// Eigenvalues above `part` of the largest, of a symmetric matrix whose lower triangle is read.
pub fn symmetric_rank(a: DMatrix<f64>, part: f64) -> usize {
    let (diagonal, beside) = wide(|| tridiagonal(a));
    above(&diagonal, &beside, part)
}

/// Eigenvalues above `part` of the largest of a tridiagonal matrix; the largest is positive.
fn above(diagonal: &[f64], beside: &[f64], part: f64) -> usize {
    let over = |x: f64| diagonal.len() - below(diagonal, beside, x);
    let size = |v: &[f64]| v.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let (mut low, mut high): (f64, f64) = (0.0, size(diagonal) + 2.0 * size(beside));
    if high == 0.0 || !high.is_finite() || over(0.0) == 0 {
        return 0;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        match over(middle) {
            0 => high = middle,
            _ => low = middle,
        }
    }
    over(part * high)
}

/// Eigenvalues below x.
fn below(diagonal: &[f64], beside: &[f64], x: f64) -> usize {
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

/// The two diagonals of UᵀAV, one number of each in turn.
#[inline(always)]
fn bidiagonal(mut a: DMatrix<f64>) -> Vec<f64> {
    let (m, n) = a.shape();
    let mut out = Vec::with_capacity(2 * n);
    // The reflection from the right, I − τ r rᵀ, and A r: taken off when the columns are next at hand.
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
    // What is to be taken off: v wᵀ + w vᵀ.
    let (mut v, mut w) = (vec![0.0; n], vec![0.0; n]);
    let (mut next, mut image) = (vec![0.0; n], vec![0.0; n]);
    for k in 0..n {
        let (done, rest) = a.as_mut_slice().split_at_mut((k + 1) * n);
        let column = &mut done[k * n + k..];
        take_off(column, &v[k..], &w[k..]);
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
            take_off(column, &v[j..], &w[j..]);
            axpy(next[j], column, &mut image[j..]);
            image[j] += dot(&column[1..], &next[j + 1..]);
        }
        let half = 0.5 * tau * dot(&image[k + 1..], &next[k + 1..]);
        for i in k + 1..n {
            v[i] = next[i];
            w[i] = tau * (image[i] - half * next[i]);
        }
    }
    (diagonal, beside)
}

/// The part of v wᵀ + w vᵀ that a column, from its diagonal on, loses.
#[inline(always)]
fn take_off(column: &mut [f64], v: &[f64], w: &[f64]) {
    let (p, q) = (w[0], v[0]);
    for ((c, v), w) in column.iter_mut().zip(v).zip(w) {
        *c -= p * v + q * w;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::tests::matrix;

    /// Random columns; the same, each a tenth of the one before; the same, every third one twice.
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
