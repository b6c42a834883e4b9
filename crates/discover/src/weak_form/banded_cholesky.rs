//! The Cholesky factorisation of symmetric banded matrices.
//!
//! In: the lower band, row by row. Out: the factor, solutions, and the trace of the inverse. Knows no signals.

use super::thresholds::WEAK_FORM;

/// A symmetric matrix of order n with `band` diagonals below the main one.
#[derive(Clone, Debug)]
pub(super) struct Banded {
    n: usize,
    band: usize,
    /// Row i holds A_{i,i}, A_{i,i−1}, …, `band` + 1 of them; those before the first column are zero.
    values: Vec<f64>,
}

impl Banded {
    pub fn zero(n: usize, band: usize) -> Banded {
        Banded {
            n,
            band,
            values: vec![0.0; n * (band + 1)],
        }
    }

    /// Adds to A_{i,j}, i ≥ j; entries beyond the band are ignored.
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        let apart = i.wrapping_sub(j);
        if i < self.n && apart <= self.band {
            self.values[i * (self.band + 1) + apart] += value;
        }
    }

    fn at(&self, i: usize, apart: usize) -> f64 {
        self.values[i * (self.band + 1) + apart]
    }

    /// A = L Lᵀ; `None` if A is not positive definite within rounding.
    pub fn cholesky(mut self) -> Option<BandedCholesky> {
        let width = self.band + 1;
        for i in 0..self.n {
            for j in i.saturating_sub(self.band)..=i {
                let from = i.saturating_sub(self.band).max(j.saturating_sub(self.band));
                let mut sum = self.at(i, i - j);
                for k in from..j {
                    sum -= self.at(i, i - k) * self.at(j, j - k);
                }
                let value = if i == j {
                    if !(sum > WEAK_FORM.smallest_pivot * self.at(i, 0) && sum.is_finite()) {
                        return None;
                    }
                    sum.sqrt()
                } else {
                    sum / self.at(j, 0)
                };
                self.values[i * width + (i - j)] = value;
            }
        }
        Some(BandedCholesky(self))
    }
}

/// L of A = L Lᵀ.
#[derive(Clone, Debug)]
pub(super) struct BandedCholesky(Banded);

impl BandedCholesky {
    /// x ← L⁻¹ x.
    pub fn whiten(&self, x: &mut [f64]) {
        let a = &self.0;
        let width = a.band + 1;
        for i in 0..a.n {
            let row = &a.values[i * width..(i + 1) * width];
            let reach = a.band.min(i);
            let mut sum = x[i];
            for apart in 1..=reach {
                sum -= row[apart] * x[i - apart];
            }
            x[i] = sum / row[0];
        }
    }

    /// x ← A⁻¹ x.
    pub fn solve(&self, x: &mut [f64]) {
        self.whiten(x);
        let a = &self.0;
        for i in (0..a.n).rev() {
            x[i] /= a.at(i, 0);
            let value = x[i];
            for apart in 1..=a.band.min(i) {
                x[i - apart] -= a.at(i, apart) * value;
            }
        }
    }

    /// ln det A.
    pub fn log_det(&self) -> f64 {
        (0..self.0.n).map(|i| 2.0 * self.0.at(i, 0).ln()).sum()
    }

    /// tr A⁻¹, from the band of the inverse alone (Takahashi, Fagan & Chin 1973).
    pub fn trace_of_inverse(&self) -> f64 {
        let (n, band) = (self.0.n, self.0.band);
        let width = band + 1;
        // Row i of the inverse from its diagonal to the right.
        let mut inverse = vec![0.0; n * width];
        let of = |inverse: &[f64], i: usize, j: usize| {
            let (low, high) = (i.min(j), i.max(j));
            inverse[low * width + (high - low)]
        };
        for i in (0..n).rev() {
            let pivot = self.0.at(i, 0);
            let last = (i + band).min(n - 1);
            for j in (i..=last).rev() {
                let mut sum = if i == j { 1.0 / pivot } else { 0.0 };
                for k in i + 1..=last {
                    sum -= self.0.at(k, k - i) * of(&inverse, k, j);
                }
                inverse[i * width + (j - i)] = sum / pivot;
            }
        }
        (0..n).map(|i| inverse[i * width]).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The second-difference matrix, whose inverse is min(i, j)(n + 1 − max(i, j))/(n + 1), counted from 1.
    fn second_differences(n: usize) -> Banded {
        let mut a = Banded::zero(n, 2);
        for i in 0..n {
            a.add(i, i, 2.0);
            if i > 0 {
                a.add(i, i - 1, -1.0);
            }
        }
        a
    }

    #[test]
    fn solutions_determinant_and_trace_of_the_second_differences() {
        let n = 9;
        let factor = second_differences(n).cholesky().unwrap();
        assert!((factor.log_det() - (n as f64 + 1.0).ln()).abs() < 1e-12);
        let mut x = vec![0.0; n];
        x[3] = 1.0;
        factor.solve(&mut x);
        for (i, x) in (1..).zip(&x) {
            let wanted = f64::from(i.min(4) * (10 - i.max(4))) / 10.0;
            assert!((x - wanted).abs() < 1e-13);
        }
        let trace: f64 = (1..=9).map(|i| f64::from(i * (10 - i)) / 10.0).sum();
        assert!((factor.trace_of_inverse() - trace).abs() < 1e-12);
    }

    #[test]
    fn singular_matrices_have_no_factor() {
        let mut a = Banded::zero(2, 1);
        a.add(0, 0, 1.0);
        a.add(1, 0, 1.0);
        a.add(1, 1, 1.0);
        assert!(a.cholesky().is_none());
    }
}
