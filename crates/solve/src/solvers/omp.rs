//! Orthogonal matching pursuit, a greedy baseline: in each step the column that correlates most with the residual enters.
//!
//! Pati, Rezaiifar & Krishnaprasad (1993); Tropp & Gilbert (2007) say when it finds the sparsest answer. It prices columns and reads
//! single ones, so Φ may be of any size. In: a [`Problem`]. Out: a fit without a proof; the dual point is zero.

use sidc_progress::{Observer, SolverProgress};

use super::presolve::{is_finite, presolve};
use crate::least_squares::refit;
use crate::linalg::{norm, quotient};
use crate::problem::{Problem, Solution, Status};
use crate::simd::{axpy, dot};
use crate::solver::Solver;
use crate::thresholds::{CERTIFICATES, HEURISTICS, NUMERICAL_RANK};

/// Greedy selection, orthogonal projection after every step.
pub struct Omp;

impl Solver for Omp {
    fn name(&self) -> &'static str {
        "omp"
    }

    fn about(&self) -> &'static str {
        "orthogonal matching pursuit: greedy and fast; not a proof of the sparsest answer"
    }

    fn exact(&self) -> bool {
        false
    }

    fn solve(&self, problem: &Problem, observer: &mut dyn Observer) -> Solution {
        let target_norm = match presolve(problem) {
            Ok(target_norm) => target_norm,
            Err(solved) => return solved,
        };
        let mut pursuit = Pursuit::new(problem, target_norm);
        let end = pursuit.run(observer);
        pursuit.finish(end)
    }
}

impl Omp {
    /// ‖y − Φa‖₂ with no column, one, and so on, up to `most`; shorter where the residual falls within ε or no column lowers it. Empty if Φ
    /// or y is not finite.
    pub fn residuals(problem: &Problem, most: usize) -> Vec<f64> {
        let target_norm = norm(problem.target);
        if !is_finite(problem, target_norm) {
            return Vec::new();
        }
        let mut out = vec![target_norm];
        if target_norm <= problem.tolerance {
            return out;
        }
        let mut pursuit = Pursuit::new(problem, target_norm);
        let mut residual = 1.0;
        while out.len() <= most && residual > pursuit.allowed && pursuit.step(residual).is_ok() {
            residual = norm(&pursuit.residual);
            out.push(target_norm * residual);
        }
        out
    }
}

/// Why the pursuit ended.
#[derive(Clone, Copy, PartialEq)]
enum End {
    /// The residual is within the tolerance.
    Reached,
    /// No column correlates with the residual: no combination does better.
    Exhausted,
    /// The limit of columns is reached, or numbers overflow.
    Stopped,
    Interrupted,
}

struct Pursuit<'a> {
    problem: &'a Problem<'a>,
    /// ‖y‖₂
    target_norm: f64,
    /// Residual that counts as within ε, relative to ‖y‖.
    allowed: f64,
    /// Columns that are too short to divide by; they may have the largest correlation, and are skipped.
    short_columns: usize,
    /// Selected columns, in order.
    selected: Vec<usize>,
    /// Their orthonormal basis, one vector of length M a column.
    basis: Vec<Vec<f64>>,
    /// (y − its projection)/‖y‖
    residual: Vec<f64>,
}

