//! The weak problems of a whole model, as a beginning for whoever goes on from there.
//!
//! In: a model, its dataset, its libraries. Out: one problem for each searched equation that has one. Chooses nothing.

use crate::data::Dataset;
use crate::dictionary::BadValue;
use crate::lang::model::{Model, RightSide};
use crate::library::{Library, known_terms};

use super::problem::{Asked, Weak};

/// The weak form of every searched equation, in order of the model: `None` where the equation is known, or where there is nothing
/// to integrate. `libraries` has one entry an equation.
///
/// [`Weak::whitened`] makes a regression problem of each: columns are the library's slots, rows have independent errors of size
/// one; known terms are taken off the target. With no belief and a slack of 0.3 or 0.03 it is a cautious beginning, with terms
/// and coefficients it is what these make of it.
///
/// # Errors
/// The place of an equation in the model, and its term without a finite value.
pub fn problems(
    model: &Model,
    dataset: &Dataset,
    libraries: &[Option<Library>],
    entries: usize,
) -> Result<Vec<Option<Weak>>, (usize, Box<BadValue>)> {
    let mut out = Vec::new();
    for (place, (equation, library)) in model.equations.iter().zip(libraries).enumerate() {
        let (Some(library), RightSide::Search { known, .. }) = (library, &equation.right) else {
            out.push(None);
            continue;
        };
        let known = known_terms(known.iter().map(|(e, _)| e));
        let asked = Asked {
            model,
            dataset,
            target: equation.target,
            known: &known,
            library,
            entries,
        };
        out.push(Weak::new(&asked).map_err(|(bad, _)| (place, bad))?);
    }
    Ok(out)
}
