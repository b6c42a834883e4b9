//! Sequentially thresholded least squares, the method of SINDy, as a baseline: fit all columns, drop the small ones, fit again.
//!
//! Brunton, Proctor & Kutz (PNAS 2016); here without a ridge, by rank-revealing least squares, and with nothing to tune. In: a
//! [`Problem`] small enough to store all of Φ. Out: a fit without a proof; the dual point is zero.
//!
//! A column's contribution is |a_j|‖φ_j‖. Thresholds rise from 2⁻²⁰ to 2⁻¹ of the largest contribution. At each threshold, columns
//! below it are dropped and the others fitted again until all are above; the next threshold starts from these. The answer is the
//! sparsest fit within ε or, if none is within ε, that of the least Bayesian criterion M ln(rss/M) + k ln M.

use nalgebra::DMatrix;

use sidc_progress::{Observer, SolverProgress};

use super::presolve::presolve;
use crate::dictionary::{unit_columns, usable_columns};
use crate::linalg::{
    Range, RankRevealingQr, difference, nonzero, norm, quotient, times, times_transposed,
};
use crate::problem::{Problem, Solution, Status};
use crate::simd::axpy;
use crate::solver::Solver;
use crate::thresholds::{CERTIFICATES, HEURISTICS};

/// Backward elimination by thresholds.
pub struct Stlsq;

impl Solver for Stlsq {
    fn name(&self) -> &'static str {
        "stlsq"
    }

    fn about(&self) -> &'static str {
        "sequentially thresholded least squares (SINDy); not a proof of the sparsest answer"
    }

    fn exact(&self) -> bool {
        false
    }

    fn solve(&self, problem: &Problem, observer: &mut dyn Observer) -> Solution {
        let dictionary = problem.dictionary;
        let (rows, cols) = (dictionary.rows(), dictionary.cols());
        if rows.saturating_mul(cols) > HEURISTICS.stlsq_entries {
            return Solution::zero(problem, refusal(rows, cols));
        }
        let target_norm = match presolve(problem) {
            Ok(target_norm) => target_norm,
            Err(solved) => return solved,
        };
        let mut elimination = Elimination::new(problem, target_norm);
        let finished = elimination.run(observer);
        elimination.finish(problem, finished)
    }
}

fn refusal(rows: usize, cols: usize) -> Status {
    Status::Refused {
        reason: format!(
            "stlsq needs all of {rows} × {cols} numbers at once, and takes up to {} of them",
            HEURISTICS.stlsq_entries
        ),
    }
}

/// A least-squares fit on some of the columns.
#[derive(Clone)]
struct Fit {
    /// Rising, places among the usable columns.
    columns: Vec<usize>,
    /// Coefficients of unit columns, relative to ‖y‖; as long as `columns`.
    contributions: Vec<f64>,
    /// ‖Φ a − y‖/‖y‖
    residual: f64,
}

impl Fit {
    /// Columns that are not zero.
    fn terms(&self) -> usize {
        self.contributions.iter().filter(|s| **s != 0.0).count()
    }

    /// The columns with at least this part of the largest contribution.
    fn above(&self, threshold: f64) -> Vec<usize> {
        let largest = self
            .contributions
            .iter()
            .fold(0.0_f64, |m, s| m.max(s.abs()));
        let columns = self.columns.iter().zip(&self.contributions);
        let large = columns.filter(|(_, s)| s.abs() > 0.0 && s.abs() >= threshold * largest);
        large.map(|(j, _)| *j).collect()
    }
}

struct Elimination {
    /// Usable columns of the dictionary and their lengths.
    kept: Vec<usize>,
    norms: Vec<f64>,
    /// Unit columns, M × the number of `kept`.
    unit: DMatrix<f64>,
    /// y/‖y‖
    target: Vec<f64>,
    /// ‖y‖₂
    target_norm: f64,
    /// Residual that counts as within ε, relative to ‖y‖.
    allowed: f64,
    /// Residual of the fit on all of Φ, relative to ‖y‖.
    least_residual: f64,
    /// The last fit at every threshold, all of Φ first. Their supports are nested.
    threshold_fits: Vec<Fit>,
    fits: usize,
}

