//! The least squares of a triangular factor under linear constraints on the coefficients.
//!
//! In: R and the right side of a problem in corrections of the coefficients, the coefficients as they are, rows that they have to obey.
//! Out: the corrections, their residual, variances and covariances. Without rows, or where the free corrections obey them, the free
//! solution to the last digit. Never relaxes a row.
//!
//! The active inequalities are found by least distance programming (Lawson & Hanson 1974, chapter 23) on R alone, and eliminated with
//! the equations, so that both hold to rounding. Variances are those of the coefficients that are then free: at a bound the variance
//! is 0.

use super::incremental_qr::{IncrementalQr, Solution};
use super::square_root_information_filter::RowSink;
use nalgebra::DMatrix;
use sidc_solve::{
    LinearConstraint, RegressionBlock, Sense, constrained_least_squares, solution_space,
};

/// A correction, and the coefficients after it.
pub(crate) struct ConstrainedStep {
    pub solution: Solution,
    pub coefficients: Vec<f64>,
}

/// The correction of `present` of least residual that the rows allow; columns of the rows are places among the coefficients. `None`
/// if no coefficients obey them.
pub(crate) fn constrained_step(
    qr: &mut IncrementalQr,
    present: &[f64],
    rows: &[LinearConstraint],
) -> Option<ConstrainedStep> {
    let free = qr.solve();
    let corrected = present.iter().zip(&free.coefficients);
    let coefficients: Vec<f64> = corrected.map(|(a, d)| a + d).collect();
    if rows.iter().all(|r| r.holds(&|_, j| coefficients[j])) {
        return Some(ConstrainedStep {
            solution: free,
            coefficients,
        });
    }
    // Solved for the coefficients themselves: bounds are then met exactly, whatever the correction is.
    let factor = qr.factor();
    let k = present.len();
    let values = DMatrix::from_fn(k, k, |i, j| factor.entry(i, j));
    let along = |i: usize| (i..k).map(|j| factor.entry(i, j) * present[j]).sum::<f64>();
    let block = RegressionBlock {
        columns: (0..k).collect(),
        target: (0..k).map(|i| factor.entry(i, k) + along(i)).collect(),
        outside: factor.entry(k, k).powi(2),
        values,
        weight: 1.0,
        variance: 1.0,
    };
    let fit = constrained_least_squares(&[block], &[(0..k).collect()], rows)?;
    let mut coefficients = fit.values.into_iter().next()?;
    set_to_bounds(&mut coefficients, rows);
    let errors = fit.standard_errors.into_iter().next()?;
    let mut variances: Vec<f64> = errors.iter().map(|e| e * e).collect();
    if free.variances.contains(&f64::INFINITY) {
        // What the data alone do not determine, the rows may.
        let own = constrained_covariances(qr, &coefficients, rows);
        for (j, (variance, column)) in variances.iter_mut().zip(own).enumerate() {
            if column.is_none_or(|column| !column[j].is_finite()) {
                *variance = f64::INFINITY;
            }
        }
    }
    let moved = coefficients.iter().zip(present);
    Some(ConstrainedStep {
        solution: Solution {
            coefficients: moved.map(|(a, b)| a - b).collect(),
            residual: fit.squares.iter().sum(),
            variances,
        },
        coefficients,
    })
}

/// A value that a row alone gives is that value, not one beside it by the rounding of the solution.
fn set_to_bounds(coefficients: &mut [f64], rows: &[LinearConstraint]) {
    for row in rows {
        let touched = row.is_touched(&|_, j| coefficients[j]);
        if let ([(_, j, weight)], true) = (row.entries.as_slice(), touched) {
            // Adding zero turns −0 into 0.
            coefficients[*j] = row.right / weight + 0.0;
        }
    }
}

