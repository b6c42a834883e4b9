//! What a model says of coefficients that differ from run to run, in the estimation problem.
//!
//! In: a model, pools of candidates, a problem. Out: pools with the terms that it names, the problem with their columns by run. Finds
//! no such coefficients.

use crate::selection::screening::{CandidatePools, offer};
use crate::trajectory::{Law, Problem};
use sidc_lang::library::Library;
use sidc_lang::model::Model;

/// Keeps the terms whose coefficients may differ between runs among the candidates.
pub(super) fn offer_per_run(
    model: &Model,
    libraries: &[Option<Library>],
    pools: &mut CandidatePools,
) {
    for c in &model.per_run {
        let place = model.equations.iter().position(|e| e.target == c.target);
        let Some(place) = place else { continue };
        let slot = libraries[place].as_ref().and_then(|l| l.contains(&c.term));
        if let Some(slot) = slot {
            offer(pools, place, slot);
        }
    }
}

/// The problem with a coefficient for each run where the model says so.
pub(super) fn with_declared_runs(model: &Model, problem: Problem) -> Problem {
    let declared = |law: &Law, j: usize| {
        let term = &problem.system.columns[j];
        (model.per_run.iter()).any(|c| c.target == law.target && c.term == *term)
    };
    let laws = problem.system.laws.iter();
    let split: Vec<usize> = laws
        .flat_map(|law| law.columns.clone().filter(move |j| declared(law, *j)))
        .collect();
    match split.is_empty() {
        true => problem,
        false => problem.with_run_columns(&split).0,
    }
}
