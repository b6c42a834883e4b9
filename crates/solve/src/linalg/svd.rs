//! The singular value decomposition, by one-sided Jacobi rotations where others are not reliable (Hestenes 1958; Demmel & Veselić
//! 1992): slow, and accurate for matrices of low rank.

use nalgebra::{DMatrix, SVD};

use super::qr::Qr;
use super::vectors::dot_in_lanes;
use crate::thresholds::FACTORISATION;

/// A = U Σ Vᵀ of an M × N matrix, k = min(M, N): U is M × k, Vᵀ k × N. Columns of U that belong to a value of zero are zero.
pub struct Svd {
    pub u: DMatrix<f64>,
    /// Descending, length k.
    pub values: Vec<f64>,
    pub v_t: DMatrix<f64>,
}

/// Largest over smallest singular value; infinite when the columns outnumber the rows or are dependent.
pub fn condition_number(unit: &DMatrix<f64>) -> f64 {
    if unit.ncols() == 0 {
        return 1.0;
    }
    if unit.ncols() > unit.nrows() {
        return f64::INFINITY;
    }
    let Some(svd) = svd(Qr::new(unit.clone()).r) else {
        return f64::INFINITY;
    };
    match (svd.values.first(), svd.values.last()) {
        (Some(most), Some(least)) if *least > 0.0 => most / least,
        _ => f64::INFINITY,
    }
}

/// The decomposition of finite numbers; `None` for others.
///
/// nalgebra (0.35) returns wrong singular vectors for some matrices of low rank. So its decompositions of large matrices are
/// checked, and small matrices are not given to it.
pub fn svd(a: DMatrix<f64>) -> Option<Svd> {
    if a.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let (m, n) = a.shape();
    if m.max(n) > FACTORISATION.jacobi_dimension
        && let Some(svd) = SVD::try_new(
            a.clone(),
            true,
            true,
            f64::EPSILON,
            FACTORISATION.qr_steps * m.max(n),
        )
        && let (Some(u), Some(v_t)) = (svd.u, svd.v_t)
    {
        let values: Vec<f64> = svd.singular_values.iter().copied().collect();
        let svd = Svd { u, values, v_t };
        if svd.reconstructs(&a) {
            return Some(svd);
        }
    }
    jacobi_svd(a)
}

impl Svd {
    fn reconstructs(&self, a: &DMatrix<f64>) -> bool {
        let values = DMatrix::from_diagonal(&self.values.clone().into());
        let left = &self.u * values * &self.v_t - a;
        let k = self.values.len();
        let identity = DMatrix::<f64>::identity(k, k);
        let across = self.u.tr_mul(&self.u) - &identity;
        let along = &self.v_t * self.v_t.transpose() - identity;
        left.norm() <= FACTORISATION.reconstruction_error * a.norm()
            && across.norm().max(along.norm()) <= FACTORISATION.reconstruction_error * k as f64
    }
}

/// The decomposition by rotations alone.
fn jacobi_svd(a: DMatrix<f64>) -> Option<Svd> {
    if a.iter().any(|x| !x.is_finite()) {
        return None;
    }
    if a.ncols() > a.nrows() {
        let Svd { u, values, v_t } = jacobi_svd(a.transpose())?;
        let (u, v_t) = (v_t.transpose(), u.transpose());
        return Some(Svd { u, values, v_t });
    }
    let (m, n) = a.shape();
    // Powers of two, so that squares neither overflow nor vanish and no digit changes.
    let unit = match a.amax() {
        0.0 => 1.0,
        largest => largest.log2().floor().clamp(-1000.0, 1000.0).exp2(),
    };
    let mut w = a / unit;
    let mut v = DMatrix::identity(n, n);
    for _ in 0..FACTORISATION.max_sweeps {
        let mut rotated = false;
        for p in 0..n {
            for q in p + 1..n {
                rotated |= orthogonalise(&mut w, &mut v, p, q);
            }
        }
        if !rotated {
            break;
        }
    }
    let lengths: Vec<f64> = (0..n).map(|j| w.column(j).norm()).collect();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|i, j| lengths[*j].total_cmp(&lengths[*i]));
    let values = order.iter().map(|j| lengths[*j] * unit).collect();
    let left = |i: usize, k: usize| match lengths[order[k]] {
        0.0 => 0.0,
        length => w[(i, order[k])] / length,
    };
    Some(Svd {
        u: DMatrix::from_fn(m, n, left),
        values,
        v_t: DMatrix::from_fn(n, n, |k, j| v[(j, order[k])]),
    })
}