/// Columns of the covariance of coefficients that obey the rows and touch some of them; `None` for undetermined ones.
pub(crate) fn constrained_covariances(
    qr: &mut IncrementalQr,
    coefficients: &[f64],
    rows: &[LinearConstraint],
) -> Vec<Option<Vec<f64>>> {
    let k = coefficients.len();
    let touched = |r: &&LinearConstraint| {
        r.sense == Sense::Equal || !r.entries.is_empty() && r.is_touched(&|_, j| coefficients[j])
    };
    let binding: Vec<&LinearConstraint> = rows.iter().filter(touched).collect();
    let space = match binding.is_empty() {
        true => None,
        false => solution_space(k, binding),
    };
    let Some(space) = space else {
        return qr.covariances();
    };
    // In the free coefficients u, a = constant + T u: the rows are R T.
    let (t, u) = (&space.matrix, space.matrix.ncols());
    let factor = qr.factor();
    let mut reduced = IncrementalQr::new(u);
    for i in 0..k {
        let row = reduced.reserve_rows(1);
        row.fill(0.0);
        for (c, out) in row.iter_mut().take(u).enumerate() {
            *out = (i..k).map(|j| factor.entry(i, j) * t[(j, c)]).sum();
        }
    }
    let inner = reduced.covariances();
    let column = |j: usize| {
        let mut out = vec![0.0; k];
        for c in (0..u).filter(|c| t[(j, *c)] != 0.0) {
            let own = inner[c].as_ref()?;
            for (i, out) in out.iter_mut().enumerate() {
                let along: f64 = (0..u).map(|d| t[(i, d)] * own[d]).sum();
                *out += t[(j, c)] * along;
            }
        }
        Some(out)
    };
    (0..k).map(column).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DVector;
    use sidc_random::Numbers;

    fn row(entries: &[(usize, f64)], sense: Sense, right: f64) -> LinearConstraint {
        LinearConstraint {
            entries: entries.iter().map(|(j, w)| (0, *j, *w)).collect(),
            sense,
            right,
        }
    }

    /// Random rows [a | right], and their QR factor.
    fn problem(k: usize, numbers: &mut Numbers) -> (DMatrix<f64>, DVector<f64>, IncrementalQr) {
        let m = 3 * k + 4;
        let a = DMatrix::from_fn(m, k, |_, j| numbers.next() * 10f64.powi(j as i32 % 5 - 2));
        let y = DVector::from_fn(m, |_, _| numbers.next());
        let mut qr = IncrementalQr::new(k);
        for i in 0..m {
            let out = qr.reserve_rows(1);
            (0..k).for_each(|j| out[j] = a[(i, j)]);
            out[k] = y[i];
        }
        (a, y, qr)
    }

    /// Rows that the coefficients `inside` obey: one equation, some inequalities.
    fn rows(inside: &[f64], numbers: &mut Numbers) -> Vec<LinearConstraint> {
        let k = inside.len();
        let mut made = Vec::new();
        for c in 0..5 {
            let (i, j) = (c % k, (c * 2 + 1) % k);
            let mut entries = vec![(i, numbers.next() / inside[i].abs().max(1e-3))];
            if i != j && c % 2 == 0 {
                entries.push((j, numbers.next() / inside[j].abs().max(1e-3)));
            }
            let at: f64 = entries.iter().map(|(j, w)| w * inside[*j]).sum();
            let (sense, slack) = match c {
                0 => (Sense::Equal, 0.0),
                _ => (Sense::AtMost, 0.2 * numbers.next().abs()),
            };
            made.push(row(&entries, sense, at + slack));
        }
        made
    }

    /// The gradient of χ² at a constrained minimum is a sum of the rows that it touches, with the sign that pulls against them
    /// (Karush, Kuhn and Tucker). The multipliers are those of least squares; scale is the size of the gradient's summands.
    fn assert_optimal(a: &DMatrix<f64>, y: &DVector<f64>, x: &[f64], rows: &[LinearConstraint]) {
        let x = DVector::from_column_slice(x);
        let at = |_: usize, j: usize| x[j];
        assert!(rows.iter().all(|r| r.holds(&at)), "{x} {rows:?}");
        let k = x.len();
        let lengths: Vec<f64> = (0..k).map(|j| a.column(j).norm()).collect();
        let scaled = |j: usize, g: f64| g / lengths[j];
        let pull = a.transpose() * (y - a * &x);
        let pull = DVector::from_fn(k, |j, _| scaled(j, pull[j]));
        let touched: Vec<&LinearConstraint> = rows.iter().filter(|r| r.is_touched(&at)).collect();
        let normals = DMatrix::from_fn(k, touched.len(), |j, c| {
            let own = touched[c].entries.iter().filter(|e| e.1 == j);
            scaled(j, own.map(|e| e.2).sum())
        });
        if touched.is_empty() {
            assert!(pull.norm() < 1e-9, "{pull}");
            return;
        }
        let multipliers = normals.clone().svd(true, true).solve(&pull, 1e-12).unwrap();
        assert!((&normals * &multipliers - &pull).norm() < 1e-8, "{pull}");
        for (m, r) in multipliers.iter().zip(&touched) {
            assert!(r.sense == Sense::Equal || *m > -1e-8, "{m} {r:?}");
        }
    }

    #[test]
    fn the_constrained_step_is_optimal() {
        let mut numbers = Numbers(3);
        let mut bound = 0;
        for k in [1, 2, 3, 5, 8, 12] {
            for _ in 0..40 {
                let (a, y, mut qr) = problem(k, &mut numbers);
                let inside = numbers.many(k);
                let rows = rows(&inside, &mut numbers);
                let step = constrained_step(&mut qr, &vec![0.0; k], &rows).unwrap();
                assert_optimal(&a, &y, &step.coefficients, &rows);
                let x = DVector::from_column_slice(&step.coefficients);
                let square = (&a * &x - &y).norm_squared();
                assert!((step.solution.residual - square).abs() < 1e-10 * (1.0 + square));
                bound += usize::from(rows[1..].iter().any(|r| r.is_touched(&|_, j| x[j])));
                // From another point the same coefficients are reached.
                let moved = numbers.many(k);
                let right = &y - &a * DVector::from_column_slice(&moved);
                let mut from_there = IncrementalQr::new(k);
                for i in 0..a.nrows() {
                    let out = from_there.reserve_rows(1);
                    (0..k).for_each(|j| out[j] = a[(i, j)]);
                    out[k] = right[i];
                }
                let again = constrained_step(&mut from_there, &moved, &rows).unwrap();
                let pairs = again.coefficients.iter().zip(&step.coefficients);
                for (j, (b, c)) in pairs.enumerate() {
                    assert!((b - c).abs() * a.column(j).norm() < 1e-8, "{b} {c}");
                }
            }
        }
        assert!(bound > 100, "{bound}");
    }

    #[test]
    fn rows_that_the_free_step_obeys_change_no_digit() {
        let mut numbers = Numbers(5);
        let (_, _, mut qr) = problem(6, &mut numbers);
        let free = qr.solve();
        let rows = [row(&[(2, 1.0)], Sense::Below, free.coefficients[2] + 1e-3)];
        let step = constrained_step(&mut qr, &[0.0; 6], &rows).unwrap();
        assert_eq!(step.coefficients, free.coefficients);
        assert_eq!(step.solution.variances, free.variances);
        let far = [row(&[(2, 1.0)], Sense::AtMost, free.coefficients[2] - 1.0)];
        let step = constrained_step(&mut qr, &[0.0; 6], &far).unwrap();
        assert_eq!(step.coefficients[2], free.coefficients[2] - 1.0);
        assert_eq!(step.solution.variances[2], 0.0);
        assert!(step.solution.variances[3] < free.variances[3]);
    }

    #[test]
    fn rows_determine_what_equal_columns_leave_open() {
        let mut numbers = Numbers(13);
        let mut qr = IncrementalQr::new(3);
        let (mut a, mut y) = (DMatrix::zeros(20, 3), DVector::zeros(20));
        for i in 0..20 {
            let (first, last, right) = (numbers.next(), numbers.next(), numbers.next());
            a.set_row(i, &nalgebra::RowDVector::from_vec(vec![first, first, last]));
            y[i] = right;
            let out = qr.reserve_rows(1);
            out[..4].copy_from_slice(&[first, first, last, right]);
        }
        // Without the row, a₀ + a₁ alone is determined.
        assert!(qr.solve().variances[1].is_infinite());
        let tied = [row(&[(0, 1.0), (2, -1.0)], Sense::Equal, 0.0)];
        let step = constrained_step(&mut qr, &[0.0; 3], &tied).unwrap();
        assert_optimal(&a, &y, &step.coefficients, &tied);
        let free = DMatrix::from_columns(&[a.column(0) + a.column(2), a.column(1).into_owned()]);
        let inner = (free.transpose() * free).try_inverse().unwrap();
        for (j, c) in [(0, 0), (1, 1), (2, 0)] {
            let variance = step.solution.variances[j];
            assert!((variance / inner[(c, c)] - 1.0).abs() < 1e-9, "{variance}");
        }
        // A row about something else does not.
        let other = [row(&[(2, 1.0)], Sense::AtMost, step.coefficients[2] - 0.1)];
        let step = constrained_step(&mut qr, &[0.0; 3], &other).unwrap();
        assert!(step.solution.variances[1].is_infinite());
    }

    #[test]
    fn rows_that_contradict_each_other_give_nothing() {
        let (_, _, mut qr) = problem(2, &mut Numbers(9));
        let both = [
            row(&[(0, 1.0)], Sense::AtMost, -1.0),
            row(&[(0, -1.0)], Sense::AtMost, -1.0),
        ];
        assert!(constrained_step(&mut qr, &[0.0; 2], &both).is_none());
        // A coefficient off the support is zero.
        assert!(constrained_step(&mut qr, &[0.0; 2], &[row(&[], Sense::Equal, 1.0)]).is_none());
    }

    #[test]
    fn covariances_are_those_of_the_free_coefficients() {
        let mut numbers = Numbers(11);
        let (a, _, mut qr) = problem(4, &mut numbers);
        // a₀ = −a₂ and a₃ = 0.5: the columns a₀ − a₂ and a₁ are free.
        let rows = [
            row(&[(0, 1.0), (2, 1.0)], Sense::Equal, 0.0),
            row(&[(3, -1.0)], Sense::AtMost, -0.5),
        ];
        let own = constrained_covariances(&mut qr, &[1.0, 2.0, -1.0, 0.5], &rows);
        let free = DMatrix::from_columns(&[a.column(0) - a.column(2), a.column(1).into_owned()]);
        let inner = (free.transpose() * free).try_inverse().unwrap();
        let own: Vec<Vec<f64>> = own.into_iter().map(Option::unwrap).collect();
        let close = |x: f64, y: f64| assert!((x / y - 1.0).abs() < 1e-9, "{x} {y}");
        close(own[0][0], inner[(0, 0)]);
        close(own[2][2], inner[(0, 0)]);
        close(own[0][2], -inner[(0, 0)]);
        close(own[1][1], inner[(1, 1)]);
        close(own[2][1], -inner[(0, 1)]);
        assert_eq!(own[3], [0.0; 4]);
        // No row is touched: those of least squares.
        let plain = constrained_covariances(&mut qr, &[1.0, 2.0, -1.0, 0.6], &rows[1..]);
        assert_eq!(plain, qr.covariances());
    }
}
