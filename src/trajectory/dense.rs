//! Small dense systems, in place and without allocation: as many unknowns as a model has laws.

/// Solves A X = B by elimination with row pivoting; A is n × n, B n × `sides`, both by rows. B becomes X. False if A is singular
/// to working precision; both are then spoilt.
pub(super) fn solve(a: &mut [f64], b: &mut [f64], n: usize, sides: usize) -> bool {
    for k in 0..n {
        let size = |i: usize| a[i * n + k].abs();
        let Some(pivot) = (k..n).max_by(|x, y| size(*x).total_cmp(&size(*y))) else {
            return false;
        };
        let largest = a.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let regular = size(pivot) > SINGULAR * largest;
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

/// A pivot below this part of the largest entry is none.
const SINGULAR: f64 = 1e-10;

/// C = A B for n × n matrices by rows.
pub(super) fn multiply(a: &[f64], b: &[f64], c: &mut [f64], n: usize) {
    c.fill(0.0);
    for i in 0..n {
        for k in 0..n {
            let x = a[i * n + k];
            if x != 0.0 {
                (0..n).for_each(|j| c[i * n + j] += x * b[k * n + j]);
            }
        }
    }
}
