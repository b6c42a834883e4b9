//! Sequentially thresholded least squares, the method of SINDy, as a baseline: fit all, drop the small, fit the rest again.
//!
//! Brunton, Proctor & Kutz (PNAS 2016); here without a ridge, by rank-revealing least squares, and with nothing to tune. In: a
//! [`Problem`] small enough to hold all of Φ. Out: a fit without a proof; the dual is zero.
//!
//! The rule: a column's share is |a_j|‖φ_j‖. A ladder of thresholds, 2⁻²⁰ to 2⁻¹ of the largest share, is climbed once: on each
//! rung, columns below the threshold are dropped and the rest fitted again until none is; the next rung goes on with what is left.
//! Of all rungs the sparsest within ε is the answer; if none is within ε, the one of the least Bayesian criterion
//! M ln(rss/M) + k ln M.

use nalgebra::DMatrix;

use sidc_progress::{Observer, SolverProgress};

use super::frame::settle;
use super::polish::Pivoted;
use super::reduce::{
    Range, add_scaled, minus, nonzero, norm, times, times_transposed, unit_columns, usable,
};
use super::{CONSISTENT, Problem, Solution, Solver, Status};

/// Most entries M·N of Φ: it is copied and factorised whole.
const MOST_ENTRIES: usize = 8_000_000;
/// Rungs of the ladder, each twice the one below; the last is one half.
const RUNGS: i32 = 20;
/// Most fits on one rung; what is left then goes on to the next.
const FITS: usize = 20;

/// Backward elimination by size.
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
        if rows.saturating_mul(cols) > MOST_ENTRIES {
            return Solution::zero(problem, refusal(rows, cols));
        }
        let size = match settle(problem) {
            Ok(size) => size,
            Err(settled) => return settled,
        };
        let mut ladder = Ladder::new(problem, size);
        let finished = ladder.climb(observer);
        ladder.finish(problem, finished)
    }
}

fn refusal(rows: usize, cols: usize) -> Status {
    Status::Refused {
        reason: format!(
            "stlsq needs all of {rows} × {cols} numbers at once, and takes up to {MOST_ENTRIES} of them"
        ),
    }
}

/// A least-squares fit on some of the columns.
#[derive(Clone)]
struct Fit {
    /// Rising, places among the usable columns.
    columns: Vec<usize>,
    /// Shares with their sign, to ‖y‖; as long as `columns`.
    shares: Vec<f64>,
    /// ‖Φ a − y‖/‖y‖
    residual: f64,
}

impl Fit {
    /// Columns that are not zero.
    fn terms(&self) -> usize {
        self.shares.iter().filter(|s| **s != 0.0).count()
    }

    /// The columns with at least this part of the largest share.
    fn above(&self, threshold: f64) -> Vec<usize> {
        let largest = self.shares.iter().fold(0.0_f64, |m, s| m.max(s.abs()));
        let columns = self.columns.iter().zip(&self.shares);
        let large = columns.filter(|(_, s)| s.abs() > 0.0 && s.abs() >= threshold * largest);
        large.map(|(j, _)| *j).collect()
    }
}

struct Ladder {
    /// Usable columns of the dictionary and their lengths.
    kept: Vec<usize>,
    norms: Vec<f64>,
    /// Unit columns, M × the number of `kept`.
    unit: DMatrix<f64>,
    /// y/‖y‖
    target: Vec<f64>,
    /// ‖y‖₂
    size: f64,
    /// Residual up to which a fit is within ε, to ‖y‖.
    allowed: f64,
    /// Smallest residual of all: what the whole of Φ leaves.
    least: f64,
    /// The end of every rung, the whole of Φ first; as the sets are nested, never denser.
    rungs: Vec<Fit>,
    fits: usize,
}

impl Ladder {
    fn new(problem: &Problem, size: f64) -> Ladder {
        let kept = usable(problem.dictionary);
        let norms: Vec<f64> = kept
            .iter()
            .map(|&j| problem.dictionary.norms()[j])
            .collect();
        Ladder {
            unit: unit_columns(problem.dictionary, &kept, &norms),
            kept,
            norms,
            target: problem.target.iter().map(|y| y / size).collect(),
            size,
            allowed: (problem.tolerance / size).max(CONSISTENT),
            least: 1.0,
            rungs: Vec::new(),
            fits: 0,
        }
    }