impl Elimination {
    fn new(problem: &Problem, target_norm: f64) -> Elimination {
        let kept = usable_columns(problem.dictionary);
        let norms: Vec<f64> = kept.iter().map(|&j| problem.dictionary.norm(j)).collect();
        Elimination {
            unit: unit_columns(problem.dictionary, &kept, &norms),
            kept,
            norms,
            target: quotient(problem.target, target_norm),
            target_norm,
            allowed: (problem.tolerance / target_norm).max(CERTIFICATES.consistent),
            least_residual: 1.0,
            threshold_fits: Vec::new(),
            fits: 0,
        }
    }

    /// False if the observer stopped it.
    fn run(&mut self, observer: &mut dyn Observer) -> bool {
        let mut fit = self.fit((0..self.kept.len()).collect());
        self.least_residual = fit.residual;
        self.threshold_fits.push(fit.clone());
        for exponent in (1..=HEURISTICS.stlsq_thresholds).rev() {
            let threshold = 0.5_f64.powi(exponent);
            for _ in 0..HEURISTICS.stlsq_fits {
                let progress = SolverProgress {
                    iteration: self.fits,
                    gap: f64::INFINITY,
                    residual: fit.residual,
                    ..SolverProgress::default()
                };
                if progress.tell(observer).is_break() {
                    return false;
                }
                let large = fit.above(threshold);
                if large.len() == fit.columns.len() {
                    break;
                }
                fit = self.fit(large);
            }
            self.threshold_fits.push(fit.clone());
        }
        true
    }

    fn fit(&mut self, columns: Vec<usize>) -> Fit {
        self.fits += 1;
        let mut part = DMatrix::zeros(self.unit.nrows(), columns.len());
        for (k, &j) in columns.iter().enumerate() {
            part.set_column(k, &self.unit.column(j));
        }
        let contributions = least_squares(&part, &self.target);
        Fit {
            residual: norm(&difference(&self.target, &times(&part, &contributions))),
            columns,
            contributions,
        }
    }

    /// The sparsest within ε, otherwise the best by the Bayesian criterion; of equal ones the one that fits better.
    fn choose(&self) -> Option<&Fit> {
        let within = self
            .threshold_fits
            .iter()
            .filter(|f| f.residual <= self.allowed);
        let by_size = |a: &&Fit, b: &&Fit| {
            let sizes = a.terms().cmp(&b.terms());
            sizes.then(a.residual.total_cmp(&b.residual))
        };
        let by_criterion = |a: &&Fit, b: &&Fit| self.criterion(a).total_cmp(&self.criterion(b));
        within
            .min_by(by_size)
            .or_else(|| self.threshold_fits.iter().min_by(by_criterion))
    }

    /// The Bayesian criterion (Schwarz 1978). A residual below rounding counts as rounding.
    fn criterion(&self, fit: &Fit) -> f64 {
        let rows = self.target.len() as f64;
        let rss = fit.residual.max(CERTIFICATES.consistent).powi(2);
        rows * (rss / rows).ln() + fit.terms() as f64 * rows.ln()
    }

    fn finish(&self, problem: &Problem, finished: bool) -> Solution {
        let mut solution = Solution::zero(problem, Status::broken_down());
        solution.iterations = self.fits;
        let Some(best) = self.choose().filter(|f| f.residual.is_finite()) else {
            return solution;
        };
        let found = best.columns.iter().zip(&best.contributions);
        let raw = found.map(|(&j, s)| (self.kept[j], s * self.target_norm / self.norms[j]));
        let coefficients: Vec<(usize, f64)> = raw.filter(|(_, a)| *a != 0.0).collect();
        if coefficients.iter().any(|(_, a)| !a.is_finite()) {
            return solution;
        }
        solution.coefficients = coefficients;
        solution.status = if !finished {
            Status::Interrupted
        } else if best.residual <= self.allowed {
            Status::Solved
        } else {
            Status::Inconsistent {
                residual: self.least_residual * self.target_norm,
            }
        };
        solution
    }
}

