//! Least squares on chosen columns of several blocks under the rows that tie them.
//!
//! In: each block's columns, target and weight, a support, rows. Out: coefficients that obey the rows to rounding, what is left of
//! the targets, which inequalities the answer presses against. Columns off the support have coefficient zero in every row.

use nalgebra::DMatrix;

use super::super::polish::Pivoted;
use super::super::reduce::{add_scaled, minus, nonzero, norm, times};
use super::eliminate::{Plane, Solutions, eliminate};
use super::least_distance::{HalfSpace, least_distance};
use super::{Row, Sense};

/// By how much an inequality may be missed, relative to its largest summand.
const MISSED: f64 = 1e-10;
/// Multiplier, relative to the largest, that counts as pressing.
const PRESSING: f64 = 1e-9;

/// Candidate columns of one block, possibly rotated to fewer rows.
pub struct FitBlock {
    /// Column of the dictionary that each column here is, rising.
    pub columns: Vec<usize>,
    /// Raw values, rows × columns.
    pub values: DMatrix<f64>,
    pub target: Vec<f64>,
    /// Squared length of what the rotation cut off the target.
    pub outside: f64,
    /// What a unit of this block's squared residual counts: 1/σ² of a row.
    pub weight: f64,
    /// σ² of a row that standard errors go by.
    pub variance: f64,
}

/// A constrained fit.
#[derive(Clone, Debug)]
pub struct Fit {
    /// For each block, one coefficient for each column of the support, raw units.
    pub values: Vec<Vec<f64>>,
    /// ‖Φ_e a_e − y_e‖² of each block.
    pub squares: Vec<f64>,
    /// Dimensions in which the coefficients were free to move.
    pub parameters: usize,
    /// Inequalities that hold with equality against the data's pull, by their place among the rows.
    pub pressing: Vec<usize>,
    /// In the arrangement of `values`.
    pub standard_errors: Vec<Vec<f64>>,
}

/// `min Σ_e weight_e ‖Φ_e a_e − y_e‖² s.t. rows`, a zero off `support` (columns of each block, rising).
///
/// Equations among coefficients are eliminated (Golub & Van Loan, section 6.2), inequalities found by least distance, and those
/// that bind are eliminated too, so that they hold to rounding. `None` if the rows cannot be obeyed on this support.
pub fn fit(blocks: &[FitBlock], support: &[Vec<usize>], rows: &[Row]) -> Option<Fit> {
    let system = System::new(blocks, support, rows);
    let equal: Vec<&Plane> = system.equal.iter().collect();
    let mut state = system.solve(&equal)?;
    let mut pressing = Vec::new();
    if !system.obeyed(&state.z) {
        let multipliers = system.push(&state)?;
        let largest = multipliers.iter().copied().fold(0.0, f64::max);
        let binds = |m: &f64| *m > PRESSING * largest;
        pressing = (0..multipliers.len())
            .filter(|&k| binds(&multipliers[k]))
            .collect();
        let mut planes = equal;
        planes.extend(pressing.iter().map(|&k| &system.below[k].1));
        state = system.solve(&planes)?;
        if !system.obeyed(&state.z) {
            return None;
        }
    }
    let pressing = pressing.iter().map(|&k| system.below[k].0).collect();
    Some(system.read(&state, pressing))
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
    blocks: &'a [FitBlock],
    variables: Vec<Variable>,
    matrix: DMatrix<f64>,
    target: Vec<f64>,
    equal: Vec<Plane>,
    /// Inequalities with their places among the rows.
    below: Vec<(usize, Plane)>,
    groups: Vec<usize>,
}

/// A least-squares solution with some planes taken as equations.
struct State {
    z: Vec<f64>,
    solutions: Solutions,
    reduced: Option<Pivoted>,
}

