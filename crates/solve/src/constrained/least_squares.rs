//! Least squares on a support of several blocks under linear equations and inequalities.
//!
//! In: each block's columns, target and weight, a support, constraints. Out: coefficients that satisfy the constraints to rounding,
//! residuals, active inequalities. Columns off the support have coefficient zero in every constraint.

use nalgebra::DMatrix;

use super::elimination::{Hyperplane, SolutionSpace, eliminate};
use super::least_distance::{HalfSpace, least_distance};
use super::problem::{LinearConstraint, Sense};
use crate::linalg::{RankRevealingQr, difference, nonzero, norm, times};
use crate::simd::axpy;
use crate::thresholds::LINEAR_CONSTRAINTS;

/// Candidate columns of one block, possibly rotated to fewer rows.
pub struct RegressionBlock {
    /// Index in the dictionary of each column, rising.
    pub columns: Vec<usize>,
    /// Raw values, rows × columns.
    pub values: DMatrix<f64>,
    pub target: Vec<f64>,
    /// Squared length of the part of the target that the rotation dropped.
    pub outside: f64,
    /// Weight of this block's squared residual: 1/σ² of a row.
    pub weight: f64,
    /// σ² of a row, for standard errors.
    pub variance: f64,
}

/// The least squares of a support under constraints.
#[derive(Clone, Debug)]
pub struct ConstrainedFit {
    /// For each block, one coefficient for each column of the support, raw units.
    pub values: Vec<Vec<f64>>,
    /// ‖Φ_e a_e − y_e‖² of each block.
    pub squares: Vec<f64>,
    /// Degrees of freedom of the coefficients.
    pub parameters: usize,
    /// Active inequalities: those with a positive multiplier, by their place among the constraints.
    pub active: Vec<usize>,
    /// Arranged like `values`.
    pub standard_errors: Vec<Vec<f64>>,
}

/// `min Σ_e weight_e ‖Φ_e a_e − y_e‖² s.t. rows`, a zero off `support` (columns of each block, rising).
///
/// Equations are eliminated (Golub & Van Loan, section 6.2). The active inequalities are found by least distance programming and
/// eliminated too, so that they hold to rounding. `None` if the constraints cannot be satisfied on this support.
pub fn constrained_least_squares(
    blocks: &[RegressionBlock],
    support: &[Vec<usize>],
    rows: &[LinearConstraint],
) -> Option<ConstrainedFit> {
    let system = System::new(blocks, support, rows);
    let equations: Vec<&Hyperplane> = system.equations.iter().collect();
    let mut state = system.solve(&equations)?;
    let mut active = Vec::new();
    if !system.satisfied(&state.z) {
        let multipliers = system.multipliers(&state)?;
        let largest = multipliers.iter().copied().fold(0.0, f64::max);
        let is_active = |m: &f64| *m > LINEAR_CONSTRAINTS.active * largest;
        active = (0..multipliers.len())
            .filter(|&k| is_active(&multipliers[k]))
            .collect();
        let mut planes = equations;
        planes.extend(active.iter().map(|&k| &system.inequalities[k].1));
        state = system.solve(&planes)?;
        if !system.satisfied(&state.z) {
            return None;
        }
    }
    let active = active.iter().map(|&k| system.inequalities[k].0).collect();
    Some(system.read(&state, active))
}

/// One coefficient to fit.
struct Variable {
    block: usize,
    column: usize,
    /// Place among the block's columns.
    place: usize,
    /// z = scale · a
    scale: f64,
}

/// The weighted problem in variables z that stand for unit columns.
struct System<'a> {
    blocks: &'a [RegressionBlock],
    variables: Vec<Variable>,
    matrix: DMatrix<f64>,
    target: Vec<f64>,
    equations: Vec<Hyperplane>,
    /// Inequalities with their places among the constraints.
    inequalities: Vec<(usize, Hyperplane)>,
    first_rows: Vec<usize>,
}

/// A least-squares solution with some inequalities taken as equations.
struct EliminatedFit {
    z: Vec<f64>,
    solutions: SolutionSpace,
    reduced: Option<RankRevealingQr>,
}

