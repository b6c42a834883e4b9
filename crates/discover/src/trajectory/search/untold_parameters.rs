//! Parameters that the readings do not tell apart: coefficients and unknown constants that can move together and change nothing.
//!
//! In: a problem with hidden states, a fit, the constants. Out: for each such direction the parameters with the powers by which they move. Judges by
//! the likelihood linearised along the data (local identifiability by sensitivities; Stigter & Molenaar, Automatica 2015).

use nalgebra::DMatrix;

use super::unknown_constants::{SoughtConstant, with_columns, with_sensitivities};
use crate::trajectory::integration::CompiledLaws;
use crate::trajectory::least_squares::IncrementalQr;
use crate::trajectory::likelihood::{EliminatedRecords, Fit};
use crate::trajectory::model::{ExtendedProblem, Problem};
use sidc_progress::Observer;

/// Relative change of a parameter within one standard deviation of the readings from which they do not tell it: all of itself.
const SHARE: f64 = 1.0;
/// Change relative to the largest of any direction that is rounding.
const ROUNDING: f64 = 1e-8;
/// Share of the largest change from which a parameter takes part in a direction.
const PART: f64 = 0.1;
/// How much farther than in a fit unread states may move: so far that holding them tells nothing.
const HOLD: f64 = 1e4;

/// A number that was estimated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// The coefficient of a column.
    Coefficient(usize),
    /// A constant, by its place among those sought.
    Constant(usize),
}

/// Directions that change no reading by more than its noise while parameters change by as much as they are: the parameters of each with their
/// relative changes, the largest 1. Empty where there are none, or where they could not be found.
pub fn untold_parameters(
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
    let told = (SHARE * inefficiency.sqrt()).max(ROUNDING * largest);
    let singular = decomposed.singular_values.iter().enumerate();
    let untold = singular.filter(|(_, size)| **size < told);
    let all = untold.map(|(row, _)| {
        let moves: Vec<f64> = directions.row(row).iter().copied().collect();
        let largest = moves
            .iter()
            .copied()
            .fold(0.0, |m: f64, x| if x.abs() > m.abs() { x } else { m });
        let each = parameters
            .iter()
            .zip(&moves)
            .map(|(p, x)| (*p, x / largest));
        each.filter(|(_, x)| x.abs() > PART).collect::<Vec<_>>()
    });
    all.collect()
}

/// A triangular matrix whose columns say what a parameter that grows by its own size changes, in standard deviations of the readings.
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
    let ExtendedProblem {
        problem: of,
        origin,
    } = &extended;
    let mut of = of.clone();
    // What nothing reads has to be as free as it is.
    of.pins.clear();
    of.hold = HOLD;
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
        let (parameter, changes) = match origin[*j] {
            Some(own) if set(own) => continue,
            Some(own) => (Parameter::Coefficient(own), column(place, *a)),
            None => {
                let (constant, weight) = owners[new.iter().position(|n| n == j)?];
                let times = weight * constants[constant].value;
                (Parameter::Constant(constant), column(place, times))
            }
        };
        // A constant moves all laws that hold it.
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
