//! Tables larger than memory: their rows are reduced, part by part, to what least squares needs of them.
//!
//! In: samples of one part after another, then those that are looked at closely. Out: triangular factors, and equations with the
//! coefficients of all rows.

mod all_rows;
mod factor;
mod rows;
pub(crate) mod thresholds;

use sidc_data::{Dataset, Samples};
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_progress::{EquationObserver, Observer};
use sidc_system::discovery::Discovery;

use crate::known_terms::fixed_terms;
use crate::options::Options;
use crate::refusal::Refusal;
use crate::regression::task::Task;
use crate::selection::thresholds::TERM_SELECTION;
pub use factor::Factor;
use rows::EquationRows;

/// Whether the equations of a model can be found from reduced rows.
///
/// # Errors
/// What of the model needs all rows at once, or is too large.
pub fn check_reducible(model: &Model, libraries: &[Option<Library>]) -> Result<(), String> {
    let together = "estimated together with the trajectory";
    if let Some((_, hidden)) = model.hidden_states().next() {
        return Err(format!(
            "the state {} is hidden, so it is {together}",
            hidden.name
        ));
    }
    if !model.per_run.is_empty() {
        return Err(format!(
            "coefficients that differ from run to run are {together}"
        ));
    }
    if !model.unknowns.is_empty() {
        return Err("unknown constants inside terms are sought on all rows again and again".into());
    }
    if !model.constraints.is_empty() {
        return Err("equations under constraints are found together".into());
    }
    let most = TERM_SELECTION.exhaustive_columns;
    let terms = libraries.iter().flatten().map(Library::slots).max();
    match terms.filter(|n| *n > most) {
        Some(n) => Err(format!(
            "a library has {n} terms; their factor is kept for at most {most}"
        )),
        None => Ok(()),
    }
}

/// The rows of every equation as factors; `None` where the model states the equation.
///
/// # Errors
/// Terms without a finite value, one for each library.
pub fn reduce(
    model: &Model,
    libraries: &[Option<Library>],
    samples: &Samples,
) -> Result<Vec<Option<Factor>>, Vec<Refusal>> {
    let mut reduced = vec![None; model.equations.len()];
    let mut refused = Vec::new();
    let equations = model.equations.iter().zip(libraries).enumerate();
    let searched = equations.filter_map(|(place, (equation, library))| {
        let known = fixed_terms(&equation.right);
        let target = (place, equation.target);
        Some(EquationRows::new(
            target,
            &known,
            library.as_ref()?,
            samples,
        ))
    });
    for group in rows::groups(searched) {
        match rows::factors(&group, samples) {
            Ok(factors) => {
                for (equation, factor) in group.iter().zip(factors) {
                    reduced[equation.place] = Some(factor);
                }
            }
            Err(value) => {
                let place = group.first().map_or(0, |e| e.place);
                refused.push(Refusal::Unevaluable((place, value)));
            }
        }
    }
    match refused.is_empty() {
        true => Ok(reduced),
        false => Err(refused),
    }
}

/// Gives equations that were found from `samples` the coefficients of all rows, and doubts those of which all rows say something
/// else. `factors` are those of [`reduce`].
pub fn refit_all_rows(
    (model, libraries): (&Model, &[Option<Library>]),
    (dataset, samples): (&Dataset, &Samples),
    factors: &[Option<Factor>],
    options: &Options,
    discovery: &mut Discovery,
    observer: &mut dyn Observer,
) {
    let names = discovery.clone();
    let mut watcher = EquationObserver::new(observer);
    let searched = model.equations.iter().zip(libraries).zip(factors);
    for (place, ((equation, library), factor)) in searched.enumerate() {
        let (Some(library), Some(factor)) = (library, factor) else {
            continue;
        };
        let found = discovery.equations.iter_mut();
        let Some(found) = found.into_iter().find(|e| e.target == equation.target) else {
            continue;
        };
        watcher.set_equation(place);
        let task = Task {
            target: equation.target,
            known: fixed_terms(&equation.right),
            library,
            model,
            dataset,
            samples,
            options,
        };
        if let Ok(Ok(design)) = task.design(&names, &mut watcher) {
            all_rows::refit(
                (&task, factor),
                &design.weights,
                &names,
                found,
                &mut watcher,
            );
        }
    }
}

#[cfg(test)]
mod tests;
