//! Other ways to write the relations that coupled equations span: sums of multiples of the laws with fewer terms, and the equation
//! that each highest derivative should come from.
//!
//! In: a discovery, samples, libraries. Out: what is told beside the equations. Never changes an equation, a status or a doubt.

mod coupled_laws;
mod elimination;
mod fewer_terms;
mod multiples;
mod sparse_sums;
mod target_choice;
#[cfg(test)]
mod tests;
pub(crate) mod thresholds;

use coupled_laws::coupled;
use fewer_terms::Search;
use sidc_data::Samples;
use sidc_lang::library::Library;
use sidc_progress::Observer;
use sidc_solve::Solver;
use sidc_system::discovery::{Discovery, Form, RelationChoices};

/// Says in the discovery which other laws of fewer terms its relations have, and which equations should give which highest derivatives.
/// Silent where equations are not coupled, where one was not found, and where they were fitted with a trajectory.
pub fn describe_relations(
    d: &mut Discovery,
    samples: &Samples,
    libraries: &[Option<Library>],
    (solver, observer): (&dyn Solver, &mut dyn Observer),
) {
    let form = Form::new(d);
    let choices = coupled(d, &form, samples, libraries).map(|coupled| {
        let search = Search::new(&coupled, libraries);
        RelationChoices {
            fewer: search.and_then(|s| s.run((solver, observer))),
            targets: target_choice::target_choice(&coupled),
        }
    });
    d.relations = choices.map(Box::new);
}
