//! Products of dense matrices and vectors, stored by columns.
//!
//! In: numbers, column after column. Out: products, in an order of summation that is fixed.

use nalgebra::{DMatrix, DMatrixViewMut, Dyn, Matrix, MatrixView, RawStorage, RealField, Storage};

use super::vectors::dot_in_lanes;
use crate::simd::wide;

/// A view of any layout, such as that of a transpose.
pub type Strided<'a, T = f64> = MatrixView<'a, T, Dyn, Dyn, Dyn, Dyn>;

/// Largest dimension that nalgebra (0.35) multiplies by loops of its own; larger products go to blocked kernels.
const UNBLOCKED: usize = 5;
/// Columns of a Gram matrix that are multiplied at once. Panels skip most of what lies above the diagonal.
const GRAM_PANEL: usize = 64;
/// Columns of a matrix-vector product that share one pass over the result.
const COLUMNS_AT_ONCE: usize = 4;
/// Aᵀ without a copy, A by columns of `rows` numbers.
pub fn transposed(a: &[f64], rows: usize, columns: usize) -> Strided<'_> {
    Strided::<f64>::from_slice_with_strides(a, columns, rows, rows.max(1), 1)
}

/// C = α A B + β C
pub fn gemm<T, A, B>(
    alpha: T,
    a: &Matrix<T, Dyn, Dyn, A>,
    b: &Matrix<T, Dyn, Dyn, B>,
    beta: T,
    mut c: DMatrixViewMut<T>,
) where
    T: RealField + Copy,
    A: Storage<T, Dyn, Dyn> + RawStorage<T, Dyn, Dyn>,
    B: Storage<T, Dyn, Dyn> + RawStorage<T, Dyn, Dyn>,
{
    if c.nrows().min(c.ncols()).min(a.ncols()) > UNBLOCKED {
        return c.gemm(alpha, a, b, beta);
    }
    // Those loops read beyond the end of a view whose rows are not contiguous.
    c.gemm(alpha, &a.clone_owned(), &b.clone_owned(), beta);
}

/// The lower triangle of C += A Aᵀ. Some entries above the diagonal are written too.
pub fn add_products<A, B>(
    c: &mut DMatrix<f64>,
    a: &Matrix<f64, Dyn, Dyn, A>,
    transpose: &Matrix<f64, Dyn, Dyn, B>,
) where
    A: Storage<f64, Dyn, Dyn> + RawStorage<f64, Dyn, Dyn>,
    B: Storage<f64, Dyn, Dyn> + RawStorage<f64, Dyn, Dyn>,
{
    let n = c.nrows();
    for first in (0..n).step_by(GRAM_PANEL) {
        let (below, width) = (n - first, GRAM_PANEL.min(n - first));
        let (left, right) = (a.rows(first, below), transpose.columns(first, width));
        gemm(
            1.0,
            &left,
            &right,
            1.0,
            c.view_mut((first, first), (below, width)),
        );
    }
}

/// `A v`
pub fn times(a: &DMatrix<f64>, v: &[f64]) -> Vec<f64> {
    gemv(a.as_slice(), a.nrows(), v)
}

/// `Aᵀ v`
pub fn times_transposed(a: &DMatrix<f64>, v: &[f64]) -> Vec<f64> {
    gemv_tr(a.as_slice(), a.nrows(), v)
}

/// `A v`, A by columns of `rows` numbers.
pub fn gemv(a: &[f64], rows: usize, v: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; rows];
    if rows > 0 {
        wide(|| add_columns(a, v, &mut out));
    }
    out
}

#[inline(always)]
fn add_columns(a: &[f64], v: &[f64], out: &mut [f64]) {
    let rows = out.len();
    let (blocks, some) = (
        a.chunks_exact(COLUMNS_AT_ONCE * rows),
        v.chunks_exact(COLUMNS_AT_ONCE),
    );
    let rest = blocks.remainder().chunks_exact(rows);
    let rest = rest.zip(some.remainder());
    for (block, v) in blocks.zip(some) {
        let [p, q, r, s] = [v[0], v[1], v[2], v[3]];
        let (a, b) = block.split_at(2 * rows);
        let (a, b) = (a.split_at(rows), b.split_at(rows));
        let entries = a.0.iter().zip(a.1).zip(b.0.iter().zip(b.1));
        for (o, ((a, b), (c, d))) in out.iter_mut().zip(entries) {
            *o += (a * p + b * q) + (c * r + d * s);
        }
    }
    for (column, v) in rest {
        out.iter_mut().zip(column).for_each(|(o, a)| *o += a * v);
    }
}

/// `Aᵀ v`, A by columns of `rows` numbers.
pub fn gemv_tr(a: &[f64], rows: usize, v: &[f64]) -> Vec<f64> {
    if rows == 0 {
        return Vec::new();
    }
    let mut out = vec![0.0; a.len() / rows];
    // A loop, because `collect` is compiled apart, without the wide instructions.
    wide(|| {
        for (o, column) in out.iter_mut().zip(a.chunks_exact(rows)) {
            *o = dot_in_lanes::<16, f64>(column, v);
        }
    });
    out
}

#[cfg(test)]
pub(in crate::linalg) mod tests {
    use super::*;

    /// Entries without a pattern.
    pub(in crate::linalg) fn matrix(rows: usize, columns: usize) -> DMatrix<f64> {
        let entry = |i: usize, j: usize| (37 * i + 101 * j + 13 * i * j) as f64;
        DMatrix::from_fn(rows, columns, |i, j| entry(i + 1, j + 1).sin())
    }

    fn vector(rows: usize) -> Vec<f64> {
        matrix(rows, 1).as_slice().to_vec()
    }

    #[test]
    fn products_of_all_shapes() {
        for (m, n) in [(1, 1), (3, 8), (8, 3), (6, 6), (40, 70), (300, 9)] {
            let a = matrix(m, n);
            let wanted = a.transpose() * &a;
            let mut c = DMatrix::zeros(n, n);
            let t = transposed(a.as_slice(), m, n);
            add_products(&mut c, &t, &a);
            assert!((c - wanted).lower_triangle().amax() < 1e-12, "{m} {n}");
            let v = vector(n);
            let image = DMatrix::from_vec(m, 1, gemv(a.as_slice(), m, &v));
            assert!((image - &a * DMatrix::from_vec(n, 1, v)).amax() < 1e-13);
            let v = vector(m);
            let image = DMatrix::from_vec(n, 1, gemv_tr(a.as_slice(), m, &v));
            assert!((image - a.transpose() * DMatrix::from_vec(m, 1, v)).amax() < 1e-13);
        }
    }
}
