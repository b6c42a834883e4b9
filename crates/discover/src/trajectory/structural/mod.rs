//! Structural identifiability: unknown constants that no readings of these sensors can tell, whatever the inputs and however small the noise.
//!
//! In: a problem, its unknown constants. Out: directions in which parameters can change together while nothing changes that is read. Uses of the data
//! only which signals are read, and their sizes.
//!
//! Local identifiability by the rank of sensitivities (Stigter & Molenaar, Automatica 2015) along runs from random starts, under random inputs, at
//! random values of all parameters: the rank is the same almost everywhere. A direction counts as unidentifiable only if it vanishes to rounding
//! in every run, so a system that is merely hard to identify is never refused. Relative changes make a scaling symmetry the same direction at all values; the coefficients
//! of candidate terms take part in those alone, since other symmetries need terms that the law may lack.

mod null_directions;
mod sensitivities;
pub(crate) mod thresholds;

use nalgebra::DMatrix;

use super::search::Parameter;
use crate::random::SplitMix;
use crate::trajectory::model::Problem;
use null_directions::{Columns, NullDirection, null_directions};
use sensitivities::{SensitiveSystem, Sensitivities};
use sidc_lang::model::UnknownConstant;
use thresholds::STRUCTURAL;

/// Parameters that can change together while nothing that is read changes.
#[derive(Clone, Debug, PartialEq)]
pub struct UnidentifiableDirection {
    /// With the powers by which they change.
    pub parameters: Vec<(Parameter, f64)>,
    /// Whether starts of states change with them.
    pub starts: bool,
}

/// Directions in which constants can change, alone or together with coefficients of candidate terms, while no reading changes.
/// Empty too where it cannot be computed: laws that switch, states that jump, implicit or constrained ones, very many candidates.
///
/// [`Parameter::Constant`] counts the places of `constants`.
pub fn structurally_unidentifiable_directions(
    problem: &Problem,
    constants: &[UnknownConstant],
) -> Vec<UnidentifiableDirection> {
    let Some(system) = SensitiveSystem::of(problem, constants) else {
        return Vec::new();
    };
    let mut numbers = SplitMix::new(STRUCTURAL.seed);
    let mut runs: Vec<Sensitivities> = Vec::new();
    for _ in 0..STRUCTURAL.draws {
        runs.extend(system.run(&mut numbers));
        if runs.len() == STRUCTURAL.runs {
            break;
        }
    }
    if runs.len() < STRUCTURAL.runs {
        return Vec::new();
    }
    let columns = Columns {
        constants: constants.len(),
        coefficients: problem.system.columns.len(),
    };
    let mut scalings = null_directions(&stacked(&runs, columns), columns);
    scalings.retain(NullDirection::is_rational);
    let directions = match (scalings.is_empty(), columns.coefficients) {
        (true, 0) => in_every_run(&runs, columns),
        _ => scalings,
    };
    let parameter = |place: usize| match place.checked_sub(columns.constants) {
        None => Parameter::Constant(place),
        Some(column) => Parameter::Coefficient(column),
    };
    let named = |d: NullDirection| UnidentifiableDirection {
        parameters: (d.changes.into_iter())
            .map(|(place, by)| (parameter(place), by))
            .collect(),
        starts: d.starts,
    };
    directions.into_iter().map(named).collect()
}

/// The rows of all runs: parameters are the same in all, starts are each run's own.
fn stacked(runs: &[Sensitivities], columns: Columns) -> DMatrix<f64> {
    let shared = columns.parameters();
    let rows: usize = runs.iter().map(|r| r.nrows()).sum();
    let starts: usize = runs.iter().map(|r| r.ncols() - shared).sum();
    let mut out = DMatrix::zeros(rows, shared + starts);
    let (mut row, mut column) = (0, shared);
    for run in runs {
        let own = run.ncols() - shared;
        let mut place = out.view_mut((row, 0), (run.nrows(), shared));
        place.copy_from(&run.columns(0, shared));
        let mut place = out.view_mut((row, column), (run.nrows(), own));
        place.copy_from(&run.columns(shared, own));
        row += run.nrows();
        column += own;
    }
    out
}

/// The directions of the first run, if every run has as many: symmetries that are no scalings, as of constants of which only a sum acts.
fn in_every_run(runs: &[Sensitivities], columns: Columns) -> Vec<NullDirection> {
    let each = runs.iter().map(|run| null_directions(run, columns));
    let each: Vec<_> = each.collect();
    let first = each.first().cloned().unwrap_or_default();
    match each.iter().all(|d| d.len() == first.len()) {
        true => first,
        false => Vec::new(),
    }
}
