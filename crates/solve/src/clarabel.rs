//! A second, independent solver: the problem as a cone programme for the Clarabel crate.
//!
//! `min Σu s.t. −u ≤ x ≤ u, P x = q` (or ‖P x − q‖ ≤ ε as a second-order cone), u before x, which keeps its factor sparse.
//! Clarabel fails on numerically dependent rows, so they are first reduced by a singular value decomposition. Here to
//! check the default solver against, not for speed.

use std::sync::{Mutex, mpsc};

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultInfo, DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SecondOrderConeT,
    SolverStatus, ZeroConeT,
};

use sidc_progress::{Observer, SolverProgress};

use super::frame::solve_reduced;
use super::reduce::{Reduced, minus, nonzero, norm, times};
use super::{Problem, Solution, Solver, Status};

/// Rows kept: singular values above this part of the largest.
const ROWS: f64 = 1e-9;
/// Residual, to ‖y‖ or beyond ε, up to which Clarabel's "solved" is believed.
const BELIEVED: f64 = 1e-6;

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
        solve_reduced(problem, |reduced, tolerance| {
            let programme = Programme::new(reduced, tolerance);
            let end = programme.run(observer)?;
            Some(programme.read(reduced, &end))
        })
    }
}

/// The cone programme's data: the strongest rows of P and their right-hand side.
struct Programme {
    rows: usize,
    cols: usize,
    /// Column-major rows × cols.
    values: Vec<f64>,
    target: Vec<f64>,
    /// What the dropped rows hold of q.
    dropped: Vec<f64>,
    /// ε of the kept rows; zero for equality.
    tolerance: f64,
}

/// What Clarabel returns.
struct End {
    x: Vec<f64>,
    z: Vec<f64>,
    status: SolverStatus,
    iterations: usize,
    gap: f64,
}

impl Programme {
    fn new(reduced: &Reduced, inner: f64) -> Programme {
        let strongest = reduced.strengths.first().copied().unwrap_or(0.0);
        let rows = reduced
            .strengths
            .iter()
            .take_while(|s| **s > ROWS * strongest)
            .count();
        let kept = reduced.matrix.rows(0, rows);
        let (target, dropped) = reduced.target.split_at(rows);
        let left = norm(dropped);
        Programme {
            rows,
            cols: kept.ncols(),
            values: kept.iter().copied().collect(),
            target: target.to_vec(),
            dropped: dropped.to_vec(),
            tolerance: ((inner - left) * (inner + left)).max(0.0).sqrt(),
        }
    }

    /// Constraint matrix over (u, x): data rows, then x − u ≤ 0 and −x − u ≤ 0. A cone has one more row, its head.
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

    /// Runs Clarabel on a thread of its own, which asks the observer after each iteration; `None` if it fails to start.
    fn run(&self, observer: &mut dyn Observer) -> Option<End> {
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
            // No threads there, so nobody is asked.
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
    ) -> Option<End> {
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
        Some(End {
            x: solver.solution.x.iter().skip(n).copied().collect(),
            z: solver.solution.z.clone(),
            status: solver.solution.status,
            iterations: solver.solution.iterations as usize,
            gap: solver.info.gap_rel,
        })
    }

    /// Back to the original rows and units; Clarabel's word is checked against the residual it left.
    fn read(&self, reduced: &Reduced, end: &End) -> Solution {
        let finite = |v: &[f64]| {
            v.iter()
                .map(|x| if x.is_finite() { *x } else { 0.0 })
                .collect::<Vec<f64>>()
        };
        let x = finite(&end.x);
        let mut lambda: Vec<f64> = finite(&end.z)
            .iter()
            .skip(self.head())
            .take(self.rows)
            .map(|z| -z)
            .collect();
        // Dropped rows are part of the residual, and with a noise bound the dual is its multiple.
        let share = if self.tolerance > 0.0 {
            norm(&lambda) / self.tolerance
        } else {
            0.0
        };
        lambda.extend(self.dropped.iter().map(|d| share * d));
        let residual = norm(&minus(&reduced.target, &times(&reduced.matrix, &x)));
        let residual = residual.hypot(reduced.leftover);
        let excess = (residual - reduced.tolerance).max(0.0) / nonzero(reduced.tolerance);
        let status = match end.status {
            SolverStatus::CallbackTerminated => Status::Interrupted,
            SolverStatus::Solved if excess <= BELIEVED => Status::Solved,
            _ => Status::Inaccurate {
                gap: end.gap,
                residual,
            },
        };
        Solution {
            coefficients: reduced.coefficients(&x),
            dual: reduced.dual(&lambda),
            status,
            iterations: end.iterations,
        }
    }
}
