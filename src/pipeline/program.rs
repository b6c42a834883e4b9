//! Model text → program: the first stage.
//!
//! In: a text among the sources. Out: a checked model with the library of each equation, and diagnostics. Evaluates nothing.

use std::sync::Arc;

use sidc_discover as discover;
use sidc_discover::TargetCopy;
use sidc_lang as lang;
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::includes::flattened;
use sidc_lang::library;
use sidc_lang::library::{GENERATORS, Library};
use sidc_lang::model::{Equation, Model, RightSide};
use sidc_lang::source::{FileId, Sources};
use sidc_lang::term::{Signal, SignalNames, Term};
use sidc_lang::{GeneratorSignature, Vocabulary};
use sidc_solve::threads;
use sidc_system::discovery::Discovery;

use super::thresholds::BUDGET;

/// A checked model with the library of each equation; `None` if the equation is known.
#[derive(Clone, Debug)]
pub struct Program {
    /// The text that it was compiled from, with included files inlined.
    pub text: Arc<str>,
    /// Whether it includes files; if so, positions in the model are not positions in `text`.
    pub includes_files: bool,
    pub model: Model,
    pub libraries: Vec<Option<Library>>,
}

/// The result of a stage, absent after an error, and all its diagnostics.
pub type Staged<T> = (Option<T>, Vec<Diagnostic>);

/// The generators of the registry, as the language names them.
pub fn vocabulary() -> Vocabulary {
    Vocabulary {
        generators: GENERATORS
            .iter()
            .map(|g| GeneratorSignature {
                name: g.name(),
                usage: g.usage(),
                discrete_only: g.discrete_only(),
                of_angles: g.of_angles(),
            })
            .collect(),
    }
}

/// Text → program. All libraries together take at most `memory` bytes, shared equally among the equations.
pub fn compile(file: FileId, sources: &Sources, memory: u64) -> Staged<Program> {
    let (model, mut diagnostics) = lang::compile(file, sources, &vocabulary());
    let Some(model) = model else {
        return (None, diagnostics);
    };
    let mut libraries = Vec::new();
    for (library, found) in expand_all(&model, memory) {
        // Equations that use the same `let` would each report its faults.
        for d in found {
            if !diagnostics.contains(&d) {
                diagnostics.push(d);
            }
        }
        libraries.push(library);
    }
    if !diagnostics.iter().any(Diagnostic::is_error) {
        diagnostics.extend(discover::check_constraints(&model, &libraries));
    }
    let text = flattened(file, sources);
    let program = Program {
        includes_files: sources.get(file).is_some_and(|s| s.text != text),
        text: text.into(),
        model,
        libraries,
    };
    finish(program, diagnostics)
}

/// The library of each equation, in order. Most of the time before data are read is spent here, so equations are expanded in parallel.
fn expand_all(model: &Model, memory: u64) -> Vec<(Option<Library>, Vec<Diagnostic>)> {
    let expand = |equation: &Equation| match &equation.right {
        RightSide::Search {
            library: Some(written),
            ..
        } => {
            let (library, found) = library::expand(model, equation.target, written, memory);
            (Some(library), found)
        }
        _ => (None, Vec::new()),
    };
    let Some((first, rest)) = model.equations.split_first() else {
        return Vec::new();
    };
    if rest.len() >= BUDGET.parallel_libraries || threads::available() == 1 {
        return model.equations.iter().map(expand).collect();
    }
    std::thread::scope(|scope| {
        let spawn = |e| scope.spawn(move || expand(e));
        let others: Vec<_> = rest.iter().map(spawn).collect();
        let mut all = vec![expand(first)];
        // If a thread panicked, its equation is expanded here instead.
        let joined = others.into_iter().zip(rest);
        all.extend(joined.map(|(handle, e)| handle.join().unwrap_or_else(|_| expand(e))));
        all
    })
}

impl Program {
    /// The program without these candidates.
    pub(super) fn without(&self, copies: &[TargetCopy]) -> Program {
        let mut narrowed = self.clone();
        for (place, library) in narrowed.libraries.iter_mut().enumerate() {
            let own = copies.iter().filter(|c| c.equation == place);
            let slots: Vec<usize> = own.map(|c| c.slot).collect();
            if let Some(library) = library.as_mut().filter(|_| !slots.is_empty()) {
                *library = library.without(&slots);
            }
        }
        narrowed
    }

    /// The program with a part of each library, given the library and the slots of the terms that were found.
    pub(super) fn with_slots(
        &self,
        found: &Discovery,
        slots: &dyn Fn(&Library, &[usize]) -> Vec<usize>,
    ) -> Program {
        let mut narrowed = self.clone();
        let stated = self.model.equations.iter().zip(&mut narrowed.libraries);
        for (stated, library) in stated {
            let Some(whole) = library.as_ref() else {
                continue;
            };
            let own = found.equations.iter().filter(|e| e.target == stated.target);
            let terms = own.flat_map(|e| &e.terms);
            let found: Vec<usize> = terms.filter_map(|t| whole.contains(&t.term)).collect();
            *library = Some(whole.with_only(&slots(whole, &found)));
        }
        narrowed
    }

    /// The program in which unknown constants are sought from 1/`factor` of the values found to `factor` times these.
    pub(super) fn near_constants(mut self, found: &Discovery, factor: f64) -> Program {
        let names: Vec<String> = (self.model.unknowns.iter())
            .map(|u| self.model.variable(u.var).to_owned())
            .collect();
        for (unknown, name) in self.model.unknowns.iter_mut().zip(names) {
            // One value, or one a run.
            let own = found.unknowns.iter().filter(|v| v.name == name);
            let ends = own.flat_map(|v| [v.value / factor, v.value * factor]);
            let empty = (f64::INFINITY, f64::NEG_INFINITY);
            let (a, b) = ends.fold(empty, |(a, b), x| (a.min(x), b.max(x)));
            let (from, to) = unknown.range.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
            let (from, to) = (a.max(from), b.min(to));
            if from < to {
                unknown.range = Some((from, to));
            }
        }
        self
    }

    /// Whether the model requires a term in the equation of a target.
    pub(super) fn requires(&self, target: Signal, term: &Term) -> bool {
        self.sought(target).is_some_and(|(_, library)| {
            let slot = library.contains(term);
            slot.is_some_and(|slot| library.required().contains(&slot))
        })
    }

    /// The index of an equation in the model and its library; `None` if that equation is not searched for.
    pub(super) fn sought(&self, target: Signal) -> Option<(usize, &Library)> {
        let place = self
            .model
            .equations
            .iter()
            .position(|e| e.target == target)?;
        Some((place, self.libraries.get(place)?.as_ref()?))
    }
}

/// Every signal that some equation mentions, sorted, without duplicates.
pub fn needed(program: &Program) -> Vec<Signal> {
    discover::needed_signals(&program.model, &program.libraries)
}

/// A stage with an error among its diagnostics has no result.
pub(super) fn finish<T>(stage: T, diagnostics: Vec<Diagnostic>) -> Staged<T> {
    if diagnostics.iter().any(Diagnostic::is_error) {
        (None, diagnostics)
    } else {
        (Some(stage), diagnostics)
    }
}
