//! Inverses of small matrices at many points: the order is the number of laws.
//!
//! In: n × n × points, each entry a row over all points. Out: the inverses in the same layout. Nothing is allocated per point.

use crate::trajectory::thresholds::SHOOTING;

/// Inverts at every point; false if one matrix is singular to working precision. `small` is scratch.
pub(crate) fn invert(
    a: &mut [f64],
    inverse: &mut [f64],
    n: usize,
    points: usize,
    small: &mut Vec<f64>,
) -> bool {
    match n {
        1 => single(a, inverse),
        2 => pairs(a, inverse, points),
        _ => (0..points).all(|b| one(a, inverse, n, points, b, small)),
    }
}

fn single(a: &[f64], inverse: &mut [f64]) -> bool {
    inverse.iter_mut().zip(a).for_each(|(i, a)| *i = 1.0 / a);
    inverse.iter().all(|x| x.is_finite())
}

/// By Cramer's rule.
fn pairs(a: &[f64], inverse: &mut [f64], points: usize) -> bool {
    let mut regular = true;
    for b in 0..points {
        let at = |k: usize| a[k * points + b];
        let [p, q, r, s] = [at(0), at(1), at(2), at(3)];
        let determinant = p * s - q * r;
        let largest = p.abs().max(q.abs()).max(r.abs()).max(s.abs());
        // |det| ≈ smaller pivot · largest entry.
        regular &= determinant.abs() > SHOOTING.singular_pivot * largest * largest;
        let scale = 1.0 / determinant;
        for (k, x) in [s, -q, -r, p].into_iter().enumerate() {
            inverse[k * points + b] = x * scale;
        }
    }
    regular
}

fn one(
    a: &[f64],
    inverse: &mut [f64],
    n: usize,
    points: usize,
    b: usize,
    small: &mut Vec<f64>,
) -> bool {
    small.clear();
    small.extend((0..n * n).map(|k| a[k * points + b]));
    small.resize(2 * n * n, 0.0);
    let (matrix, sides) = small.split_at_mut(n * n);
    (0..n).for_each(|i| sides[i * n + i] = 1.0);
    let regular = solve(matrix, sides, n, n);
    for (k, x) in sides.iter().enumerate() {
        inverse[k * points + b] = *x;
    }
    regular
}

/// Gaussian elimination with partial pivoting: A X = B with A n × n and B n × `sides`, both by rows. B becomes X. False if A is singular
/// to working precision; A and B then hold no result.
fn solve(a: &mut [f64], b: &mut [f64], n: usize, sides: usize) -> bool {
    let largest = a.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    for k in 0..n {
        let size = |i: usize| a[i * n + k].abs();
        let Some(pivot) = (k..n).max_by(|x, y| size(*x).total_cmp(&size(*y))) else {
            return false;
        };
        let regular = size(pivot) > SHOOTING.singular_pivot * largest;
        if !regular {
            return false;
        }
        if pivot != k {
            (0..n).for_each(|j| a.swap(pivot * n + j, k * n + j));
            (0..sides).for_each(|j| b.swap(pivot * sides + j, k * sides + j));
        }
        for i in k + 1..n {
            let factor = a[i * n + k] / a[k * n + k];
            if factor == 0.0 {
                continue;
            }
            (k..n).for_each(|j| a[i * n + j] -= factor * a[k * n + j]);
            (0..sides).for_each(|j| b[i * sides + j] -= factor * b[k * sides + j]);
        }
    }
    for k in (0..n).rev() {
        for j in 0..sides {
            let known: f64 = (k + 1..n).map(|i| a[k * n + i] * b[i * sides + j]).sum();
            b[k * sides + j] = (b[k * sides + j] - known) / a[k * n + k];
        }
    }
    true
}
