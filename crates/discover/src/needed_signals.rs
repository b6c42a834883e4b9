//! The signals that equations are found from.
//!
//! In: a model, its libraries. Out: signals, each once, sorted. Sees no data.

use sidc_lang::library::Library;
use sidc_lang::model::{Model, RightSide};
use sidc_lang::term::Signal;

/// Every signal that some equation mentions in which terms are sought, its target included.
pub fn needed_signals(model: &Model, libraries: &[Option<Library>]) -> Vec<Signal> {
    let mut all = Vec::new();
    for (equation, library) in model.equations.iter().zip(libraries) {
        let Some(library) = library else { continue };
        all.push(equation.target);
        all.extend(library.signals());
        if let RightSide::Search { known, .. } = &equation.right {
            known
                .iter()
                .for_each(|(e, _)| e.for_each_signal(&mut |s| all.push(s)));
        }
    }
    all.sort_unstable();
    all.dedup();
    all
}