/// Rotates two columns so that they are orthogonal; false if they already were, to rounding.
fn orthogonalise(w: &mut DMatrix<f64>, v: &mut DMatrix<f64>, p: usize, q: usize) -> bool {
    let m = w.nrows();
    let column = |j: usize| &w.as_slice()[j * m..(j + 1) * m];
    let (x, y) = (column(p), column(q));
    let (xx, yy, xy) = (
        dot_in_lanes::<16, f64>(x, x),
        dot_in_lanes::<16, f64>(y, y),
        dot_in_lanes::<16, f64>(x, y),
    );
    let bound = f64::EPSILON * (xx * yy).sqrt();
    if xy == 0.0 || xy.abs() <= bound {
        return false;
    }
    let zeta = (yy - xx) / (2.0 * xy);
    let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
    let cosine = 1.0 / tangent.hypot(1.0);
    for matrix in [w, v] {
        rotate(matrix, (p, q), cosine, cosine * tangent);
    }
    true
}

/// (x, y) ← (c x − s y, s x + c y) for two columns.
fn rotate(matrix: &mut DMatrix<f64>, (p, q): (usize, usize), cosine: f64, sine: f64) {
    let m = matrix.nrows();
    let (before, from) = matrix.as_mut_slice().split_at_mut(q * m);
    let columns = before[p * m..(p + 1) * m].iter_mut().zip(&mut from[..m]);
    for (x, y) in columns {
        (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sidc_random::Numbers;

    /// Products of random factors: rank r of m × n, columns over some decades.
    #[test]
    fn products_are_restored_and_their_rank_is_seen() {
        let mut numbers = Numbers(3);
        for (m, n, rank) in [
            (1, 1, 1),
            (12, 11, 1),
            (11, 12, 1),
            (20, 20, 7),
            (30, 9, 9),
            (9, 30, 4),
        ] {
            let left = DMatrix::from_vec(m, rank, numbers.many(m * rank));
            let mut right = DMatrix::from_vec(rank, n, numbers.many(rank * n));
            for (j, mut column) in right.column_iter_mut().enumerate() {
                column *= 10f64.powi(j as i32 % 5 - 2);
            }
            let a = left * right;
            let Svd { u, values, v_t } = jacobi_svd(a.clone()).unwrap();
            let size = a.norm();
            let again = &u * DMatrix::from_diagonal(&values.clone().into()) * &v_t;
            assert!((again - &a).norm() < 1e-14 * size, "{m} x {n}");
            let seen = values.iter().filter(|s| **s > 1e-13 * values[0]).count();
            assert_eq!(seen, rank, "{m} x {n}: {values:?}");
            let across = u.columns(0, rank).tr_mul(&u.columns(0, rank));
            let identity = DMatrix::identity(rank, rank);
            assert!((across - identity).norm() < 1e-13, "{m} x {n}");
        }
        let zero = jacobi_svd(DMatrix::zeros(3, 2)).unwrap();
        assert_eq!(zero.values, [0.0, 0.0]);
        assert!(jacobi_svd(DMatrix::from_element(2, 2, f64::NAN)).is_none());
    }

    #[test]
    fn conditions_are_ratios_of_singular_values() {
        let diagonal = DMatrix::from_fn(4, 3, |i, j| match i == j {
            true => [2.0, 0.5, 1.0][i],
            false => 0.0,
        });
        assert!((condition_number(&diagonal) - 4.0).abs() < 1e-14);
        assert_eq!(condition_number(&diagonal.transpose()), f64::INFINITY);
        assert_eq!(condition_number(&DMatrix::zeros(3, 0)), 1.0);
        assert_eq!(condition_number(&DMatrix::zeros(3, 2)), f64::INFINITY);
    }
}
