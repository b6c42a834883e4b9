//! Unknown constants inside terms: settled before the equations are found, told with them.
//!
//! In: a program, its measured signals. Out: the same with the constants' values as columns; their errors in a discovery. Judges nothing.

use sidc_data::Samples;
use sidc_discover as discover;
use sidc_discover::unknown_constants;
use sidc_lang::term::{Signal, SignalNames};
use sidc_progress::Observer;
use sidc_system::discovery::{Discovery, UnknownValue};

use super::measure::Measured;
use super::program::Program;
use super::thresholds::BUDGET;
use crate::options::Options;

/// Settles the unknown constants of a program on its samples; the signals with their values.
pub(super) fn settle(
    program: &Program,
    measured: Measured,
    options: &Options,
    observer: &mut dyn Observer,
) -> Measured {
    let model = &program.model;
    if model.unknowns.is_empty() || measured.samples.is_empty() {
        return measured;
    }
    let of = (model, &program.libraries[..]);
    let search = &options.search;
    let minima = unknown_constants::settle(of, (&measured.samples, 1), search, observer);
    let Some(mut values) = minima.into_iter().next() else {
        return measured;
    };
    let mut at = measured.with_constants(program, &values);
    for _ in 0..BUDGET.constant_rounds {
        let data = (at.acting(), &at.samples);
        let found = discover::discover(model, &program.libraries, data, search, observer);
        let Ok(found) = found else { break };
        let refined = unknown_constants::refine(of, (&at.samples, &values), &found, search);
        let Some(refined) = refined else { break };
        let moved = values
            .iter()
            .zip(&refined)
            .any(|(a, b)| (a - b).abs() > 1e-9 * a.abs());
        values = refined;
        at = at.with_constants(program, &values);
        if !moved {
            break;
        }
    }
    at
}

impl Measured {
    /// The same with these values of the unknown constants.
    fn with_constants(mut self, program: &Program, values: &[f64]) -> Measured {
        let unknowns = &program.model.unknowns;
        self.samples = unknown_constants::with_values(&self.samples, unknowns, values);
        let signals = unknowns.iter().map(|u| Signal::new(u.var));
        let values: Vec<(Signal, f64)> = signals.zip(values.iter().copied()).collect();
        let all = [
            Some(&mut self.dataset),
            self.acting.as_mut(),
            Some(&mut self.held),
        ];
        for dataset in all.into_iter().flatten() {
            *dataset = dataset.with_constants(&values);
        }
        self
    }
}

/// The values that the samples have, with their errors, in a discovery; the coefficients' errors grow by those of the constants.
pub(super) fn tell(program: &Program, samples: &Samples, found: &mut Discovery, options: &Options) {
    let model = &program.model;
    let value = |signal: Signal| samples.column(signal)?.values.first().copied();
    let signals: Vec<Signal> = model.unknowns.iter().map(|u| Signal::new(u.var)).collect();
    let values: Option<Vec<f64>> = signals.iter().map(|s| value(*s)).collect();
    let Some(values) = values else { return };
    let of = (model, &program.libraries[..]);
    let errors = unknown_constants::constant_errors(of, (samples, &values), found, &options.search);
    for (target, added) in errors.iter().flat_map(|e| &e.added) {
        let own = found.equations.iter_mut().filter(|e| e.target == *target);
        for term in own.flat_map(|e| &mut e.terms) {
            let more = added.iter().find(|(t, _)| *t == term.term).map(|a| a.1);
            if let (Some(error), Some(more)) = (&mut term.standard_error, more) {
                *error = error.hypot(more.max(0.0).sqrt());
            }
        }
    }
    let used = |s: &Signal| {
        let mut terms = found.equations.iter().flat_map(|e| &e.terms);
        terms.any(|t| t.term.mentions(*s))
    };
    let told = signals.iter().zip(&values).enumerate();
    let told = told.filter(|(_, (s, _))| used(s)).map(|(k, (s, value))| {
        let error = errors
            .as_ref()
            .and_then(|e| e.standard_errors.get(k))
            .copied();
        UnknownValue::new(model.name(*s), *value, error.filter(|e| e.is_finite()))
    });
    found.unknowns = told.collect();
}
