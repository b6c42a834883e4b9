//! A tiny residual that is still beyond the error of the data: a series that comes near the law, or the error of a solver that made the
//! data.
//!
//! In: the design of an equation, its library. Out: the standard term with which nothing is left, and a doubt that names it. A solver's
//! error is a function that no single term explains.

use super::lacking_terms::Residual;
use crate::doubts::regression_rules::times;
use crate::doubts::thresholds::DOUBTS;
use crate::identifiability::thresholds::SERIES;
use crate::scaled_design::{OrthonormalBasis, ScaledDesign};
use sidc_lang::library::Library;
use sidc_lang::term::{Language, Term};
use sidc_solve::simd::dot;
use sidc_system::discovery::{Change, Reason, ReasonCode};

/// The doubt `misfit` of an equation whose residual is below the threshold of a misfit, but which a single standard term would explain.
pub fn series_doubt(design: &ScaledDesign, library: &Library) -> Option<Reason> {
    let (residual, error) = (design.evidence.residual, design.evidence.target_error);
    let tiny = residual <= DOUBTS.solver_residual;
    let beyond = error > 0.0 && residual > DOUBTS.misfit * error;
    let measured = design.evidence.joint.is_none() && design.evidence.origin.is_samples();
    if !(tiny && beyond && measured) {
        return None;
    }
    let (term, rest) = term_of_law(design, library)?;
    let explained = rest * residual <= (DOUBTS.misfit * error).max(SERIES.left * residual);
    explained.then(|| doubt(design, &term, rest))
}

fn doubt(design: &ScaledDesign, term: &Term, rest: f64) -> Reason {
    let term = Language(design.model).term(term);
    let text = format!(
        "the residual ({:.1e} of the target) is {} times the estimated error of the data, and with {term}, which the library \
         lacks, it would be {} times less: the terms found are a series that comes near the law",
        design.evidence.residual,
        times(design.evidence.residual / design.evidence.target_error),
        times(1.0 / rest.max(f64::MIN_POSITIVE))
    );
    let equations = &design.model.equations;
    let stated = equations
        .iter()
        .find(|e| e.target == design.equation.target);
    let reason = Reason::new(ReasonCode::Misfit, text);
    let words = format!("add {term} to the library");
    match stated {
        Some(stated) => reason.change(words, Change::Model(vec![stated.with(&[term])])),
        None => reason.remedy(words),
    }
}

/// The standard term that lowers the residual of the terms found most, and the residual with it over the residual without it.
fn term_of_law(design: &ScaledDesign, library: &Library) -> Option<(Term, f64)> {
    let target = design.equation.target;
    let support = design.support.iter().filter_map(|p| design.columns.get(*p));
    let basis = OrthonormalBasis::of(support.map(|c| &c.unit[..]));
    let left = basis.residual(&design.target);
    let square = dot(&left, &left);
    let residual = Residual {
        model: design.model,
        target,
        library,
        samples: &design.samples,
        weights: &design.weights,
        basis: &basis,
        values: &left,
    };
    let mut best: Option<(f64, Term)> = None;
    for (gain, term) in residual.gains(SERIES.dependent) {
        // The first of equals.
        if best.as_ref().is_none_or(|(g, _)| gain > *g) {
            best = Some((gain, term));
        }
    }
    let (gain, term) = best?;
    Some((term, ((square - gain).max(0.0) / square).sqrt()))
}