impl<'a> Pursuit<'a> {
    fn new(problem: &'a Problem<'a>, target_norm: f64) -> Pursuit<'a> {
        let dictionary = problem.dictionary;
        let norms = (0..dictionary.cols()).map(|j| dictionary.norm(j));
        Pursuit {
            problem,
            target_norm,
            allowed: (problem.tolerance / target_norm).max(CERTIFICATES.consistent),
            short_columns: norms
                .filter(|n| *n > 0.0 && *n <= NUMERICAL_RANK.zero_column)
                .count(),
            selected: Vec::new(),
            basis: Vec::new(),
            residual: quotient(problem.target, target_norm),
        }
    }

    fn run(&mut self, observer: &mut dyn Observer) -> End {
        let most = self.problem.dictionary.rows().min(HEURISTICS.omp_columns);
        loop {
            let residual = norm(&self.residual);
            let progress = SolverProgress {
                iteration: self.selected.len(),
                gap: f64::INFINITY,
                residual,
                ..SolverProgress::default()
            };
            if residual <= self.allowed {
                return End::Reached;
            }
            if progress.tell(observer).is_break() {
                return End::Interrupted;
            }
            if self.selected.len() >= most {
                return End::Stopped;
            }
            if let Err(end) = self.step(residual) {
                return end;
            }
        }
    }

    /// Adds the column of largest correlation and projects the residual off it.
    fn step(&mut self, residual: f64) -> Result<(), End> {
        let dictionary = self.problem.dictionary;
        let priced = dictionary.price(&self.residual, 1 + self.short_columns, 0.0);
        let mut usable = priced.columns.into_iter();
        let usable = usable.find(|(j, _)| dictionary.norm(*j) > NUMERICAL_RANK.zero_column);
        let (column, correlation) = usable.ok_or(End::Exhausted)?;
        if !correlation.is_finite() {
            return Err(End::Stopped);
        }
        if correlation.abs() <= NUMERICAL_RANK.dependent * residual {
            return Err(End::Exhausted);
        }
        let direction = self.outside(column).ok_or(End::Exhausted)?;
        self.selected.push(column);
        self.basis.push(direction);
        // Twice over the whole basis, so that the residual stays orthogonal to all of it.
        self.project();
        self.project();
        Ok(())
    }

    /// The part of the unit column outside the selected ones, as a unit vector, by Gram–Schmidt twice (Giraud et al. 2005).
    fn outside(&self, column: usize) -> Option<Vec<f64>> {
        let mut q = vec![0.0; self.residual.len()];
        self.problem.dictionary.column(column, &mut q);
        let length = self.problem.dictionary.norm(column);
        q.iter_mut().for_each(|v| *v /= length);
        for _ in 0..2 {
            for b in &self.basis {
                let along = dot(b, &q);
                axpy(-along, b, &mut q);
            }
        }
        let rest = norm(&q);
        q.iter_mut().for_each(|v| *v /= rest);
        (rest > NUMERICAL_RANK.dependent && rest.is_finite()).then_some(q)
    }

    fn project(&mut self) {
        for b in &self.basis {
            let along = dot(b, &self.residual);
            axpy(-along, b, &mut self.residual);
        }
    }

    /// Refits the selected columns; the residual decides the status.
    fn finish(&self, end: End) -> Solution {
        let mut support = self.selected.clone();
        support.sort_unstable();
        let y = quotient(self.problem.target, self.target_norm);
        let fit = refit(self.problem.dictionary, &y, &support);
        let raw = support.into_iter().zip(&fit.coefficients);
        let raw: Vec<(usize, f64)> = raw.map(|(j, a)| (j, a * self.target_norm)).collect();
        if raw.iter().any(|(_, a)| !a.is_finite()) {
            return Solution::zero(self.problem, Status::broken_down());
        }
        let residual = self.target_norm * fit.residual;
        let status = match end {
            End::Interrupted => Status::Interrupted,
            _ if fit.residual <= self.allowed => Status::Solved,
            End::Exhausted => Status::Inconsistent { residual },
            _ => Status::Inaccurate {
                gap: f64::INFINITY,
                residual: fit.residual,
            },
        };
        Solution {
            coefficients: raw.into_iter().filter(|(_, a)| *a != 0.0).collect(),
            status,
            iterations: self.selected.len(),
            ..Solution::zero(self.problem, Status::Interrupted)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dictionary::Dense;
    use sidc_progress::Unwatched;
    use sidc_random::Numbers;

    #[test]
    fn residuals_fall_from_the_target_to_the_answer() {
        let mut numbers = Numbers(7);
        let (rows, columns) = (30, 80);
        let phi = Dense::new(rows, numbers.many(rows * columns));
        let target = numbers.many(rows);
        let problem = Problem {
            dictionary: &phi,
            target: &target,
            tolerance: 0.2 * norm(&target),
        };
        let all = Omp::residuals(&problem, rows);
        assert_eq!(all[0], norm(&target));
        assert!(all.windows(2).all(|pair| pair[1] < pair[0]), "{all:?}");
        let answer = Omp.solve(&problem, &mut Unwatched);
        assert_eq!(all.len(), 1 + answer.iterations);
        let support: Vec<usize> = answer.coefficients.iter().map(|(j, _)| *j).collect();
        let fit = refit(&phi, &target, &support);
        assert!((all[answer.iterations] / fit.residual - 1.0).abs() < 1e-9);
        assert_eq!(Omp::residuals(&problem, 2), all[..3]);
        let unknown = Problem {
            target: &vec![f64::NAN; rows],
            ..problem
        };
        assert!(Omp::residuals(&unknown, 2).is_empty());
    }
}
