//! Other laws, with other values of the constants, that describe the rows as well.
//!
//! In: a model, rows, an answer with its values, other minima of the criterion. Out: the laws there, if the criterion does not tell them from
//! the answer. Refines no value.

use super::profile::Profile;
use super::thresholds::UNKNOWNS;
use crate::options::Options;
use crate::selection::thresholds::TERM_SELECTION;
use sidc_data::Samples;
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_lang::term::{Signal, Term};
use sidc_progress::Observer;
use sidc_system::discovery::Discovery;

/// Laws at other values.
pub(crate) struct RivalLaws {
    /// A value for each constant, in order of declaration.
    pub values: Vec<f64>,
    /// The terms of each equation that has others than the answer.
    pub laws: Vec<(Signal, Vec<Term>)>,
    /// Criterion minus that of the answer.
    pub criterion: f64,
}

/// Laws of other terms within a tie of the answer. Empty where constants differ between runs.
pub(crate) fn rivals(
    (model, libraries): (&Model, &[Option<Library>]),
    (samples, values, others): (&Samples, &[f64], &[Vec<f64>]),
    found: &Discovery,
    options: &Options,
    observer: &mut dyn Observer,
) -> Vec<RivalLaws> {
    if others.is_empty() || model.unknowns.iter().any(|u| u.per_run) {
        return Vec::new();
    }
    let profile = Profile::new(model, libraries, (samples, UNKNOWNS.rows), options);
    let Some(here) = profile.at(values, observer) else {
        return Vec::new();
    };
    let mut out = Vec::new();
    for other in others {
        let Some(there) = profile.at(other, observer) else {
            continue;
        };
        let all = profile.equations.iter().zip(&there.supports);
        let laws: Vec<(Signal, Vec<Term>)> = all
            .map(|(e, support)| {
                let terms = support.iter().filter_map(|j| e.library.term(*j));
                (e.target, terms.collect())
            })
            .filter(|law| is_other(found, law))
            .collect();
        let criterion = there.criterion - here.criterion;
        if criterion < TERM_SELECTION.tie && !laws.is_empty() {
            out.push(RivalLaws {
                values: other.clone(),
                laws,
                criterion,
            });
        }
    }
    out
}

/// Whether the answer has other terms.
fn is_other(found: &Discovery, (target, terms): &(Signal, Vec<Term>)) -> bool {
    let mut own = found.equations.iter().filter(|e| e.target == *target);
    own.any(|e| {
        let free: Vec<&Term> = e
            .terms
            .iter()
            .filter(|t| !t.fixed)
            .map(|t| &t.term)
            .collect();
        free.len() != terms.len() || !terms.iter().all(|t| free.contains(&t))
    })
}
