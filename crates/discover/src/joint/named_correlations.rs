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
    let all = error_correlations(problem, &found.best, constants, watcher)?;
    let name = |parameter: &Parameter| match parameter {
        Parameter::Constant(k) => {
            let constant = constants.get(*k).filter(|c| c.run.is_none())?;
            Some((String::new(), names.name(constant.signal)))
        }
        Parameter::Coefficient(j) if problem.run_columns.get(*j).is_some() => None,
        Parameter::Coefficient(j) => {
            let target = problem.system.laws[problem.system.law_of(*j)].target;
            Some((names.name(target), Language(names).term(problem.term(*j))))
        }
    };
    let named: Vec<Option<(String, String)>> = all.of.iter().map(name).collect();
    let kept: Vec<usize> = (0..named.len()).filter(|i| named[*i].is_some()).collect();
    let pairs = kept.iter().enumerate();
    let below = pairs.flat_map(|(row, i)| kept[..row].iter().map(move |j| i * (i - 1) / 2 + j));
    Some(Correlations {
        below: below.map(|place| all.below[place]).collect(),
        of: named.into_iter().flatten().collect(),
    })
}