/// The minimiser of ‖P x − y‖ with two steps of iterative refinement (Golub & Van Loan, section 5.5); zeros if P is empty.
fn least_squares(unit: &DMatrix<f64>, y: &[f64]) -> Vec<f64> {
    let Some(factors) = Factors::new(unit) else {
        return vec![0.0; unit.ncols()];
    };
    let mut x = factors.solve(y);
    for _ in 0..2 {
        let residual = difference(y, &times(unit, &x));
        axpy(1.0, &factors.solve(&residual), &mut x);
    }
    x
}

/// Rank-revealing factors of P.
enum Factors {
    /// More columns than rows: U, Σ and Uᵀ P, for the minimiser of least norm.
    Wide(Range, DMatrix<f64>),
    /// Rank-revealing QR, with zeros at dependent columns.
    Tall(RankRevealingQr),
}

impl Factors {
    fn new(unit: &DMatrix<f64>) -> Option<Factors> {
        if unit.ncols() <= unit.nrows() {
            return RankRevealingQr::new(unit).map(Factors::Tall);
        }
        let range = Range::new(unit);
        let rows = range.basis.transpose() * unit;
        Some(Factors::Wide(range, rows))
    }

    fn solve(&self, y: &[f64]) -> Vec<f64> {
        match self {
            Factors::Tall(qr) => qr.solve(y),
            Factors::Wide(range, rows) => {
                let mut z = times_transposed(&range.basis, y);
                let squares = range.values.iter().map(|s| nonzero(s * s));
                z.iter_mut().zip(squares).for_each(|(z, s)| *z /= s);
                times_transposed(rows, &z)
            }
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use sidc_progress::Unwatched;

    use proptest::prelude::*;

    use super::*;
    use crate::dictionary::Dense;

    const ROWS: usize = 20;
    const COLUMNS: usize = 5;

    #[test]
    fn a_column_at_the_threshold_is_kept() {
        let fit = Fit {
            columns: vec![0, 2, 5, 7],
            contributions: vec![-1.0, 0.5, 0.25, 0.0],
            residual: 0.0,
        };
        assert_eq!(fit.above(0.5), [0, 2]);
        assert_eq!(fit.above(0.125), [0, 2, 5]);
        assert_eq!(fit.above(0.0), [0, 2, 5]);
    }

    proptest! {
        /// Without a bound on the residual: the rung of the least M ln(rss/M) + k ln M, with rss of the target as it is.
        #[test]
        fn the_criterion_chooses(numbers in prop::collection::vec(-1.0..1.0, ROWS * (COLUMNS + 1))) {
            let (target, columns) = numbers.split_at(ROWS);
            let dictionary = Dense::new(ROWS, columns.to_vec());
            let target: Vec<f64> = target.iter().zip(columns).map(|(y, x)| y + 3.0 * x).collect();
            let problem = Problem { dictionary: &dictionary, target: &target, tolerance: 0.0 };
            let target_norm = norm(&target);
            let mut elimination = Elimination::new(&problem, target_norm);
            prop_assert!(elimination.run(&mut Unwatched));
            let by_hand = |f: &Fit| {
                let coefficients: Vec<(usize, f64)> = (f.columns.iter().zip(&f.contributions))
                    .map(|(j, s)| (elimination.kept[*j], s * target_norm / elimination.norms[*j]))
                    .collect();
                let rss = norm(&problem.residual(&coefficients)).powi(2);
                let m = ROWS as f64;
                m * (rss / m).ln() + f.columns.len() as f64 * m.ln()
            };
            let chosen = by_hand(elimination.choose().unwrap());
            for fit in &elimination.threshold_fits {
                prop_assert!(chosen <= by_hand(fit) + 1e-9);
                // The target has unit length inside, which shifts all of them alike.
                let shift = by_hand(fit) - elimination.criterion(fit);
                prop_assert!((shift - ROWS as f64 * (target_norm * target_norm).ln()).abs() < 1e-6, "{shift}");
            }
            let counts: Vec<usize> = elimination.threshold_fits.iter().map(|f| f.columns.len()).collect();
            prop_assert!(counts.is_sorted_by(|a, b| a >= b), "{counts:?}");
            prop_assert!(elimination.fits <= COLUMNS + 1, "{}", elimination.fits);
        }
    }
}
