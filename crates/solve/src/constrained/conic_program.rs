//! Constrained basis pursuit on working sets as one conic program for the Clarabel crate.
//!
//! In: blocks and their working sets. Out: coefficients and the dual point on the original rows. Columns and targets have length
//! one; rows of each block are rotated to the left singular vectors, since Clarabel fails on dependent rows.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SecondOrderConeT, SolverStatus,
    SupportedConeT, ZeroConeT,
};
use nalgebra::DMatrix;

use super::problem::{ConstrainedProblem, ConstrainedSolution, LinearConstraint, Outcome, Sense};
use crate::dictionary::unit_columns;
use crate::linalg::{Range, difference, nonzero, norm, quotient, times, times_transposed};
use crate::problem::Problem;
use crate::simd::axpy;
use crate::thresholds::{CERTIFICATES, CONIC};

/// What to minimise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Objective {
    /// The 1-norm, with every block within its tolerance.
    OneNorm,
    /// The sum by which residuals exceed their tolerances.
    Residuals,
}

/// The data of the program.
pub(super) struct ConicProgram<'a> {
    rows: &'a [LinearConstraint],
    blocks: Vec<Block>,
    /// Largest weight of each constraint in scaled coordinates, by which the constraint is divided.
    scales: Vec<f64>,
}

/// One problem on its working set, scaled.
struct Block {
    columns: Vec<usize>,
    lengths: Vec<f64>,
    /// ‖y‖
    target_norm: f64,
    /// ε/‖y‖
    tolerance: f64,
    /// r × n
    matrix: DMatrix<f64>,
    target: Vec<f64>,
    /// M × r
    basis: DMatrix<f64>,
    /// Part of the target that the kept rows do not reach: its length, and as a unit vector.
    unreachable: f64,
    unreachable_direction: Vec<f64>,
}

/// What Clarabel found.
pub(super) struct ConicSolution {
    pub coefficients: Vec<Vec<(usize, f64)>>,
    pub duals: Vec<Vec<f64>>,
    pub multipliers: Vec<f64>,
    /// By how much each block exceeds its tolerance, relative to ‖y‖.
    pub excess: Vec<f64>,
    pub solved: bool,
    pub infeasible: bool,
    pub iterations: usize,
}

impl ConicSolution {
    pub fn solution(&self, outcome: Outcome, iterations: usize) -> ConstrainedSolution {
        ConstrainedSolution {
            coefficients: self.coefficients.clone(),
            duals: self.duals.clone(),
            multipliers: self.multipliers.clone(),
            outcome,
            iterations,
        }
    }
}

