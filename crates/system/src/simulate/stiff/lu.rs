//! A square matrix as L U, real or complex, for many right sides.
//!
//! In: entries by rows. Out: solutions in place. Allocates once; a singular matrix is reported.

use std::ops::{AddAssign, Div, Mul, SubAssign};

use nalgebra::Complex;

/// A number that elimination works with.
pub(super) trait Entry:
    Copy + Default + From<f64> + AddAssign + SubAssign + Mul<Output = Self> + Div<Output = Self>
{
    /// What pivots are compared by.
    fn size(self) -> f64;
}

impl Entry for f64 {
    fn size(self) -> f64 {
        self.abs()
    }
}

impl Entry for Complex<f64> {
    fn size(self) -> f64 {
        self.re.abs() + self.im.abs()
    }
}

/// Gaussian elimination with partial pivoting (Golub, Van Loan, "Matrix Computations", 3.4), column by column: a long sum is a
/// chain of additions, each of which waits for the one before.
#[derive(Clone, Debug)]
pub(super) struct Lu<T> {
    n: usize,
    /// By columns: U, its diagonal inverted, and below it the factors of L.
    entries: Vec<T>,
    /// The row that each pivot came from.
    swaps: Vec<usize>,
}

impl<T: Entry> Lu<T> {
    pub fn new(n: usize) -> Lu<T> {
        Lu {
            n,
            entries: vec![T::default(); n * n],
            swaps: vec![0; n],
        }
    }

    /// Factorises diagonal·I − matrix; `false` if there is no inverse. `matrix` is n × n by rows.
    pub fn factorise(&mut self, diagonal: T, matrix: &[f64]) -> bool {
        let n = self.n;
        for (i, row) in matrix.chunks_exact(n.max(1)).enumerate() {
            for (j, from) in row.iter().enumerate() {
                self.entries[j * n + i] = T::from(-from);
            }
        }
        for to in self.entries.iter_mut().step_by(n + 1) {
            *to += diagonal;
        }
        (0..n).all(|k| self.eliminate(k))
    }

    /// Clears column k below its pivot.
    fn eliminate(&mut self, k: usize) -> bool {
        let n = self.n;
        let (before, after) = self.entries.split_at_mut((k + 1) * n);
        let column = &mut before[k * n..];
        let size = |i: usize| column[i].size();
        let from = (k + 1..n).fold(k, |best, i| if size(i) > size(best) { i } else { best });
        let largest = size(from);
        if !(largest > 0.0 && largest.is_finite()) {
            return false;
        }
        self.swaps[k] = from;
        column.swap(k, from);
        let inverse = T::from(1.0) / column[k];
        column[k] = inverse;
        let factors = &mut column[k + 1..];
        factors.iter_mut().for_each(|l| *l = *l * inverse);
        for other in after.chunks_exact_mut(n) {
            other.swap(k, from);
            subtract(&mut other[k..], factors);
        }
        true
    }

    /// `right` becomes the solution.
    pub fn solve(&self, right: &mut [T]) {
        let columns = || self.entries.chunks_exact(self.n.max(1)).enumerate();
        for ((k, column), from) in columns().zip(&self.swaps) {
            right.swap(k, *from);
            subtract(&mut right[k..], &column[k + 1..]);
        }
        for (k, column) in columns().rev() {
            let x = right[k] * column[k];
            right[k] = x;
            for (to, u) in right.iter_mut().zip(&column[..k]) {
                *to -= *u * x;
            }
        }
    }
}

/// The first entry times the factors off the others.
#[inline]
fn subtract<T: Entry>(entries: &mut [T], factors: &[T]) {
    let Some((first, others)) = entries.split_first_mut() else {
        return;
    };
    // Most of a large system's entries are zeros.
    if first.size() != 0.0 {
        for (to, l) in others.iter_mut().zip(factors) {
            *to -= *l * *first;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Entries from −1 to 1 in a fixed order, by the golden ratio.
    fn entries(count: usize) -> Vec<f64> {
        let part = |k: usize| (k as f64 * 0.618_033_988_749_895).fract();
        (1..=count).map(|k| 2.0 * part(k * k) - 1.0).collect()
    }

    #[test]
    fn solutions_fulfil_their_equations() {
        for n in [1, 2, 3, 8, 30] {
            let matrix = entries(n * n);
            let shift = Complex::new(0.3, -0.7);
            let right: Vec<Complex<f64>> = entries(2 * n)
                .chunks_exact(2)
                .map(|c| Complex::new(c[0], c[1]))
                .collect();
            let (mut lu, mut x) = (Lu::new(n), right.clone());
            assert!(lu.factorise(shift, &matrix));
            lu.solve(&mut x);
            let size = x.iter().map(|x| x.size()).fold(1.0, f64::max);
            for (i, right) in right.iter().enumerate() {
                let row = matrix[i * n..(i + 1) * n].iter().zip(&x);
                let left = row.fold(shift * x[i], |sum, (a, x)| sum - x * *a);
                assert!((left - right).size() < 1e-13 * n as f64 * size);
            }
        }
    }

    #[test]
    fn a_zero_pivot_is_exchanged_and_a_dependent_row_is_told() {
        let mut lu = Lu::new(2);
        let mut x = [3.0, 5.0];
        assert!(lu.factorise(0.0, &[0.0, -1.0, -2.0, 0.0]));
        lu.solve(&mut x);
        assert_eq!(x, [2.5, 3.0]);
        assert!(!lu.factorise(0.0, &[1.0, 2.0, 2.0, 4.0]));
        assert!(!lu.factorise(1.0, &[f64::NAN, 2.0, 2.0, 4.0]));
        assert!(Lu::<f64>::new(0).factorise(1.0, &[]));
    }
}
