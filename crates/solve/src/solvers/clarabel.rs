//! A second, independent solver: basis pursuit as a conic program for the Clarabel crate.
//!
//! `min Σu s.t. −u ≤ x ≤ u, P x = q` (or ‖P x − q‖ ≤ ε as a second-order cone), u before x, which keeps the factor sparse.
//! Clarabel fails on numerically dependent rows, so the rows are first reduced by a singular value decomposition. It is there to
//! check the default solver, not for speed.

use std::sync::{Mutex, mpsc};

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultInfo, DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SecondOrderConeT,
    SolverStatus, ZeroConeT,
};

use sidc_progress::{Observer, SolverProgress};

use super::column_generation::solve_reduced;
use super::range_reduction::ReducedProblem;
use crate::certificates::certify;
use crate::linalg::{difference, nonzero, norm, times};
use crate::problem::{Problem, Solution, Status};
use crate::solver::Solver;
use crate::thresholds::CONIC;

/// Clarabel's interior point on the split-free conic form.
pub struct Clarabel;

impl Solver for Clarabel {
    fn name(&self) -> &'static str {
        "clarabel"
    }

    fn about(&self) -> &'static str {
        "Clarabel's conic interior point, a second opinion"
    }

    fn solve(&self, problem: &Problem, observer: &mut dyn Observer) -> Solution {
        let solution = solve_reduced(problem, |reduced, tolerance| {
            let program = ConicProgram::new(reduced, tolerance);
            let found = program.run(observer)?;
            Some(program.read(reduced, &found))
        });
        proved(problem, solution)
    }
}

/// Clarabel also stops at an absolute gap, which is a wide one where the minimum is small: solved is what the certificate proves.
fn proved(problem: &Problem, solution: Solution) -> Solution {
    if solution.status != Status::Solved {
        return solution;
    }
    let certificate = certify(problem, &solution.coefficients, &solution.dual);
    let status = match certificate.proves_optimal {
        true => Status::Solved,
        false => Status::Inaccurate {
            gap: certificate.gap,
            residual: certificate.residual,
        },
    };
    Solution { status, ..solution }
}

/// The data of the conic program: the rows of P with the largest singular values, and their right-hand side.
struct ConicProgram {
    rows: usize,
    cols: usize,
    /// Column-major rows × cols.
    values: Vec<f64>,
    target: Vec<f64>,
    /// q of the dropped rows.
    dropped: Vec<f64>,
    /// ε of the kept rows; zero for equality.
    tolerance: f64,
}

/// What Clarabel returns.
struct ConicSolution {
    x: Vec<f64>,
    z: Vec<f64>,
    status: SolverStatus,
    iterations: usize,
    gap: f64,
}

impl ConicProgram {
    fn new(reduced: &ReducedProblem, inner: f64) -> ConicProgram {
        let largest = reduced.singular_values.first().copied().unwrap_or(0.0);
        let rows = reduced
            .singular_values
            .iter()
            .take_while(|s| **s > CONIC.singular_value * largest)
            .count();
        let kept = reduced.matrix.rows(0, rows);
        let (target, dropped) = reduced.target.split_at(rows);
        let rest = norm(dropped);
        ConicProgram {
            rows,
            cols: kept.ncols(),
            values: kept.iter().copied().collect(),
            target: target.to_vec(),
            dropped: dropped.to_vec(),
            tolerance: ((inner - rest) * (inner + rest)).max(0.0).sqrt(),
        }
    }

    /// Constraint matrix over (u, x): data rows, then x − u ≤ 0 and −x − u ≤ 0. A second-order cone has one more row, its head.
    fn matrix(&self) -> CscMatrix<f64> {
        let (r, n, head) = (self.rows, self.cols, self.head());
        let bound = head + r;
        let (mut starts, mut places, mut entries) = (vec![0], Vec::new(), Vec::new());
        for j in 0..n {
            places.extend([bound + j, bound + n + j]);
            entries.extend([-1.0, -1.0]);
            starts.push(places.len());
        }
        for (j, column) in self.values.chunks_exact(r.max(1)).enumerate() {
            places.extend((0..r).map(|i| head + i));
            entries.extend_from_slice(column);
            places.extend([bound + j, bound + n + j]);
            entries.extend([1.0, -1.0]);
            starts.push(places.len());
        }
        CscMatrix::new(bound + 2 * n, 2 * n, starts, places, entries)
    }

    /// Rows before the data rows.
    fn head(&self) -> usize {
        usize::from(self.tolerance > 0.0)
    }

    /// Runs Clarabel on a second thread, which asks the observer on this one after each iteration; `None` if it fails to start.
    fn run(&self, observer: &mut dyn Observer) -> Option<ConicSolution> {
        let (ask, asked) = mpsc::channel::<SolverProgress>();
        let (answer, answered) = mpsc::channel::<bool>();
        let answered = Mutex::new(answered);
        let stop = move |info: &DefaultInfo<f64>| {
            let progress = SolverProgress {
                iteration: info.iterations as usize,
                gap: info.gap_rel,
                residual: info.res_primal,
                ..SolverProgress::default()
            };
            let sent = ask.send(progress).is_ok();
            let reply = answered.lock().ok().and_then(|a| a.recv().ok());
            sent && reply.unwrap_or(false)
        };
        if cfg!(target_arch = "wasm32") {
            // No threads there, so the observer is not asked.
            return self.solve(|_| false);
        }
        std::thread::scope(|scope| {
            let worker = scope.spawn(move || self.solve(stop));
            while let Ok(progress) = asked.recv() {
                let stop = progress.tell(observer).is_break();
                if answer.send(stop).is_err() {
                    break;
                }
            }
            worker.join().ok().flatten()
        })
    }

