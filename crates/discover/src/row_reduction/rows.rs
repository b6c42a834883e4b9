//! The rows of equations on one part of a table, reduced. Equations with the same terms share their columns.
//!
//! In: samples, the targets of equations and their libraries. Out: a factor for each.

use nalgebra::DMatrix;
use sidc_data::{Column, Origin, Samples};
use sidc_lang::library::Library;
use sidc_lang::term::{Signal, Term};
use sidc_solve::linalg::Qr;

use crate::dictionary::{BadValue, compile};
use crate::regression::task::target_values;
use crate::row_reduction::factor::{Factor, triangle_below};
use crate::row_reduction::thresholds::ROW_REDUCTION;
use crate::row_weights::Weights;
use crate::statistics::product;

/// An equation with its target on all rows.
pub(super) struct EquationRows<'a> {
    pub place: usize,
    library: &'a Library,
    /// The target minus its known terms, length M.
    y: Vec<f64>,
    /// Length M, as regression weighs them.
    weights: Vec<f64>,
    estimated: bool,
}

impl<'a> EquationRows<'a> {
    pub fn new(
        (place, target): (usize, Signal),
        known: &[(f64, Term)],
        library: &'a Library,
        samples: &Samples,
    ) -> EquationRows<'a> {
        let y = target_values(target, known, samples);
        let estimated = |c: &Column| matches!(c.origin, Origin::Estimated { .. });
        EquationRows {
            place,
            library,
            weights: Weights::new(samples, target, library, &y).row,
            estimated: samples.column(target).is_some_and(estimated),
            y,
        }
    }

    /// Whether both have the same columns.
    fn shares_columns(&self, other: &EquationRows) -> bool {
        let (own, others) = (self.library, other.library);
        own.slots() == others.slots()
            && self.weights == other.weights
            && (0..own.slots()).all(|j| {
                own.is_empty_slot(j) == others.is_empty_slot(j) && own.term(j) == others.term(j)
            })
    }
}

/// Equations in groups that share their columns.
pub(super) fn groups<'a>(
    equations: impl Iterator<Item = EquationRows<'a>>,
) -> Vec<Vec<EquationRows<'a>>> {
    let mut groups: Vec<Vec<EquationRows>> = Vec::new();
    for equation in equations {
        let like = |group: &&mut Vec<EquationRows>| {
            let first = group.first();
            first.is_some_and(|first| first.shares_columns(&equation))
        };
        match groups.iter_mut().find(like) {
            Some(group) => group.push(equation),
            None => groups.push(vec![equation]),
        }
    }
    groups
}

/// The factors of a group, in its order: the columns of all are factorised at once, [Φ y₁ y₂ …].
///
/// # Errors
/// A term without a finite value.
pub(super) fn factors(
    group: &[EquationRows],
    samples: &Samples,
) -> Result<Vec<Factor>, Box<BadValue>> {
    let Some(EquationRows {
        library, weights, ..
    }) = group.first()
    else {
        return Ok(Vec::new());
    };
    let (terms, width) = (library.slots(), library.slots() + group.len());
    let most = ROW_REDUCTION.block_rows;
    let most = most.max(ROW_REDUCTION.blocks_of_terms * width);
    let mut triangle = DMatrix::zeros(width, width);
    for first in (0..samples.len()).step_by(most) {
        let end = samples.len().min(first + most);
        let rows: Vec<usize> = (first..end).collect();
        let weights = &weights[first..end];
        let phi = compile(library, &samples.select(&rows), Some(weights));
        let phi = phi.map_err(|mut bad| {
            bad.row += first;
            bad
        })?;
        let mut columns = vec![0.0; rows.len() * width];
        for (j, column) in columns.chunks_exact_mut(rows.len()).enumerate() {
            match j.checked_sub(terms) {
                Some(k) => column.copy_from_slice(&product(&group[k].y[first..end], weights)),
                None if library.is_empty_slot(j) => {}
                None => phi.column(j, column),
            }
        }
        triangle = triangle_below(&triangle, &DMatrix::from_vec(rows.len(), width, columns));
    }
    let own = |(k, equation): (usize, &EquationRows)| {
        let columns: Vec<usize> = (0..terms).chain([terms + k]).collect();
        let r = Qr::new(triangle.select_columns(&columns)).r;
        let estimated = if equation.estimated { samples.len() } else { 0 };
        Factor::new(samples.len(), estimated, r)
    };
    Ok(group.iter().enumerate().map(own).collect())
}
