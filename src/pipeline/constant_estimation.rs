//! Unknown constants inside terms, estimated before the equations are found and reported with them.
//!
//! In: a program and its measured signals. Out: the signals with the constants' values as columns, and the constants with their errors in a discovery.

use sidc_data::{Dataset, Samples};
use sidc_discover as discover;
use sidc_discover::unknown_constants;
use sidc_lang::term::{Signal, SignalNames};
use sidc_progress::Observer;
use sidc_system::discovery::{Discovery, UnknownValue};

use super::program::Program;
use super::thresholds::BUDGET;
use crate::options::Options;

/// Values of the unknown constants of a model.
pub(super) struct Estimate {
    /// Those of maximum likelihood.
    pub values: Vec<f64>,
    /// Those at other minima of the criterion.
    pub others: Vec<Vec<f64>>,
}

/// `None` if there are no unknown constants or no rows.
pub(super) fn estimate(
    program: &Program,
    (dataset, samples): (&Dataset, &Samples),
    options: &Options,
    observer: &mut dyn Observer,
) -> Option<Estimate> {
    let model = &program.model;
    if model.unknowns.is_empty() || samples.is_empty() {
        return None;
    }
    let of = (model, &program.libraries[..]);
    let search = &options.search;
    let wanted = unknown_constants::MinimaSought::of_rows();
    let minima = unknown_constants::minima(of, (samples, wanted), search, observer);
    let mut minima = minima.into_iter();
    let mut values = minima.next()?;
    let sought = unknown_constants::sought(model, samples);
    for _ in 0..BUDGET.constant_rounds {
        let samples = unknown_constants::with_values(samples, &sought, &values);
        let named = unknown_constants::named_values(dataset, &sought, &values);
        let acting = dataset.with_constants(&named);
        let data = (&acting, &samples);
        let found = discover::discover(model, &program.libraries, data, search, observer);
        let Ok(found) = found else { break };
        let refined = unknown_constants::refine(of, (&samples, &values), &found, search);
        let Some(refined) = refined else { break };
        let near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-9 * a.abs();
        let settled = values.iter().zip(&refined).all(near);
        values = refined;
        if settled {
            break;
        }
    }
    let others = minima.collect();
    Some(Estimate { values, others })
}

/// Doubts equations that other terms with other constants describe as well.
pub(super) fn doubt_rivals(
    program: &Program,
    (samples, others): (&Samples, &[Vec<f64>]),
    found: &mut Discovery,
    options: &Options,
    observer: &mut dyn Observer,
) {
    let of = (&program.model, &program.libraries[..]);
    discover::doubt_rival_constants(of, (samples, others), found, (&options.search, observer));
}

/// Adds the constants' values and standard errors to a discovery, and the variance that they cause to that of the coefficients.
pub(super) fn report_values(
    program: &Program,
    (dataset, samples): (&Dataset, &Samples),
    found: &mut Discovery,
    options: &Options,
) {
    let model = &program.model;
    let sought = unknown_constants::sought(model, samples);
    let Some(values) = unknown_constants::values_of(samples, &sought) else {
        return;
    };
    let named = unknown_constants::named_values(dataset, &sought, &values);
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
    let told = named.iter().enumerate();
    let told = told.filter(|(_, v)| used(&v.signal)).map(|(k, v)| {
        let error = errors
            .as_ref()
            .and_then(|e| e.standard_errors.get(k))
            .copied();
        let error = error.filter(|e| e.is_finite());
        UnknownValue::new(model.name(v.signal), v.value, error).of_run(v.run.clone())
    });
    found.unknowns = told.collect();
}

/// Adds what is proved of the equations over the ranges of their constants.
pub(super) fn certify(
    program: &Program,
    samples: &Samples,
    found: &mut Discovery,
    observer: &mut dyn Observer,
) {
    if found.unknowns.is_empty() {
        return;
    }
    let model = &program.model;
    for equation in &mut found.equations {
        let mut sought = model.equations.iter().zip(&program.libraries);
        let own = sought.find(|(e, _)| e.target == equation.target);
        let Some(library) = own.and_then(|(_, library)| library.as_ref()) else {
            continue;
        };
        let of = (model, library);
        let proved = unknown_constants::range_certificates(of, samples, equation, observer);
        if let Some(evidence) = &mut equation.evidence {
            evidence.certificate_range = proved;
        }
    }
}

/// Adds doubts about the constants of a discovery, from rows of all signals.
pub(super) fn doubt(
    program: &Program,
    samples: &Samples,
    found: &mut Discovery,
    options: &Options,
) {
    let of = (&program.model, &program.libraries[..]);
    discover::doubt_constants(of, samples, found, &options.search);
}
