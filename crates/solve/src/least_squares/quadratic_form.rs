//! χ² as a quadratic form in all coefficients: the least squares of any support without another look at the rows.
//!
//! In: the products of all columns. Out: least residuals of supports, and supports by backward elimination and by steepest descent
//! over single changes. Columns are scaled to length one, so that pivots show how dependent they are.

use crate::simd::{axpy, dot, wide};
use crate::thresholds::QUADRATIC_FORM;

/// χ²(a) = total − 2 cᵀa + aᵀR a, on unit columns.
pub struct QuadraticForm {
    /// Number of columns.
    pub p: usize,
    /// R by rows, unit diagonal.
    pub gram: Vec<f64>,
    /// c
    pub right: Vec<f64>,
    pub total: f64,
    /// Norms of the columns.
    pub norms: Vec<f64>,
}

/// The least squares of a support.
pub struct SupportFit {
    /// For columns that are not scaled, in the order of the support.
    pub coefficients: Vec<f64>,
    /// χ²
    pub square: f64,
}

/// The normal equations of a support, solved on unit columns.
pub(super) struct SupportSolution {
    /// (R_SS)⁻¹ by rows.
    pub inverse: Vec<f64>,
    pub x: Vec<f64>,
    /// χ²
    pub square: f64,
}

impl QuadraticForm {
    /// From the products of p columns, and of the right side as the last, by rows.
    pub fn new(all: &[f64], p: usize) -> QuadraticForm {
        let w = p + 1;
        let norms: Vec<f64> = (0..p)
            .map(|j| all[j * w + j].max(f64::MIN_POSITIVE).sqrt())
            .collect();
        let entry = |i: usize, j: usize| all[i * w + j] / (norms[i] * norms[j]);
        QuadraticForm {
            p,
            gram: (0..p * p).map(|k| entry(k / p, k % p)).collect(),
            right: (0..p).map(|i| all[i * w + p] / norms[i]).collect(),
            total: all[p * w + p],
            norms,
        }
    }

    /// The form of some of the columns.
    pub fn of_columns(&self, columns: &[usize]) -> QuadraticForm {
        let pairs = columns
            .iter()
            .flat_map(|i| columns.iter().map(move |j| (*i, *j)));
        QuadraticForm {
            p: columns.len(),
            gram: pairs.map(|(i, j)| self.row(i)[j]).collect(),
            right: columns.iter().map(|j| self.right[*j]).collect(),
            total: self.total,
            norms: columns.iter().map(|j| self.norms[*j]).collect(),
        }
    }

    pub fn row(&self, i: usize) -> &[f64] {
        &self.gram[i * self.p..(i + 1) * self.p]
    }

    /// Least squares on a support.
    pub fn least_squares(&self, support: &[usize]) -> SupportFit {
        let Some(solution) = self.solve(support) else {
            return SupportFit {
                coefficients: vec![0.0; support.len()],
                square: self.total,
            };
        };
        let unit = support.iter().zip(&solution.x);
        SupportFit {
            coefficients: unit.map(|(j, x)| x / self.norms[*j]).collect(),
            square: solution.square,
        }
    }

    /// The normal equations of a support; `None` if they are singular beyond the ridge.
    pub(super) fn solve(&self, support: &[usize]) -> Option<SupportSolution> {
        let inverse = self.inverse(support)?;
        let x = self.times_right(&inverse, support);
        let gains = support.iter().zip(&x).map(|(j, x)| self.right[*j] * x);
        let square = self.total - gains.sum::<f64>();
        Some(SupportSolution { inverse, x, square })
    }

    /// (R_SS)⁻¹ c_S
    fn times_right(&self, inverse: &[f64], support: &[usize]) -> Vec<f64> {
        let k = support.len();
        (0..k)
            .map(|i| {
                let row = inverse[i * k..(i + 1) * k].iter();
                row.zip(support).map(|(x, j)| x * self.right[*j]).sum()
            })
            .collect()
    }

    /// The correlations of the errors that the coefficients of a support have, by rows; `None` if they cannot be told apart.
    pub fn error_correlations(&self, support: &[usize]) -> Option<Vec<f64>> {
        let inverse = self.inverse(support)?;
        let k = support.len();
        let size = |i: usize| inverse[i * k + i].sqrt();
        let entry = |i: usize, j: usize| inverse[i * k + j] / (size(i) * size(j));
        let all: Vec<f64> = (0..k * k)
            .map(|at| entry(at / k, at % k).clamp(-1.0, 1.0))
            .collect();
        all.iter().all(|r| r.is_finite()).then_some(all)
    }

    /// (R_SS)⁻¹ by rows; `None` if it is singular beyond the ridge.
    fn inverse(&self, support: &[usize]) -> Option<Vec<f64>> {
        let k = support.len();
        let mut a = vec![0.0; k * k];
        for (i, r) in support.iter().enumerate() {
            for (j, c) in support.iter().enumerate() {
                a[i * k + j] =
                    self.gram[r * self.p + c] + if i == j { QUADRATIC_FORM.ridge } else { 0.0 };
            }
        }
        invert(&mut a, k).then_some(a)
    }