impl<'a> System<'a> {
    fn new(blocks: &'a [FitBlock], support: &[Vec<usize>], rows: &[Row]) -> System<'a> {
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
        let rows_before: Vec<usize> = blocks
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
                matrix[(rows_before[v.block] + i, k)] = value * factor;
            }
        }
        let weighted = |b: &FitBlock| {
            let root = b.weight.sqrt();
            b.target.iter().map(move |y| y * root).collect::<Vec<_>>()
        };
        let mut system = System {
            blocks,
            target: blocks.iter().flat_map(weighted).collect(),
            matrix,
            equal: Vec::new(),
            below: Vec::new(),
            groups: rows_before,
            variables,
        };
        for (k, row) in rows.iter().enumerate() {
            let plane = system.plane(row);
            match row.sense {
                Sense::Equal => system.equal.push(plane),
                Sense::AtMost | Sense::Below => system.below.push((k, plane)),
            }
        }
        system
    }

    /// A row in the variables z; places off the support are zero.
    fn plane(&self, row: &Row) -> Plane {
        let weight = |v: &Variable| {
            let own = row.entries.iter();
            let own = own.filter(|(b, c, _)| *b == v.block && *c == v.column);
            own.map(|(_, _, w)| w).sum::<f64>() / v.scale
        };
        Plane {
            weights: self.variables.iter().map(weight).collect(),
            right: row.right,
        }
    }

    fn obeyed(&self, z: &[f64]) -> bool {
        let mut planes = self.below.iter().map(|(_, p)| p);
        planes.all(|p| p.left(z) - p.right <= MISSED * p.largest(z))
    }

    /// Least squares with these planes as equations.
    fn solve(&self, planes: &[&Plane]) -> Option<State> {
        let solutions = eliminate(self.variables.len(), planes)?;
        let moved = &self.matrix * &solutions.matrix;
        let start = times(&self.matrix, &solutions.constant);
        let aim = minus(&self.target, &start);
        let reduced = Pivoted::new(&moved);
        let mut z = solutions.constant.clone();
        if let Some(fit) = &reduced {
            let mut u = fit.solve(&aim);
            let rest = minus(&aim, &times(&moved, &u));
            add_scaled(&mut u, 1.0, &fit.solve(&rest));
            add_scaled(&mut z, 1.0, &times(&solutions.matrix, &u));
        }
        Some(State {
            z,
            solutions,
            reduced,
        })
    }

    /// Multipliers of the inequalities at the constrained optimum: the least move of the fitted values that obeys them.
    fn push(&self, state: &State) -> Option<Vec<f64>> {
        let spaces: Vec<HalfSpace> = self
            .below
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
                    height: plane.left(&state.z) - plane.right,
                }
            })
            .collect();
        least_distance(&spaces)
    }

    fn read(&self, state: &State, pressing: Vec<usize>) -> Fit {
        let errors = self.standard_errors(state);
        let mut values = vec![Vec::new(); self.blocks.len()];
        let mut standard_errors = values.clone();
        for ((v, z), e) in self.variables.iter().zip(&state.z).zip(errors) {
            values[v.block].push(z / v.scale);
            standard_errors[v.block].push(e / v.scale);
        }
        let rest = minus(&self.target, &times(&self.matrix, &state.z));
        let squares = self.blocks.iter().zip(&self.groups).map(|(b, &first)| {
            let own = rest.get(first..first + b.target.len()).unwrap_or_default();
            norm(own).powi(2) / b.weight + b.outside
        });
        Fit {
            squares: squares.collect(),
            values,
            standard_errors,
            parameters: state.reduced.as_ref().map_or(0, |f| f.rank),
            pressing,
        }
    }

    /// √ of the diagonal of T R⁻¹ S R⁻ᵀ Tᵀ, S the scatter of the blocks' rows (the sandwich of White 1980, by block).
    fn standard_errors(&self, state: &State) -> Vec<f64> {
        let Some(fit) = &state.reduced else {
            return vec![0.0; state.z.len()];
        };
        (0..state.z.len())
            .map(|k| {
                let row: Vec<f64> = state.solutions.matrix.row(k).iter().copied().collect();
                // Q R⁻ᵀ t: its part in each block's rows meets that block's scatter.
                let reach = fit.least_norm(&row);
                let square = self.blocks.iter().zip(&self.groups).map(|(b, &first)| {
                    let own = reach.get(first..first + b.target.len()).unwrap_or_default();
                    norm(own).powi(2) * b.variance * b.weight
                });
                square.sum::<f64>().sqrt()
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(columns: &[&[f64]], target: &[f64]) -> FitBlock {
        FitBlock {
            columns: (0..columns.len()).collect(),
            values: DMatrix::from_fn(target.len(), columns.len(), |i, j| columns[j][i]),
            target: target.to_vec(),
            outside: 0.0,
            weight: 1.0,
            variance: 1.0,
        }
    }

    fn row(entries: &[(usize, usize, f64)], sense: Sense, right: f64) -> Row {
        Row {
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
        let found = fit(&blocks, &[vec![0], vec![0]], &[tie]).unwrap();
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
    fn a_sign_that_binds_presses_and_moves_the_others() {
        let blocks = [block(
            &[&[1.0, 0.0, 1.0], &[0.0, 1.0, 1.0]],
            &[3.0, -1.0, 2.0],
        )];
        let positive = row(&[(0, 1, -1.0)], Sense::Below, 0.0);
        let found = fit(&blocks, &[vec![0, 1]], std::slice::from_ref(&positive)).unwrap();
        assert_eq!(found.pressing, vec![0]);
        assert_eq!(found.values[0][1], 0.0);
        assert!((found.values[0][0] - 2.5).abs() < 1e-14);
        let negative = row(&[(0, 1, 1.0)], Sense::Below, 0.0);
        let free = fit(&blocks, &[vec![0, 1]], &[negative]).unwrap();
        assert!(free.pressing.is_empty() && (free.values[0][1] + 1.0).abs() < 1e-14);
    }

    #[test]
    fn rows_that_the_support_cannot_obey_give_nothing() {
        let blocks = [block(&[&[1.0, 0.0], &[0.0, 1.0]], &[1.0, 1.0])];
        let fixed = row(&[(0, 1, 1.0)], Sense::Equal, 2.0);
        assert!(fit(&blocks, &[vec![0]], std::slice::from_ref(&fixed)).is_none());
        let found = fit(&blocks, &[vec![0, 1]], &[fixed]).unwrap();
        assert_eq!(found.values[0], vec![1.0, 2.0]);
        assert_eq!(found.standard_errors[0][1], 0.0);
    }
}