    /// False if the observer ended it.
    fn climb(&mut self, observer: &mut dyn Observer) -> bool {
        let mut fit = self.fit((0..self.kept.len()).collect());
        self.least = fit.residual;
        self.rungs.push(fit.clone());
        for rung in (1..=RUNGS).rev() {
            let threshold = 0.5_f64.powi(rung);
            for _ in 0..FITS {
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
            self.rungs.push(fit.clone());
        }
        true
    }

    fn fit(&mut self, columns: Vec<usize>) -> Fit {
        self.fits += 1;
        let mut part = DMatrix::zeros(self.unit.nrows(), columns.len());
        for (k, &j) in columns.iter().enumerate() {
            part.set_column(k, &self.unit.column(j));
        }
        let shares = least_squares(&part, &self.target);
        Fit {
            residual: norm(&minus(&self.target, &times(&part, &shares))),
            columns,
            shares,
        }
    }

    /// The sparsest within ε, or else the best by the Bayesian criterion; of equals the better fit, and so the first.
    fn choose(&self) -> Option<&Fit> {
        let within = self.rungs.iter().filter(|f| f.residual <= self.allowed);
        let by_size = |a: &&Fit, b: &&Fit| {
            let sizes = a.terms().cmp(&b.terms());
            sizes.then(a.residual.total_cmp(&b.residual))
        };
        let by_criterion = |a: &&Fit, b: &&Fit| self.criterion(a).total_cmp(&self.criterion(b));
        within
            .min_by(by_size)
            .or_else(|| self.rungs.iter().min_by(by_criterion))
    }

    /// Schwarz (1978); a residual below rounding is no better than rounding.
    fn criterion(&self, fit: &Fit) -> f64 {
        let rows = self.target.len() as f64;
        let rss = fit.residual.max(CONSISTENT).powi(2);
        rows * (rss / rows).ln() + fit.terms() as f64 * rows.ln()
    }

    fn finish(&self, problem: &Problem, finished: bool) -> Solution {
        let mut solution = Solution::zero(problem, Status::broken());
        solution.iterations = self.fits;
        let Some(best) = self.choose().filter(|f| f.residual.is_finite()) else {
            return solution;
        };
        let found = best.columns.iter().zip(&best.shares);
        let raw = found.map(|(&j, s)| (self.kept[j], s * self.size / self.norms[j]));
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
                residual: self.least * self.size,
            }
        };
        solution
    }
}

/// The minimiser of ‖P x − y‖, refined twice; zeros if nothing can be fitted (Golub & Van Loan, section 5.5).
fn least_squares(unit: &DMatrix<f64>, y: &[f64]) -> Vec<f64> {
    let Some(factors) = Factors::new(unit) else {
        return vec![0.0; unit.ncols()];
    };
    let mut x = factors.solve(y);
    for _ in 0..2 {
        let left = minus(y, &times(unit, &x));
        add_scaled(&mut x, 1.0, &factors.solve(&left));
    }
    x
}

/// Rank-revealing factors of P.
enum Factors {
    /// More columns than rows: U, Σ and Uᵀ P, for the minimiser of least norm.
    Wide(Range, DMatrix<f64>),
    /// Pivoted QR, with zeros at dependent columns.
    Tall(Pivoted),
}

impl Factors {
    fn new(unit: &DMatrix<f64>) -> Option<Factors> {
        if unit.ncols() <= unit.nrows() {
            return Pivoted::new(unit).map(Factors::Tall);
        }
        let range = Range::new(unit);
        let rows = range.basis.transpose() * unit;
        Some(Factors::Wide(range, rows))
    }

    fn solve(&self, y: &[f64]) -> Vec<f64> {
        match self {
            Factors::Tall(pivoted) => pivoted.solve(y),
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
    fn what_is_exactly_at_the_threshold_stays() {
        let fit = Fit {
            columns: vec![0, 2, 5, 7],
            shares: vec![-1.0, 0.5, 0.25, 0.0],
            residual: 0.0,
        };
        assert_eq!(fit.above(0.5), [0, 2]);
        assert_eq!(fit.above(0.125), [0, 2, 5]);
        assert_eq!(fit.above(0.0), [0, 2, 5]);
    }

    proptest! {
        /// Without a bound on the residual: the rung of the least M ln(rss/M) + k ln M, with rss of the target as it is.
        #[test]
        fn the_best_rung_is_the_criterions(numbers in prop::collection::vec(-1.0..1.0, ROWS * (COLUMNS + 1))) {
            let (target, columns) = numbers.split_at(ROWS);
            let dictionary = Dense::new(ROWS, columns.to_vec());
            let target: Vec<f64> = target.iter().zip(columns).map(|(y, x)| y + 3.0 * x).collect();
            let problem = Problem { dictionary: &dictionary, target: &target, tolerance: 0.0 };
            let size = norm(&target);
            let mut ladder = Ladder::new(&problem, size);
            prop_assert!(ladder.climb(&mut Unwatched));
            let by_hand = |f: &Fit| {
                let coefficients: Vec<(usize, f64)> = (f.columns.iter().zip(&f.shares))
                    .map(|(j, s)| (ladder.kept[*j], s * size / ladder.norms[*j]))
                    .collect();
                let rss = norm(&problem.left(&coefficients)).powi(2);
                let m = ROWS as f64;
                m * (rss / m).ln() + f.columns.len() as f64 * m.ln()
            };
            let chosen = by_hand(ladder.choose().unwrap());
            for rung in &ladder.rungs {
                prop_assert!(chosen <= by_hand(rung) + 1e-9);
                // The target has unit length inside, which shifts all of them alike.
                let shift = by_hand(rung) - ladder.criterion(rung);
                prop_assert!((shift - ROWS as f64 * (size * size).ln()).abs() < 1e-6, "{shift}");
            }
            let counts: Vec<usize> = ladder.rungs.iter().map(|f| f.columns.len()).collect();
            prop_assert!(counts.is_sorted_by(|a, b| a >= b), "{counts:?}");
            prop_assert!(ladder.fits <= COLUMNS + 1, "{}", ladder.fits);
        }
    }
}