    /// Backward elimination from all columns: for each penalty the best support on the way.
    ///
    /// Where columns outnumber the rank of the data, the ridge decides which one leaves first.
    pub fn backward_elimination(&self, penalties: &[f64]) -> Vec<Vec<usize>> {
        let p = self.p;
        let mut a = self.gram.clone();
        (0..p).for_each(|j| a[j * p + j] += 10.0 * QUADRATIC_FORM.ridge);
        if !invert(&mut a, p) {
            return Vec::new();
        }
        let mut x: Vec<f64> = (0..p)
            .map(|i| dot(&a[i * p..(i + 1) * p], &self.right))
            .collect();
        let mut square = self.total - dot(&self.right, &x);
        let mut active: Vec<usize> = (0..p).collect();
        let mut best: Vec<(f64, Vec<usize>)> = vec![(f64::INFINITY, Vec::new()); penalties.len()];
        while !active.is_empty() {
            for (best, penalty) in best.iter_mut().zip(penalties) {
                let value = square + penalty * active.len() as f64;
                if value < best.0 {
                    *best = (value, active.clone());
                }
            }
            let cost = |j: &usize| x[*j] * x[*j] / a[j * p + j].max(f64::MIN_POSITIVE);
            let Some(at) =
                (0..active.len()).min_by(|i, j| cost(&active[*i]).total_cmp(&cost(&active[*j])))
            else {
                break;
            };
            let j = active[at];
            square += cost(&j);
            let (pivot, xj) = (a[j * p + j], x[j]);
            let column: Vec<f64> = (0..p).map(|i| a[i * p + j]).collect();
            active.remove(at);
            for i in &active {
                x[*i] -= column[*i] * (xj / pivot);
                let factor = column[*i] / pivot;
                for k in &active {
                    a[i * p + k] -= factor * column[*k];
                }
            }
        }
        best.into_iter().map(|(_, s)| s).collect()
    }
}

/// Symmetric positive definite inverse in place, by Gauss–Jordan without pivoting.
fn invert(a: &mut [f64], n: usize) -> bool {
    wide(|| gauss_jordan(a, n))
}