impl<'a> System<'a> {
    fn new(
        blocks: &'a [RegressionBlock],
        support: &[Vec<usize>],
        rows: &[LinearConstraint],
    ) -> System<'a> {
        let mut variables = Vec::new();
        for (b, (block, columns)) in blocks.iter().zip(support).enumerate() {
            for &column in columns {
                if let Ok(place) = block.columns.binary_search(&column) {
                    let length = block.values.column(place).norm();
                    variables.push(Variable {
                        block: b,
                        column,
                        place,
                        scale: block.weight.sqrt() * nonzero(length),
                    });
                }
            }
        }
        let first_rows: Vec<usize> = blocks
            .iter()
            .scan(0, |sum, b| {
                let before = *sum;
                *sum += b.target.len();
                Some(before)
            })
            .collect();
        let total: usize = blocks.iter().map(|b| b.target.len()).sum();
        let mut matrix = DMatrix::zeros(total, variables.len());
        for (k, v) in variables.iter().enumerate() {
            let block = &blocks[v.block];
            let factor = block.weight.sqrt() / v.scale;
            for (i, value) in block.values.column(v.place).iter().enumerate() {
                matrix[(first_rows[v.block] + i, k)] = value * factor;
            }
        }
        let weighted = |b: &RegressionBlock| {
            let root = b.weight.sqrt();
            b.target.iter().map(move |y| y * root).collect::<Vec<_>>()
        };
        let mut system = System {
            blocks,
            target: blocks.iter().flat_map(weighted).collect(),
            matrix,
            equations: Vec::new(),
            inequalities: Vec::new(),
            first_rows,
            variables,
        };
        for (k, row) in rows.iter().enumerate() {
            let plane = system.hyperplane(row);
            match row.sense {
                Sense::Equal => system.equations.push(plane),
                Sense::AtMost | Sense::Below => system.inequalities.push((k, plane)),
            }
        }
        system
    }

    /// A constraint in the variables z; columns off the support are zero.
    fn hyperplane(&self, row: &LinearConstraint) -> Hyperplane {
        let weight = |v: &Variable| {
            let entries = row.entries.iter();
            let entries = entries.filter(|(b, c, _)| *b == v.block && *c == v.column);
            entries.map(|(_, _, w)| w).sum::<f64>() / v.scale
        };
        Hyperplane {
            weights: self.variables.iter().map(weight).collect(),
            right: row.right,
        }
    }

    fn satisfied(&self, z: &[f64]) -> bool {
        let mut planes = self.inequalities.iter().map(|(_, p)| p);
        planes.all(|p| p.value(z) - p.right <= LINEAR_CONSTRAINTS.violation * p.largest_summand(z))
    }

    /// Least squares with these hyperplanes as equations.
    fn solve(&self, planes: &[&Hyperplane]) -> Option<EliminatedFit> {
        let solutions = eliminate(self.variables.len(), planes)?;
        let free_columns = &self.matrix * &solutions.matrix;
        let fixed = times(&self.matrix, &solutions.constant);
        let free_target = difference(&self.target, &fixed);
        let reduced = RankRevealingQr::new(&free_columns);
        let mut z = solutions.constant.clone();
        if let Some(fit) = &reduced {
            let mut u = fit.solve(&free_target);
            let rest = difference(&free_target, &times(&free_columns, &u));
            axpy(1.0, &fit.solve(&rest), &mut u);
            axpy(1.0, &times(&solutions.matrix, &u), &mut z);
        }
        Some(EliminatedFit {
            z,
            solutions,
            reduced,
        })
    }

    /// Multipliers of the inequalities at the constrained optimum: the least change of the fitted values that satisfies them.
    fn multipliers(&self, state: &EliminatedFit) -> Option<Vec<f64>> {
        let spaces: Vec<HalfSpace> = self
            .inequalities
            .iter()
            .map(|(_, plane)| {
                let slope: Vec<f64> = state
                    .solutions
                    .matrix
                    .column_iter()
                    .map(|t| t.iter().zip(&plane.weights).map(|(t, w)| t * w).sum())
                    .collect();
                let normal = match &state.reduced {
                    Some(fit) => fit.least_norm(&slope),
                    None => Vec::new(),
                };
                HalfSpace {
                    normal: normal.iter().map(|g| -g).collect(),
                    height: plane.value(&state.z) - plane.right,
                }
            })
            .collect();
        least_distance(&spaces)
    }

    fn read(&self, state: &EliminatedFit, active: Vec<usize>) -> ConstrainedFit {
        let errors = self.standard_errors(state);
        let mut values = vec![Vec::new(); self.blocks.len()];
        let mut standard_errors = values.clone();
        for ((v, z), e) in self.variables.iter().zip(&state.z).zip(errors) {
            values[v.block].push(z / v.scale);
            standard_errors[v.block].push(e / v.scale);
        }
        let rest = difference(&self.target, &times(&self.matrix, &state.z));
        let squares = self.blocks.iter().zip(&self.first_rows).map(|(b, &first)| {
            let part = rest.get(first..first + b.target.len()).unwrap_or_default();
            norm(part).powi(2) / b.weight + b.outside
        });
        ConstrainedFit {
            squares: squares.collect(),
            values,
            standard_errors,
            parameters: state.reduced.as_ref().map_or(0, |f| f.rank),
            active,
        }
    }

    /// √ of the diagonal of T R⁻¹ S R⁻ᵀ Tᵀ, S the variances of the blocks' rows (the sandwich covariance of White 1980, by block).
    fn standard_errors(&self, state: &EliminatedFit) -> Vec<f64> {
        let Some(fit) = &state.reduced else {
            return vec![0.0; state.z.len()];
        };
        (0..state.z.len())
            .map(|k| {
                let row: Vec<f64> = state.solutions.matrix.row(k).iter().copied().collect();
                // Q R⁻ᵀ t, whose part in a block's rows is weighted with the variance of that block.
                let influence = fit.least_norm(&row);
                let square = self.blocks.iter().zip(&self.first_rows).map(|(b, &first)| {
                    let part = influence
                        .get(first..first + b.target.len())
                        .unwrap_or_default();
                    norm(part).powi(2) * b.variance * b.weight
                });
                square.sum::<f64>().sqrt()
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(columns: &[&[f64]], target: &[f64]) -> RegressionBlock {
        RegressionBlock {
            columns: (0..columns.len()).collect(),
            values: DMatrix::from_fn(target.len(), columns.len(), |i, j| columns[j][i]),
            target: target.to_vec(),
            outside: 0.0,
            weight: 1.0,
            variance: 1.0,
        }
    }

    fn row(entries: &[(usize, usize, f64)], sense: Sense, right: f64) -> LinearConstraint {
        LinearConstraint {
            entries: entries.to_vec(),
            sense,
            right,
        }
    }

    #[test]
    fn two_equations_share_one_number() {
        // y = a x measured twice, 1 and 3 at x = 1: the mean.
        let blocks = [block(&[&[1.0]], &[1.0]), block(&[&[1.0]], &[3.0])];
        let tie = row(&[(0, 0, 1.0), (1, 0, -1.0)], Sense::Equal, 0.0);
        let found = constrained_least_squares(&blocks, &[vec![0], vec![0]], &[tie]).unwrap();
        assert!((found.values[0][0] - 2.0).abs() < 1e-15);
        assert_eq!(found.values[0], found.values[1]);
        assert_eq!(
            (found.parameters, found.squares.clone()),
            (1, vec![1.0, 1.0])
        );
        // The mean of two has half the variance of one.
        assert!((found.standard_errors[0][0] - 0.5_f64.sqrt()).abs() < 1e-14);
    }

    #[test]
    fn an_active_sign_changes_the_others() {
        let blocks = [block(
            &[&[1.0, 0.0, 1.0], &[0.0, 1.0, 1.0]],
            &[3.0, -1.0, 2.0],
        )];
        let positive = row(&[(0, 1, -1.0)], Sense::Below, 0.0);
        let found =
            constrained_least_squares(&blocks, &[vec![0, 1]], std::slice::from_ref(&positive))
                .unwrap();
        assert_eq!(found.active, vec![0]);
        assert_eq!(found.values[0][1], 0.0);
        assert!((found.values[0][0] - 2.5).abs() < 1e-14);
        let negative = row(&[(0, 1, 1.0)], Sense::Below, 0.0);
        let free = constrained_least_squares(&blocks, &[vec![0, 1]], &[negative]).unwrap();
        assert!(free.active.is_empty() && (free.values[0][1] + 1.0).abs() < 1e-14);
    }

    #[test]
    fn constraints_that_the_support_cannot_satisfy_give_none() {
        let blocks = [block(&[&[1.0, 0.0], &[0.0, 1.0]], &[1.0, 1.0])];
        let fixed = row(&[(0, 1, 1.0)], Sense::Equal, 2.0);
        assert!(
            constrained_least_squares(&blocks, &[vec![0]], std::slice::from_ref(&fixed)).is_none()
        );
        let found = constrained_least_squares(&blocks, &[vec![0, 1]], &[fixed]).unwrap();
        assert_eq!(found.values[0], vec![1.0, 2.0]);
        assert_eq!(found.standard_errors[0][1], 0.0);
    }
}