impl<'a> ConicProgram<'a> {
    pub fn new(constrained: &'a ConstrainedProblem, sets: &[Vec<usize>]) -> ConicProgram<'a> {
        let blocks = constrained.blocks.iter().zip(sets);
        let mut program = ConicProgram {
            rows: &constrained.rows,
            blocks: blocks.map(|(p, set)| Block::new(p, set)).collect(),
            scales: Vec::new(),
        };
        let rows = constrained.rows.iter();
        program.scales = rows
            .map(|r| {
                let weights = program.scaled(r).into_iter();
                nonzero(weights.fold(0.0, |m: f64, (_, w)| m.max(w.abs())))
            })
            .collect();
        program
    }

    pub fn run(&self, objective: Objective) -> ConicSolution {
        let contradicts = |b: &Block| b.tolerance == 0.0 && b.unreachable > CERTIFICATES.consistent;
        if objective == Objective::OneNorm && self.blocks.iter().any(contradicts) {
            return self.zero(true);
        }
        let mut layout = Layout::new(self, objective);
        self.fill(&mut layout, objective);
        let settings = DefaultSettings {
            verbose: false,
            ..DefaultSettings::default()
        };
        let (matrix, right) = layout.matrix();
        let no_quadratic_term = CscMatrix::zeros((layout.variables, layout.variables));
        let solver = DefaultSolver::new(
            &no_quadratic_term,
            &layout.cost,
            &matrix,
            &right,
            &layout.cones,
            settings,
        );
        let Ok(mut solver) = solver else {
            return self.zero(false);
        };
        solver.solve();
        let found = &solver.solution;
        self.read(&layout, &found.x, &found.z, found.status, found.iterations)
    }

    /// (variable among the x, weight) of a row in scaled coordinates.
    fn scaled(&self, row: &LinearConstraint) -> Vec<(usize, f64)> {
        let entries = row.entries.iter();
        entries
            .filter_map(|(b, column, w)| {
                let block = self.blocks.get(*b)?;
                let k = block.columns.binary_search(column).ok()?;
                let before: usize = self.blocks.iter().take(*b).map(|b| b.columns.len()).sum();
                Some((before + k, w * block.target_norm / block.lengths.get(k)?))
            })
            .collect()
    }

    fn variables(&self) -> usize {
        self.blocks.iter().map(|b| b.columns.len()).sum()
    }

    /// Writes blocks, constraints and bounds, in the order that [`ConicProgram::read`] expects.
    fn fill(&self, layout: &mut Layout, objective: Objective) {
        let n = self.variables();
        let first = layout.first_x;
        let mut at = first;
        for (e, block) in self.blocks.iter().enumerate() {
            let cone = objective == Objective::Residuals || block.tolerance > 0.0;
            if cone {
                let head = layout.row(block.tolerance);
                if objective == Objective::Residuals {
                    layout.put(head, first + n + e, -1.0);
                }
            }
            let start = layout.right.len();
            layout.right.extend_from_slice(&block.target);
            for (k, column) in block.matrix.column_iter().enumerate() {
                for (i, value) in column.iter().enumerate() {
                    layout.put(start + i, at + k, *value);
                }
            }
            let r = block.target.len();
            if cone {
                layout.row(block.unreachable);
                layout.cones.push(SecondOrderConeT(r + 2));
            } else {
                layout.cones.push(ZeroConeT(r));
            }
            at += block.columns.len();
        }
        for equal in [true, false] {
            let rows = self.rows.iter().zip(&self.scales);
            let chosen = rows.filter(|(r, _)| (r.sense == Sense::Equal) == equal);
            let mut count = 0;
            for (row, scale) in chosen {
                let place = layout.row(row.right / scale);
                for (k, w) in self.scaled(row) {
                    layout.put(place, first + k, w / scale);
                }
                count += 1;
            }
            layout.cones.push(if equal {
                ZeroConeT(count)
            } else {
                NonnegativeConeT(count)
            });
        }
        let bounded = if objective == Objective::OneNorm {
            n
        } else {
            0
        };
        for sign in [1.0, -1.0] {
            for k in 0..bounded {
                let place = layout.row(0.0);
                layout.put(place, first + k, sign);
                layout.put(place, k, -1.0);
            }
        }
        if objective == Objective::Residuals {
            for e in 0..self.blocks.len() {
                let place = layout.row(0.0);
                layout.put(place, first + n + e, -1.0);
            }
        }
        let rest = match objective {
            Objective::OneNorm => 2 * n,
            Objective::Residuals => self.blocks.len(),
        };
        layout.cones.push(NonnegativeConeT(rest));
    }

    /// Back to coefficients and dual points of the problem.
    fn read(
        &self,
        layout: &Layout,
        x: &[f64],
        z: &[f64],
        status: SolverStatus,
        iterations: u32,
    ) -> ConicSolution {
        let mut found = self.zero(false);
        found.iterations = iterations as usize;
        found.solved = status == SolverStatus::Solved;
        found.infeasible = matches!(
            status,
            SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible
        );
        let number = |v: &[f64], i: usize| v.get(i).copied().filter(|v| v.is_finite());
        let mut at = layout.first_x;
        let mut row = 0;
        for (e, block) in self.blocks.iter().enumerate() {
            let n = block.columns.len();
            let scaled: Vec<f64> = (at..at + n).map(|i| number(x, i).unwrap_or(0.0)).collect();
            at += n;
            let r = block.target.len();
            let cone = matches!(layout.cones.get(e), Some(SecondOrderConeT(_)));
            row += usize::from(cone);
            let z_data: Vec<f64> = (row..row + r)
                .map(|i| -number(z, i).unwrap_or(0.0))
                .collect();
            row += r;
            let mut lambda = times(&block.basis, &z_data);
            if cone {
                axpy(
                    -number(z, row).unwrap_or(0.0),
                    &block.unreachable_direction,
                    &mut lambda,
                );
                row += 1;
            }
            lambda.iter_mut().for_each(|l| *l /= block.target_norm);
            if let Some(dual) = found.duals.get_mut(e) {
                *dual = lambda;
            }
            if let Some(coefficients) = found.coefficients.get_mut(e) {
                *coefficients = block.raw(&scaled);
            }
            if let Some(excess) = found.excess.get_mut(e) {
                *excess = (block.residual(&scaled) - block.tolerance).max(0.0);
            }
        }
        for equal in [true, false] {
            for ((m, r), scale) in found
                .multipliers
                .iter_mut()
                .zip(self.rows)
                .zip(&self.scales)
            {
                if (r.sense == Sense::Equal) == equal {
                    *m = -number(z, row).unwrap_or(0.0) / scale;
                    row += 1;
                }
            }
        }
        found
    }

    /// No coefficients, and a dual point of zero.
    fn zero(&self, infeasible: bool) -> ConicSolution {
        let blocks = || self.blocks.iter();
        ConicSolution {
            coefficients: blocks().map(|_| Vec::new()).collect(),
            duals: blocks()
                .map(|b| vec![0.0; b.unreachable_direction.len()])
                .collect(),
            multipliers: vec![0.0; self.rows.len()],
            excess: blocks().map(|b| (1.0 - b.tolerance).max(0.0)).collect(),
            solved: false,
            infeasible,
            iterations: 0,
        }
    }
}

impl Block {
    fn new(problem: &Problem, columns: &[usize]) -> Block {
        let dictionary = problem.dictionary;
        let lengths = columns.iter().map(|&j| nonzero(dictionary.norm(j)));
        let lengths: Vec<f64> = lengths.collect();
        let target_norm = nonzero(norm(problem.target));
        let y = quotient(problem.target, target_norm);
        let unit = unit_columns(dictionary, columns, &lengths);
        let range = Range::new(&unit);
        let largest = range.values.first().copied().unwrap_or(0.0);
        let kept = range.values.iter();
        let r = kept
            .take_while(|v| **v > CONIC.singular_value * largest)
            .count();
        let basis = range.basis.columns(0, r).into_owned();
        let project = |v: &[f64]| {
            let inside = times_transposed(&basis, v);
            difference(v, &times(&basis, &inside))
        };
        let mut unreachable_direction = project(&project(&y));
        let unreachable = norm(&unreachable_direction);
        unreachable_direction
            .iter_mut()
            .for_each(|b| *b /= nonzero(unreachable));
        Block {
            columns: columns.to_vec(),
            lengths,
            target_norm,
            tolerance: problem.tolerance / target_norm,
            matrix: basis.transpose() * &unit,
            target: times_transposed(&basis, &y),
            basis,
            unreachable,
            unreachable_direction,
        }
    }

