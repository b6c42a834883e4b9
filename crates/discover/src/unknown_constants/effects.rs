//! How unknown constants act in the terms that were found.
//!
//! In: a discovery with its constants, rows. Out: for each constant how far its term changes with it, and how the coefficient of that term
//! goes with it. Judges nothing.

use super::search::fitted;
use super::searched_constant::{sought, values_of};
use super::variable_projection::{expression_values, project};
use crate::dictionary::evaluate;
use crate::options::Options;
use crate::statistics::norm;
use sidc_data::Samples;
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_lang::term::{Signal, Term};
use sidc_system::discovery::Discovery;

/// A constant in the term that changes most with it.
#[derive(Clone, Debug)]
pub(crate) struct ConstantEffect {
    pub term: Term,
    pub coefficient: f64,
    /// ‖∂φ/∂k‖ / ‖φ‖ over the rows, per unit of the constant.
    pub change: f64,
    /// Change of the coefficient with the constant that keeps the fit closest.
    pub slope: f64,
}

/// Of each number that is sought on these samples, which hold its value; `None` for a constant that no term found holds.
pub(crate) fn constant_effects(
    (model, libraries): (&Model, &[Option<Library>]),
    samples: &Samples,
    found: &Discovery,
    options: &Options,
) -> Option<Vec<Option<ConstantEffect>>> {
    let all = sought(model, samples);
    let values = values_of(samples, &all)?;
    let (profile, supports) = fitted((model, libraries), samples, found, options)?;
    let slopes = project(&profile, &supports, &values)?.slopes;
    let mut out: Vec<Option<ConstantEffect>> = vec![None; values.len()];
    for ((e, support), slopes) in profile.equations.iter().zip(&supports).zip(&slopes) {
        for (row, term) in support.iter().enumerate() {
            let Some(term) = e.library.term(*term) else {
                continue;
            };
            let own = found.equations.iter().find(|f| f.target == e.target);
            let own = own.and_then(|f| f.terms.iter().find(|t| t.term == term));
            let Some(coefficient) = own.map(|t| t.coefficient) else {
                continue;
            };
            for (k, best) in out.iter_mut().enumerate() {
                let change = change(&term, all[k].signal(), samples);
                if change > best.as_ref().map_or(0.0, |b| b.change) {
                    *best = Some(ConstantEffect {
                        term: term.clone(),
                        coefficient,
                        change,
                        slope: slopes[(row, k)],
                    });
                }
            }
        }
    }
    Some(out)
}

fn change(term: &Term, by: Signal, samples: &Samples) -> f64 {
    if !term.mentions(by) {
        return 0.0;
    }
    let slope = expression_values(&term.derivative(by), samples);
    let ratio = norm(&slope) / norm(&evaluate(term, samples));
    if ratio.is_finite() { ratio } else { 0.0 }
}
