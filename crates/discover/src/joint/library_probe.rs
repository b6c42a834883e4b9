//! A probe of the libraries: whether standard terms that they lack describe the readings better than the laws found.
//!
//! In: the problem and what was found. Out: better laws, or nothing. Never changes the answer.

use crate::joint::thresholds::LIBRARY_PROBE;
use crate::selection::thresholds::{SCREENING, TERM_SELECTION};
use crate::standard_terms::standard_terms;
use crate::trajectory::{BetterLaws, Found, Law, Problem, search_beyond_libraries};
use sidc_lang::term::{Signal, Term};
use sidc_progress::Observer;

/// Better laws with standard terms of the states and inputs. `None` too where there would be too many columns.
pub(crate) fn probe_libraries(
    problem: &Problem,
    found: &Found,
    observer: &mut dyn Observer,
) -> Option<BetterLaws> {
    let extra: Vec<Vec<Term>> = problem
        .system
        .laws
        .iter()
        .map(|law| lacking(problem, law))
        .collect();
    let all = problem.system.columns.len() + extra.iter().map(Vec::len).sum::<usize>();
    if all > SCREENING.searched_columns || extra.iter().all(Vec::is_empty) {
        return None;
    }
    search_beyond_libraries(problem, found, &extra, TERM_SELECTION.tie, observer)
}

/// Standard terms of a searched law's signals that its columns lack; the signals of its own variable first.
fn lacking(problem: &Problem, law: &Law) -> Vec<Term> {
    let system = &problem.system;
    if law.columns.is_empty() {
        return Vec::new();
    }
    let own = |s: &&Signal| s.var == law.target.var;
    let mut signals: Vec<Signal> = system.states.iter().filter(own).copied().collect();
    let others = system.states.iter().chain(&system.exogenous);
    let others = others.filter(|s| **s != Signal::TIME && !own(s));
    signals.extend(others);
    signals.truncate(LIBRARY_PROBE.max_signals);
    let present = &system.columns[law.columns.clone()];
    let mut terms = standard_terms(&signals);
    terms.retain(|t| !present.contains(t));
    terms
}