    fn solve(
        &self,
        stop: impl FnMut(&DefaultInfo<f64>) -> bool + Send + Sync + 'static,
    ) -> Option<ConicSolution> {
        let n = self.cols;
        let matrix = self.matrix();
        let mut cost = vec![1.0; n];
        cost.resize(2 * n, 0.0);
        let mut b = vec![self.tolerance; self.head()];
        b.extend_from_slice(&self.target);
        b.resize(b.len() + 2 * n, 0.0);
        let data = if self.head() == 1 {
            SecondOrderConeT(self.rows + 1)
        } else {
            ZeroConeT(self.rows)
        };
        let settings = DefaultSettings {
            verbose: false,
            ..DefaultSettings::default()
        };
        let none = CscMatrix::zeros((2 * n, 2 * n));
        let cones = [data, NonnegativeConeT(2 * n)];
        let mut solver = DefaultSolver::new(&none, &cost, &matrix, &b, &cones, settings).ok()?;
        solver.set_termination_callback(stop);
        solver.solve();
        Some(ConicSolution {
            x: solver.solution.x.iter().skip(n).copied().collect(),
            z: solver.solution.z.clone(),
            status: solver.solution.status,
            iterations: solver.solution.iterations as usize,
            gap: solver.info.gap_rel,
        })
    }

    /// Back to the original rows and units. Clarabel's status is checked against the residual.
    fn read(&self, reduced: &ReducedProblem, found: &ConicSolution) -> Solution {
        let finite = |v: &[f64]| {
            v.iter()
                .map(|x| if x.is_finite() { *x } else { 0.0 })
                .collect::<Vec<f64>>()
        };
        let x = finite(&found.x);
        let mut lambda: Vec<f64> = finite(&found.z)
            .iter()
            .skip(self.head())
            .take(self.rows)
            .map(|z| -z)
            .collect();
        // Dropped rows are part of the residual and, with ε > 0, the dual point is a multiple of it.
        let factor = if self.tolerance > 0.0 {
            norm(&lambda) / self.tolerance
        } else {
            0.0
        };
        lambda.extend(self.dropped.iter().map(|d| factor * d));
        let residual = norm(&difference(&reduced.target, &times(&reduced.matrix, &x)));
        let residual = residual.hypot(reduced.unreachable);
        let excess = (residual - reduced.tolerance).max(0.0) / nonzero(reduced.tolerance);
        let status = match found.status {
            SolverStatus::CallbackTerminated => Status::Interrupted,
            SolverStatus::Solved if excess <= CONIC.residual => Status::Solved,
            _ => Status::Inaccurate {
                gap: found.gap,
                residual,
            },
        };
        Solution {
            coefficients: reduced.coefficients(&x),
            dual: reduced.dual(&lambda),
            status,
            iterations: found.iterations,
        }
    }
}

#[cfg(test)]
mod tests {
    use sidc_progress::Unwatched;

    use super::super::column_generation::generate_columns;
    use super::*;
    use crate::dictionary::Dictionary;
    use crate::planted::planted;
    use crate::thresholds::COLUMN_GENERATION;
    use sidc_random::Numbers;

    /// From 48 of 900 columns the working set grows by those that violate their bounds, and by no others.
    #[test]
    fn only_columns_that_violate_their_bounds_enter() {
        let (rows, cols) = (12, 900);
        let (dictionary, target) = planted(&mut Numbers(11), (rows, cols), &[10, 890], 0.0);
        let problem = Problem {
            dictionary: &dictionary,
            target: &target,
            tolerance: 0.0,
        };
        let mut sizes = Vec::new();
        let mut steps = 0;
        let found = generate_columns(&problem, |small| {
            sizes.push(small.dictionary.cols());
            let found = Clarabel.solve(small, &mut Unwatched);
            steps += found.iterations;
            found
        });
        assert_eq!(found.status, Status::Solved);
        assert_eq!(found.iterations, steps);
        assert_eq!(
            sizes.first(),
            Some(&(COLUMN_GENERATION.initial_columns * rows))
        );
        assert!(
            sizes.len() > 1 && sizes.is_sorted_by(|a, b| a < b),
            "{sizes:?}"
        );
        assert!(
            sizes
                .windows(2)
                .all(|s| s[1] - s[0] <= COLUMN_GENERATION.added_columns * rows),
            "{sizes:?}"
        );
        assert!(sizes.last().is_some_and(|n| 2 * n < cols), "{sizes:?}");
        let whole = Clarabel.solve(&problem, &mut Unwatched);
        for (j, a) in whole.coefficients.iter().filter(|(_, a)| a.abs() > 1e-6) {
            assert!((found.coefficient(*j) - a).abs() < 1e-6, "{j}");
        }
        assert!(dictionary.price(&found.dual, 1, 0.0).largest() <= 1.0 + 1e-7);
    }
}
