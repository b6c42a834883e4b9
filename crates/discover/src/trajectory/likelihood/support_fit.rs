//! The fit of one support, by the way that the point's noises ask for.
//!
//! In: a problem, a point to start from. Out: a [`Fit`], or nothing where the laws diverge. Steps are taken elsewhere.

use super::criterion::PenalizedLikelihood;
use super::disturbed_fit::disturbed_fit;
use super::fitted_support::Fit;
use super::gauss_newton::undisturbed_fit;
use crate::trajectory::model::{LinearizationPoint, Problem};
use sidc_progress::Observer;

/// Fits the support of `from` together with the required columns, starting from its coefficients, trajectory and noise. Gives up early if
/// the criterion is unlikely to come near `beat`. `None` where the laws diverge, the trajectory leaves the data, or the observer ends the
/// work.
pub(crate) fn fit(
    problem: &Problem,
    from: LinearizationPoint,
    criterion: &PenalizedLikelihood,
    beat: f64,
    observer: &mut dyn Observer,
) -> Option<Fit> {
    let from = from.requiring(&problem.system.constraints.required);
    match from.process {
        None => undisturbed_fit(problem, from, criterion, beat, observer),
        Some(_) => disturbed_fit(problem, from, criterion, beat, observer),
    }
}
