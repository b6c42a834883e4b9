//! Offsets of hidden states by measured ones that leave laws with fewer terms.
//!
//! In: a problem, the terms of a fit to it. Out: how far to shift a hidden state, and the terms that the laws then have. Where x z stands beside x² in
//! a law, z + c x stands beside fewer terms, and the law of z + c x follows by the chain rule. A search that drops one term at a time does not find
//! it: each of the others is needed while the rest stands.

use std::collections::BTreeMap;

use super::hidden_laws::hidden_laws;
use super::thresholds::HIDDEN;
use crate::trajectory::model::{Problem, System};
use sidc_lang::term::{Atom, Signal, Term};

/// A hidden state z that becomes z + `by` · `state`.
pub(super) struct Offset {
    /// The law of z.
    pub law: usize,
    /// Place of a measured state; `None` for a constant.
    pub state: Option<usize>,
    pub by: f64,
    /// Columns with coefficients afterwards.
    pub terms: Vec<(usize, f64)>,
}

/// Coefficients by law and term, each as a sum and the sum of its parts' sizes.
type Coefficients = BTreeMap<(usize, Term), (f64, f64)>;

/// The offset after which the fewest terms are left; `None` where none leaves fewer.
pub(super) fn sparsest_offset(problem: &Problem, active: &[(usize, f64)]) -> Option<Offset> {
    let (_, sought) = hidden_laws(problem);
    if !problem.run_columns.is_empty() {
        return None;
    }
    let offsets = sought.iter().flat_map(|law| offsets(problem, active, *law));
    offsets
        .filter(|o| o.terms.len() < active.len())
        .min_by_key(|o| o.terms.len())
}

/// Every offset of the hidden state of a law that takes a term out of another law.
fn offsets(problem: &Problem, active: &[(usize, f64)], law: usize) -> Vec<Offset> {
    let system = &problem.system;
    let hidden = Signal::new(system.laws[law].target.var);
    if system.laws[law].target.der != 1 {
        return Vec::new();
    }
    let states = (0..system.states.len()).filter(|i| !system.is_hidden(*i));
    let by_what: Vec<Option<usize>> = std::iter::once(None).chain(states.map(Some)).collect();
    let mut found = Vec::new();
    for (j, a) in active.iter().filter(|(j, _)| system.law_of(*j) != law) {
        let Some(Some(rest)) = without(problem.term(*j), hidden) else {
            continue;
        };
        for state in &by_what {
            let beside = rest.mul(&factor(system, *state));
            let own = |(k, _): &&(usize, f64)| {
                system.law_of(*k) == system.law_of(*j) && *problem.term(*k) == beside
            };
            let Some((_, b)) = active.iter().find(own) else {
                continue;
            };
            let by = b / a;
            let terms = with_offset(problem, active, law, (*state, by));
            found.extend(terms.map(|terms| Offset {
                law,
                state: *state,
                by,
                terms,
            }));
        }
    }
    found
}

fn factor(system: &System, state: Option<usize>) -> Term {
    state.map_or_else(Term::one, |i| Term::signal(system.states[i]))
}

/// A term without its hidden factor: `Some(None)` where it has none, `None` where it is not linear in it.
fn without(term: &Term, hidden: Signal) -> Option<Option<Term>> {
    let own = |a: &Atom| *a == Atom::Signal(hidden);
    let rest = term.part(|a| !own(a));
    let mut inside = false;
    rest.for_each_signal(&mut |s| inside |= s.var == hidden.var);
    match (inside, term.factors().find(|(a, _)| own(a))) {
        (true, _) => None,
        (false, None) => Some(None),
        (false, Some((_, power))) => (power == 1.0).then_some(Some(rest)),
    }
}

/// The laws in terms of z + c s; `None` where a law would need a term that its library lacks.
fn with_offset(
    problem: &Problem,
    active: &[(usize, f64)],
    law: usize,
    (state, c): (Option<usize>, f64),
) -> Option<Vec<(usize, f64)>> {
    let system = &problem.system;
    let hidden = Signal::new(system.laws[law].target.var);
    let by = factor(system, state);
    let mut all = Coefficients::new();
    let mut add = |law: usize, term: Term, a: f64| {
        let sum = all.entry((law, term)).or_default();
        *sum = (sum.0 + a, sum.1 + a.abs());
    };
    for (j, a) in active {
        let (own, term) = (system.law_of(*j), problem.term(*j));
        // z = (z + c s) − c s
        add(own, term.clone(), *a);
        let rest = without(term, hidden)?;
        let behind = rest.map(|rest| rest.mul(&by));
        if let Some(behind) = &behind {
            add(own, behind.clone(), -c * a);
        }
        // d(z + c s) = dz + c ds
        if state.is_some_and(|i| system.laws[own].state == i) {
            add(law, term.clone(), c * a);
            if let Some(behind) = behind {
                add(law, behind, -c * c * a);
            }
        }
    }
    if let Some(i) = state {
        rate_of(system, i, &mut |term| add(law, term, c))?;
    }
    let left = all
        .into_iter()
        .filter(|(_, (sum, size))| sum.abs() > HIDDEN.cancelled * size);
    let column = |((law, term), (a, _)): ((usize, Term), (f64, f64))| {
        let mut own = system.laws[law].columns.clone();
        Some((own.find(|j| system.columns[*j] == term)?, a))
    };
    let mut terms: Vec<(usize, f64)> = left.map(column).collect::<Option<_>>()?;
    terms.sort_by_key(|(j, _)| *j);
    Some(terms)
}

/// Gives the rate of a state where that is another state. `None` where the law of the state has known terms.
fn rate_of(system: &System, state: usize, give: &mut dyn FnMut(Term)) -> Option<()> {
    if let Some(rate) = system.derivative_state(state) {
        give(Term::signal(system.states[rate]));
        return Some(());
    }
    let law = system.laws.iter().find(|l| l.state == state)?;
    (law.known.terms().len() == 0).then_some(())
}