    /// ‖P x − q‖, the unreachable part included.
    fn residual(&self, x: &[f64]) -> f64 {
        norm(&difference(&self.target, &times(&self.matrix, x))).hypot(self.unreachable)
    }

    fn raw(&self, x: &[f64]) -> Vec<(usize, f64)> {
        let scaled = self.columns.iter().zip(&self.lengths).zip(x);
        scaled
            .map(|((j, length), x)| (*j, x * self.target_norm / length))
            .filter(|(_, a)| a.is_finite() && *a != 0.0)
            .collect()
    }
}

/// The matrix of the program while it is assembled: variables (u, x) or (x, t), entries by column.
struct Layout {
    variables: usize,
    first_x: usize,
    cost: Vec<f64>,
    cones: Vec<SupportedConeT<f64>>,
    right: Vec<f64>,
    columns: Vec<Vec<(usize, f64)>>,
}

impl Layout {
    fn new(program: &ConicProgram, objective: Objective) -> Layout {
        let (n, blocks) = (program.variables(), program.blocks.len());
        let (first_x, extra) = match objective {
            Objective::OneNorm => (n, 0),
            Objective::Residuals => (0, blocks),
        };
        let mut cost = vec![1.0; first_x];
        cost.resize(first_x + n, 0.0);
        cost.resize(first_x + n + extra, 1.0);
        Layout {
            variables: cost.len(),
            first_x,
            columns: vec![Vec::new(); cost.len()],
            cost,
            cones: Vec::new(),
            right: Vec::new(),
        }
    }

    /// Adds a row with its right side; returns its index.
    fn row(&mut self, right: f64) -> usize {
        self.right.push(right);
        self.right.len() - 1
    }

    fn put(&mut self, row: usize, variable: usize, value: f64) {
        if let Some(column) = self.columns.get_mut(variable) {
            column.push((row, value));
        }
    }

    fn matrix(&mut self) -> (CscMatrix<f64>, Vec<f64>) {
        let (mut starts, mut places, mut values) = (vec![0], Vec::new(), Vec::new());
        for column in &mut self.columns {
            column.sort_unstable_by_key(|(row, _)| *row);
            places.extend(column.iter().map(|(row, _)| *row));
            values.extend(column.iter().map(|(_, value)| *value));
            starts.push(places.len());
        }
        let rows = self.right.len();
        let matrix = CscMatrix::new(rows, self.variables, starts, places, values);
        (matrix, self.right.clone())
    }
}
