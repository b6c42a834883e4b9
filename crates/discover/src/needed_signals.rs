//! The signals that equations are found from.
//!
//! In: a model, its libraries. Out: signals, each once, sorted. Sees no data.

use crate::known_terms::{fixed_terms, is_estimated_if_given};
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_lang::term::Signal;

/// Every signal that some equation mentions in which terms or constants are sought, its target included.
pub fn needed_signals(model: &Model, libraries: &[Option<Library>]) -> Vec<Signal> {
    let mut all = Vec::new();
    for (equation, library) in model.equations.iter().zip(libraries) {
        if library.is_none() && !is_estimated_if_given(model, &equation.right) {
            continue;
        }
        all.push(equation.target);
        all.extend(library.iter().flat_map(Library::signals));
        for (_, term) in fixed_terms(&equation.right) {
            term.for_each_signal(&mut |s| all.push(s));
        }
    }
    all.sort_unstable();
    all.dedup();
    all
}
