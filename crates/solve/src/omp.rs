//! Orthogonal matching pursuit, a greedy baseline: column after column, the one that explains most of what is left.
//!
//! Pati, Rezaiifar & Krishnaprasad (1993); Tropp & Gilbert (2007) say when it finds the sparsest answer. It asks a dictionary for
//! its strongest column and single columns only, so Φ may be of any size. In: a [`Problem`]. Out: a fit without a proof; the dual is zero.

use sidc_progress::{Observer, SolverProgress};

use super::frame::settle;
use super::polish::polish;
use super::reduce::{SHORTEST, add_scaled, dot, norm};
use super::{CONSISTENT, Problem, Solution, Solver, Status};

/// Most columns taken; with more, an answer is no longer sparse and the basis no longer cheap.
const MOST: usize = 200;
/// A unit column with less than this outside those taken, or a residual with less than this along any column, is dependent.
const DEPENDENT: f64 = 1e-11;

/// Greedy choice, orthogonal projection after every step.
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
        let size = match settle(problem) {
            Ok(size) => size,
            Err(settled) => return settled,
        };
        let mut pursuit = Pursuit::new(problem, size);
        let end = pursuit.run(observer);
        pursuit.finish(end)
    }
}

/// Why the pursuit ended.
#[derive(Clone, Copy, PartialEq)]
enum End {
    /// The residual is within the tolerance.
    Reached,
    /// No column has anything of the residual: no combination does better.
    Exhausted,
    /// As many columns as allowed, or numbers that overflow.
    Stopped,
    Interrupted,
}

struct Pursuit<'a> {
    problem: &'a Problem<'a>,
    /// ‖y‖₂
    size: f64,
    /// Residual up to which the fit is good, to ‖y‖.
    allowed: f64,
    /// Columns whose norm is no divisor; they may be the strongest and are passed over.
    short: usize,
    /// Columns taken, in order.
    taken: Vec<usize>,
    /// Their orthonormal basis, one vector of length M a column.
    basis: Vec<Vec<f64>>,
    /// (y − its projection)/‖y‖
    residual: Vec<f64>,
}

impl<'a> Pursuit<'a> {
    fn new(problem: &'a Problem<'a>, size: f64) -> Pursuit<'a> {
        let norms = problem.dictionary.norms().iter();
        Pursuit {
            problem,
            size,
            allowed: (problem.tolerance / size).max(CONSISTENT),
            short: norms.filter(|n| **n > 0.0 && **n <= SHORTEST).count(),
            taken: Vec::new(),
            basis: Vec::new(),
            residual: problem.target.iter().map(|y| y / size).collect(),
        }
    }

    fn run(&mut self, observer: &mut dyn Observer) -> End {
        let most = self.problem.dictionary.rows().min(MOST);
        loop {
            let left = norm(&self.residual);
            let progress = SolverProgress {
                iteration: self.taken.len(),
                gap: f64::INFINITY,
                residual: left,
                ..SolverProgress::default()
            };
            if left <= self.allowed {
                return End::Reached;
            }
            if progress.tell(observer).is_break() {
                return End::Interrupted;
            }
            if self.taken.len() >= most {
                return End::Stopped;
            }
            if let Err(end) = self.step(left) {
                return end;
            }
        }
    }

    /// Takes the strongest column and projects the residual off it.
    fn step(&mut self, left: f64) -> Result<(), End> {
        let dictionary = self.problem.dictionary;
        let strongest = dictionary.strongest(&self.residual, 1 + self.short, 0.0);
        let mut usable = strongest.columns.into_iter();
        let usable = usable.find(|(j, _)| dictionary.norms()[*j] > SHORTEST);
        let (column, correlation) = usable.ok_or(End::Exhausted)?;
        if !correlation.is_finite() {
            return Err(End::Stopped);
        }
        if correlation.abs() <= DEPENDENT * left {
            return Err(End::Exhausted);
        }
        let direction = self.outside(column).ok_or(End::Exhausted)?;
        self.taken.push(column);
        self.basis.push(direction);
        // Twice over the whole basis, so that the residual stays orthogonal to all of it.
        self.project();
        self.project();
        Ok(())
    }

    /// The unit column's part outside those taken, as a unit vector; Gram–Schmidt, twice is enough (Giraud et al. 2005).
    fn outside(&self, column: usize) -> Option<Vec<f64>> {
        let mut q = vec![0.0; self.residual.len()];
        self.problem.dictionary.column(column, &mut q);
        let length = self.problem.dictionary.norms()[column];
        q.iter_mut().for_each(|v| *v /= length);
        for _ in 0..2 {
            for b in &self.basis {
                let along = dot(b, &q);
                add_scaled(&mut q, -along, b);
            }
        }
        let rest = norm(&q);
        q.iter_mut().for_each(|v| *v /= rest);
        (rest > DEPENDENT && rest.is_finite()).then_some(q)
    }

    fn project(&mut self) {
        for b in &self.basis {
            let along = dot(b, &self.residual);
            add_scaled(&mut self.residual, -along, b);
        }
    }

    /// Coefficients by least squares on the columns taken, and what they leave decides the status.
    fn finish(&self, end: End) -> Solution {
        let mut support = self.taken.clone();
        support.sort_unstable();
        let y: Vec<f64> = self.problem.target.iter().map(|y| y / self.size).collect();
        let fit = polish(self.problem.dictionary, &y, &support);
        let raw = support.into_iter().zip(&fit.coefficients);
        let raw: Vec<(usize, f64)> = raw.map(|(j, a)| (j, a * self.size)).collect();
        if raw.iter().any(|(_, a)| !a.is_finite()) {
            return Solution::zero(self.problem, Status::broken());
        }
        let residual = self.size * fit.residual;
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
            iterations: self.taken.len(),
            ..Solution::zero(self.problem, Status::Interrupted)
        }
    }
}
