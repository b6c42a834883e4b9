//! Correlations between the errors of coefficients and unknown constants that were estimated together.
//!
//! In: a problem, a fit, the constants at their values, names. Out: names with their correlations. The sizes of errors come from elsewhere.

use super::unidentifiable_directions::{Parameter, parameter_of};
use super::unknown_constants::{
    SoughtConstant, tie, with_columns, with_constant_values, with_sensitivities,
};
use crate::trajectory::integration::CompiledLaws;
use crate::trajectory::least_squares::{IncrementalQr, constrained_covariances};
use crate::trajectory::likelihood::{EliminatedRecords, Fit};
use crate::trajectory::model::Problem;
use sidc_progress::Observer;

/// What the readings determine, by `name`, and of each the correlations with those before it, row by row; what has no name is left out. From
/// C = (AᵀA)⁻¹ of the rows of a fit, linearised in the constants too. `None` where no law holds a constant, where disturbances drive the
/// laws, or if the observer ends the work.
pub fn error_correlations<N>(
    problem: &Problem,
    found: &Fit,
    constants: &[SoughtConstant],
    name: impl Fn(Parameter) -> Option<N>,
    observer: &mut dyn Observer,
) -> Option<(Vec<N>, Vec<f64>)> {
    if found.point.process.is_some() {
        return None;
    }
    let runs = constants.iter().filter_map(|c| c.run);
    let problem = &with_constant_values(&problem.with_indicators(runs), constants);
    let (mut extended, new, owners) = with_sensitivities(problem, found, constants)?;
    tie(&mut extended.problem, &new, &owners);
    let point = with_columns(extended.point(&found.point), &new);
    let system = &extended.problem.system;
    let code = CompiledLaws::new(system, &point.support);
    let mut qr = IncrementalQr::new(point.support.len());
    EliminatedRecords::new((&extended.problem, &code), &point, &mut qr, observer).ok()?;
    let rows = system.constraints.on(&point.support);
    let covariances = constrained_covariances(&mut qr, &point.coefficients, &rows);

    // Of each parameter its place, and the sign of the weight that its column is divided by.
    let mut kept: Vec<(Parameter, usize, f64)> = Vec::new();
    let mut names = Vec::new();
    for (place, column) in point.support.iter().enumerate() {
        let (parameter, weight) = parameter_of(*column, &extended, (&new, &owners))?;
        let variance = covariances[place].as_ref().map_or(0.0, |c| c[place]);
        let is_determined = variance > 0.0 && variance.is_finite();
        if is_determined && !kept.iter().any(|(known, ..)| *known == parameter) {
            let Some(name) = name(parameter) else {
                continue;
            };
            kept.push((parameter, place, weight.signum()));
            names.push(name);
        }
    }
    let mut below = Vec::new();
    for (row, (_, i, sign)) in kept.iter().enumerate() {
        let column = covariances[*i].as_ref()?;
        for (_, j, other) in &kept[..row] {
            let variance = covariances[*j].as_ref()?[*j];
            let correlation = sign * other * column[*j] / (column[*i] * variance).sqrt();
            below.push(correlation.clamp(-1.0, 1.0));
        }
    }
    let finite = below.iter().all(|r| r.is_finite());
    finite.then_some((names, below))
}
