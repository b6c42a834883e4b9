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
    // A disturbance is a state without a law, which no model can name.
    let has_law = |s: &&Signal| system.laws.iter().any(|l| l.target.var == s.var);
    let states = system.states.iter().filter(has_law);
    let others = states.chain(system.exogenous.iter().filter(|s| varies(problem, **s)));
    signals.extend(others.filter(|s| **s != Signal::TIME && !own(s)));
    signals.truncate(LIBRARY_PROBE.max_signals);
    let present = &system.columns[law.columns.clone()];
    let mut terms = standard_terms(&signals, &|s| system.with_units.contains(&s));
    terms.retain(|t| !present.contains(t) && !may_diverge(problem, t));
    terms
}

/// Whether an exogenous signal has more than one value: a constant only scales the terms of the others. The impulse of a guard is no signal of the model.
fn varies(problem: &Problem, signal: Signal) -> bool {
    let system = &problem.system;
    if system.impulses.iter().any(|i| i.signal == signal) {
        return false;
    }
    let Some(place) = system.exogenous.iter().position(|s| *s == signal) else {
        return false;
    };
    let records = problem.records.iter();
    let mut values = records
        .filter_map(|r| r.exogenous.get(place))
        .flat_map(|o| &o.values);
    let first = values.next();
    values.any(|x| Some(x) != first)
}

/// Whether a term may divide by a signal whose readings change sign. Near that pole its value is as large as any single reading
/// requires, so such a term fits anything.
fn may_diverge(problem: &Problem, term: &Term) -> bool {
    let divides = term.factors().any(|(_, power)| power < 0.0);
    let mut crosses = false;
    term.for_each_signal(&mut |s| crosses |= changes_sign(problem, s));
    divides && crosses
}

fn changes_sign(problem: &Problem, signal: Signal) -> bool {
    let system = &problem.system;
    let state = system.state_index(signal);
    let input = system.exogenous.iter().position(|s| *s == signal);
    let readings = problem.records.iter().flat_map(|record| {
        let state = state.and_then(|i| record.measured.get(i));
        let input = input.and_then(|i| record.exogenous.get(i));
        let input = input.map(|e| &e.values);
        state.into_iter().chain(input).flatten()
    });
    let signs = readings.filter(|x| x.is_finite()).map(|x| *x > 0.0);
    let (positive, negative): (Vec<bool>, Vec<bool>) = signs.partition(|p| *p);
    !positive.is_empty() && !negative.is_empty()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::trajectory::tests::windows::cart_runs;

    /// The signals of all terms that are tried.
    fn signals_tried(problem: &Problem) -> BTreeSet<Signal> {
        let mut signals = BTreeSet::new();
        let laws = problem.system.laws.iter();
        for term in laws.flat_map(|law| lacking(problem, law)) {
            term.for_each_signal(&mut |s| {
                signals.insert(s);
            });
        }
        signals
    }

    #[test]
    fn only_signals_that_move_and_that_a_model_can_name_are_tried() {
        let mut problem = cart_runs([60, 40]);
        let input = problem.system.exogenous[0];
        let before = signals_tried(&problem);
        assert!(before.len() > 2 && varies(&problem, input));
        let point = problem.initial_point(&problem.noise);
        let (disturbed, _) = problem.with_disturbance_states(&point, |_| (1.0, 0.1));
        assert!(disturbed.system.states.len() > problem.system.states.len());
        assert_eq!(signals_tried(&disturbed), before);
        for record in &mut problem.records {
            record.exogenous[0].values.fill(2.0);
        }
        assert!(!varies(&problem, input));
    }
}