#[inline(always)]
fn gauss_jordan(a: &mut [f64], n: usize) -> bool {
    for k in 0..n {
        let pivot = a[k * n + k];
        if pivot <= 0.0 || pivot.is_nan() {
            return false;
        }
        let row: Vec<f64> = (0..n)
            .map(|j| if j == k { 1.0 } else { a[k * n + j] } / pivot)
            .collect();
        for i in (0..n).filter(|i| *i != k) {
            let factor = a[i * n + k];
            if factor == 0.0 {
                continue;
            }
            a[i * n + k] = 0.0;
            axpy(-factor, &row, &mut a[i * n..(i + 1) * n]);
        }
        a[k * n..(k + 1) * n].copy_from_slice(&row);
    }
    true
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const ROWS: usize = 12;
    const COLUMNS: usize = 6;

    /// Columns of length [`ROWS`], the target as the last.
    fn numbers() -> impl Strategy<Value = Vec<f64>> {
        prop::collection::vec(-1.0..1.0, ROWS * (COLUMNS + 1))
    }

    /// From columns of lengths 1, 2, 4, …
    fn form(numbers: &[f64]) -> QuadraticForm {
        let columns: Vec<Vec<f64>> = (numbers.chunks_exact(ROWS).enumerate())
            .map(|(j, c)| c.iter().map(|x| x * f64::from(1 << j)).collect())
            .collect();
        let products: Vec<f64> = (columns.iter())
            .flat_map(|a| columns.iter().map(|b| dot(a, b)))
            .collect();
        QuadraticForm::new(&products, COLUMNS)
    }

    fn supports() -> impl Strategy<Value = Vec<usize>> {
        prop::sample::subsequence((0..COLUMNS).collect::<Vec<_>>(), 0..COLUMNS)
    }

    /// A straight line through x = 0, 1, 2: the covariance of offset and slope is −x̄/Σ(x − x̄)².
    #[test]
    fn errors_of_offset_and_slope_are_correlated_as_in_the_textbook() {
        let (one, x, y) = ([1.0, 1.0, 1.0], [0.0, 1.0, 2.0], [0.1, 1.0, 2.1]);
        let columns = [one, x, y];
        let products = columns
            .iter()
            .flat_map(|a| columns.iter().map(|b| dot(a, b)));
        let form = QuadraticForm::new(&products.collect::<Vec<f64>>(), 2);
        let all = form.error_correlations(&[0, 1]).unwrap();
        let expected = -(3.0_f64 / 5.0).sqrt();
        assert!(
            (all[0] - 1.0).abs() < 1e-9 && (all[1] - expected).abs() < 1e-6,
            "{all:?}"
        );
    }

    fn criterion(form: &QuadraticForm, support: &[usize], penalty: f64) -> f64 {
        form.least_squares(support).square + penalty * support.len() as f64
    }

    /// Of two columns that are not worth their penalty the better one is taken, though none at all were better still.
    #[test]
    fn the_last_column_is_exchanged() {
        let columns: [&[f64]; 3] = [&[1.0, 0.0], &[0.0, 1.0], &[1.0, 2.0]];
        let products: Vec<f64> = (columns.iter())
            .flat_map(|a| columns.iter().map(|b| dot(a, b)))
            .collect();
        let form = QuadraticForm::new(&products, 2);
        assert_eq!(form.steepest_descent(&[0], 100.0), [1]);
    }

    proptest! {
        /// No other coefficients leave less, and what is left is what the columns leave.
        #[test]
        fn least_squares_are_the_least(numbers in numbers(), support in supports(), at in 0..COLUMNS, by in -1.0..1.0) {
            let least = form(&numbers).least_squares(&support);
            let left = |coefficients: &[f64]| -> f64 {
                (0..ROWS)
                    .map(|i| {
                        let value = |j: usize| numbers[j * ROWS + i] * f64::from(1 << j);
                        let fitted: f64 = support.iter().zip(coefficients).map(|(j, a)| a * value(*j)).sum();
                        (value(COLUMNS) - fitted).powi(2)
                    })
                    .sum()
            };
            let found = left(&least.coefficients);
            prop_assert!((found - least.square).abs() < 1e-6 * (1.0 + found), "{found} {}", least.square);
            let mut other = least.coefficients;
            if let Some(a) = other.get_mut(at) {
                *a += by;
            }
            prop_assert!(left(&other) > found - 1e-6 * (1.0 + found));
        }

        /// What a move is said to change is what refitting the support changes; all there are, the best first.
        #[test]
        fn moves_change_what_they_say(numbers in numbers(), support in supports(), penalty in 0.0..500.0) {
            let form = form(&numbers);
            let before = criterion(&form, &support, penalty);
            let moves = form.single_changes(&support, penalty, usize::MAX);
            let (inside, outside) = (support.len(), COLUMNS - support.len());
            prop_assert_eq!(moves.len(), inside + outside + inside * outside);
            prop_assert!(moves.is_sorted_by(|a, b| a.change <= b.change));
            for m in &moves {
                let next = m.applied(&support);
                let change = criterion(&form, &next, penalty) - before;
                prop_assert!((change - m.change).abs() < 1e-5 * (1.0 + form.total), "{} {change}", m.change);
            }
            let best = form.single_changes(&support, penalty, 2);
            prop_assert_eq!(best.len(), 2);
            prop_assert!(best[0].change == moves[0].change && best[1].change == moves[1].change);
        }

        /// Where the search by single moves ends no single move helps, and it is no worse than where it began.
        #[test]
        fn nothing_single_improves_the_improved(numbers in numbers(), support in supports(), penalty in 1.0..500.0) {
            let form = form(&numbers);
            let end = form.steepest_descent(&support, penalty);
            let value = criterion(&form, &end, penalty);
            prop_assert!(value <= criterion(&form, &support, penalty) + 1e-9);
            for m in form.single_changes(&end, penalty, usize::MAX) {
                let next = m.applied(&end);
                let gained = value - criterion(&form, &next, penalty);
                prop_assert!(next.is_empty() || gained < 1e-4 * (1.0 + form.total), "{end:?} {next:?} {gained}");
            }
        }

        /// The least is dropped first, and of what is left on the way each penalty gets its best.
        #[test]
        fn backwards_drops_what_is_missed_least(numbers in numbers(), penalties in prop::collection::vec(0.0..2000.0, 3)) {
            let form = form(&numbers);
            let mut way = vec![(0..COLUMNS).collect::<Vec<_>>()];
            while way[way.len() - 1].len() > 1 {
                let whole = &way[way.len() - 1];
                let without = |k: &usize| -> Vec<usize> { whole.iter().copied().filter(|j| j != k).collect() };
                let all = whole.iter().map(without);
                let cost = |s: &Vec<usize>| form.least_squares(s).square;
                way.extend(all.min_by(|a, b| cost(a).total_cmp(&cost(b))));
            }
            let all = form.backward_elimination(&penalties);
            prop_assert_eq!(all.len(), penalties.len());
            for (found, penalty) in all.iter().zip(&penalties) {
                let best = way.iter().map(|s| criterion(&form, s, *penalty)).fold(f64::INFINITY, f64::min);
                let value = criterion(&form, found, *penalty);
                prop_assert!((value - best).abs() < 1e-5 * (1.0 + form.total), "{found:?} {value} {best}");
            }
        }
    }
}
