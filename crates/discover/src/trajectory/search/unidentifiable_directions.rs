//! Parameters that the readings do not determine: coefficients and unknown constants that can change together without a change of any
//! reading.
//!
//! In: a problem with hidden states, a fit, the constants. Out: for each such direction the parameters with the powers by which they move. Judges by
//! the likelihood linearised along the data (local identifiability by sensitivities; Stigter & Molenaar, Automatica 2015).

use nalgebra::DMatrix;

use super::unknown_constants::{SoughtConstant, with_columns, with_sensitivities};
use crate::trajectory::integration::CompiledLaws;
use crate::trajectory::least_squares::IncrementalQr;
use crate::trajectory::likelihood::{EliminatedRecords, Fit};
use crate::trajectory::model::{ExtendedProblem, Problem};
use crate::trajectory::structural::thresholds::PRACTICAL;
use sidc_progress::Observer;

/// A number that was estimated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// The coefficient of a column.
    Coefficient(usize),
    /// A constant, by its place among those sought.
    Constant(usize),
}

/// Directions in which parameters can change by as much as they are, while no reading changes by more than its noise. For each, the
/// parameters with their relative changes; the largest is 1. Empty where there are none, or they cannot be computed.
pub fn unidentifiable_directions(
    problem: &Problem,
    found: &Fit,
    constants: &[SoughtConstant],
    inefficiency: f64,
    observer: &mut dyn Observer,
) -> Vec<Vec<(Parameter, f64)>> {
    let changes = relative_changes(problem, found, constants, observer);
    let Some((parameters, changes)) = changes else {
        return Vec::new();
    };
    let decomposed = changes.svd(false, true);
    let Some(directions) = decomposed.v_t else {
        return Vec::new();
    };
    let largest = decomposed.singular_values.max();
    let told = (PRACTICAL.unseen * inefficiency.sqrt()).max(PRACTICAL.rounding * largest);
    let singular = decomposed.singular_values.iter().enumerate();
    let unidentifiable = singular.filter(|(_, size)| **size < told);
    let all = unidentifiable.map(|(row, _)| {
        let moves: Vec<f64> = directions.row(row).iter().copied().collect();
        let largest = moves
            .iter()
            .copied()
            .fold(0.0, |m: f64, x| if x.abs() > m.abs() { x } else { m });
        let each = parameters
            .iter()
            .zip(&moves)
            .map(|(p, x)| (*p, x / largest));
        each.filter(|(_, x)| x.abs() > PRACTICAL.part)
            .collect::<Vec<_>>()
    });
    all.collect()
}

/// The parameter of a column of a problem with sensitivities, and the weight that the column is divided by.
pub(super) fn parameter_of(
    column: usize,
    extended: &ExtendedProblem,
    (new, owners): (&[usize], &[(usize, f64)]),
) -> Option<(Parameter, f64)> {
    if let Some(own) = extended.origin[column] {
        return Some((Parameter::Coefficient(own), 1.0));
    }
    let (constant, weight) = owners[new.iter().position(|n| *n == column)?];
    Some((Parameter::Constant(constant), weight))
}

/// A triangular matrix; column j is the change of the readings, in standard deviations, when parameter j changes by its own size.
fn relative_changes(
    problem: &Problem,
    found: &Fit,
    constants: &[SoughtConstant],
    observer: &mut dyn Observer,
) -> Option<(Vec<Parameter>, DMatrix<f64>)> {
    let (extended, new, owners) =
        with_sensitivities(problem, found, constants).unwrap_or_else(|| {
            let none: Vec<Vec<_>> = vec![Vec::new(); problem.system.laws.len()];
            (problem.with_extra_columns(&none), Vec::new(), Vec::new())
        });
    let mut of = extended.problem.clone();
    // Holding hidden states firmly would make directions that are not determined seem determined.
    of.pins.clear();
    of.hold = PRACTICAL.hold;
    let point = with_columns(extended.point(&found.point), &new);
    let code = CompiledLaws::new(&of.system, &point.support);
    let k = point.support.len();
    let mut qr = IncrementalQr::new(k);
    EliminatedRecords::new((&of, &code), &point, &mut qr, observer).ok()?;
    let factor = qr.factor();
    let column = |place: usize, times: f64| -> Vec<f64> {
        let entry = |i: usize| {
            if i <= place {
                times * factor.entry(i, place)
            } else {
                0.0
            }
        };
        (0..k).map(entry).collect()
    };
    let set = |j: usize| {
        let rows = problem.system.constraints.rows.iter();
        rows.flat_map(|r| &r.entries)
            .any(|(_, column, _)| *column == j)
    };
    let mut parameters: Vec<Parameter> = Vec::new();
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for (place, (j, a)) in point.active().iter().enumerate() {
        let (parameter, weight) = parameter_of(*j, &extended, (&new, &owners))?;
        let changes = match parameter {
            Parameter::Coefficient(own) if set(own) => continue,
            Parameter::Coefficient(_) => column(place, *a),
            Parameter::Constant(k) => column(place, weight * constants[k].value),
        };
        // A constant changes all laws that hold it.
        match parameters.iter().position(|p| *p == parameter) {
            Some(known) => columns[known]
                .iter_mut()
                .zip(changes)
                .for_each(|(x, y)| *x += y),
            None => {
                parameters.push(parameter);
                columns.push(changes);
            }
        }
    }
    if columns.is_empty() || columns.iter().flatten().any(|x| !x.is_finite()) {
        return None;
    }
    let matrix = DMatrix::from_fn(k, columns.len(), |i, j| columns[j][i]);
    Some((parameters, matrix))
}
