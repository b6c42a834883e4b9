//! Correlations of coefficients and unknown constants, by the names of a result.
//!
//! In: a fit with its constants. Out: an entry of the result; constants stand in no equation. Estimates nothing.

use crate::trajectory::{Found, Parameter, Problem, SoughtConstant, error_correlations};
use sidc_lang::term::{Language, SignalNames};
use sidc_progress::EquationObserver;
use sidc_system::discovery::{Correlations, Discovery};

/// `None` where they are not known. What has a value for each run has no single error, and is left out.
pub(super) fn named_correlations(
    (problem, found): (&Problem, &Found),
    constants: &[SoughtConstant],
    names: &Discovery,
    watcher: &mut EquationObserver,
) -> Option<Correlations> {
    let name = |parameter| match parameter {
        Parameter::Constant(k) => {
            let constant = constants.get(k).filter(|c| c.run.is_none())?;
            Some((String::new(), names.name(constant.signal)))
        }
        Parameter::Coefficient(j) if problem.run_columns.get(j).is_some() => None,
        Parameter::Coefficient(j) => {
            let target = problem.system.laws[problem.system.law_of(j)].target;
            Some((names.name(target), Language(names).term(problem.term(j))))
        }
    };
    let (of, below) = error_correlations(problem, &found.best, constants, name, watcher)?;
    Some(Correlations { of, below })
}
