//! Stability, alternatives and marks of all terms of a discovery.
//!
//! In: normal equations by block, a discovery. Out: the discovery with the evidence for each term. Marks look at that evidence only,
//! never at data.

use super::drop_one_refit::drop_one_refit;
use super::error_correlations::error_correlations;
use super::omitted_terms::nearest_omitted_terms;
use super::stability_selection::Stability;
use super::target_regression::TargetRegression;
use sidc_lang::model::Model;
use sidc_lang::term::{Language, Signal, SignalNames, Term};
use sidc_solve::threads;
use sidc_system::discovery::{
    BlockNormalEquations, Change, Discovery, Equation, FoundTerm, MARKS, Mark, Reason, ReasonCode,
    Status,
};

/// Gives every term found on these blocks its stability and the best equation without it, and the discovery how their errors are
/// correlated.
pub fn assess_terms(
    blocks: &BlockNormalEquations,
    stability: &Option<Stability>,
    discovery: &mut Discovery,
) {
    let correlations = error_correlations(blocks, discovery);
    discovery.correlations.extend(correlations);
    let mut targets: Vec<Signal> = blocks.columns.iter().map(|(t, _)| *t).collect();
    targets.sort_unstable();
    targets.dedup();
    for target in targets {
        let regression = TargetRegression::new(blocks, target, None);
        let nearest = nearest_omitted_terms(&regression, target, &Language(&*discovery));
        let own = blocks.support.iter().enumerate().filter_map(|(k, column)| {
            let found = blocks.columns.get(*column);
            let (_, term) = found.filter(|(t, _)| *t == target)?;
            Some((k, *column, term))
        });
        let own: Vec<(usize, usize, &Term)> = own.collect();
        let names = &*discovery;
        let refits = threads::map(own.clone(), |(_, column, _)| {
            drop_one_refit(&regression, column, &Language(names))
        });
        for ((k, _, term), without) in own.into_iter().zip(refits) {
            let found = equation(discovery, target).and_then(|e| found_term(e, term));
            if let Some(found) = found {
                let trust = found.evidence.get_or_insert_with(Box::default);
                trust.stability = stability.as_ref().and_then(|s| s.shares.get(k).copied());
                trust.without = without;
            }
        }
        let evidence = equation(discovery, target).and_then(|e| e.evidence.as_mut());
        if let Some(evidence) = evidence {
            evidence.omitted = nearest;
            evidence.halves = stability.as_ref().map(|s| s.halves.clone());
        }
    }
}

/// Doubts every equation whose criterion improves without one of its terms: for terms that the model requires by any amount, for others
/// by more than a tie.
pub fn doubt_unneeded_terms(
    discovery: &mut Discovery,
    model: &Model,
    required: &dyn Fn(Signal, &Term) -> bool,
) {
    discovery.doubt_each(|d, e| required_for_nothing(e, required, &Language(d)));
    discovery.doubt_each(|d, e| unneeded(e, model, required, &Language(d)));
}

/// The doubt about terms that the model requires but that the criterion does not support.
fn required_for_nothing(
    equation: &Equation,
    required: &dyn Fn(Signal, &Term) -> bool,
    names: &Language<Discovery>,
) -> Option<Reason> {
    let own = equation.terms.iter();
    let own = own.filter(|t| !t.fixed && required(equation.target, &t.term));
    let idle = own.filter(|t| {
        t.evidence
            .as_ref()
            .is_some_and(|trust| match &trust.without {
                Some(without) => without.cost < 0.0,
                None => (trust.interval).is_some_and(|(low, high)| low <= 0.0 && 0.0 <= high),
            })
    });
    let idle: Vec<String> = idle.map(|t| names.term(&t.term)).collect();
    let (first, act) = match idle.as_slice() {
        [] => return None,
        [_] => (
            "the data do not show that this required term acts",
            "it acts",
        ),
        _ => (
            "the data do not show that these required terms act",
            "they act",
        ),
    };
    let all = idle.join(", ");
    let reason = Reason::new(ReasonCode::BetterWithout, format!("{first}: {all}"));
    Some(reason.remedy(format!(
        "measure where {act}, or take {all} out of `required(…)`"
    )))
}

/// The doubt about the term whose removal improves the criterion most, if by more than a tie.
fn unneeded(
    equation: &Equation,
    model: &Model,
    required: &dyn Fn(Signal, &Term) -> bool,
    names: &Language<Discovery>,
) -> Option<Reason> {
    let free = equation.terms.iter();
    let free = free.filter(|t| !t.fixed && !required(equation.target, &t.term));
    let gains = free.filter_map(|t| Some((t, t.evidence.as_ref()?.without.as_ref()?)));
    let (term, without) = gains.min_by(|a, b| a.1.cost.total_cmp(&b.1.cost))?;
    (without.cost < -MARKS.tied).then(|| {
        let instead = match without.enter.as_slice() {
            [] => String::new(),
            enter => format!(" and with {}", enter.join(", ")),
        };
        let name = names.term(&term.term);
        let reason = Reason::new(
            ReasonCode::BetterWithout,
            format!(
                "the criterion prefers the equation without {name}{instead} by {:.0}",
                -without.cost
            ),
        );
        // If several terms replace it, dropping it from the library is no clear remedy.
        if without.enter.len() > 1 {
            return reason.remedy(format!(
                "compare with a model without {name}, on data held out"
            ));
        }
        let told = format!("leave {name} out of the library");
        let stated = model.equations.iter().find(|e| e.target == equation.target);
        match stated {
            Some(stated) => {
                let target = model.name(equation.target);
                reason.change(told, Change::Model(stated.without(&target, &[name])))
            }
            None => reason.remedy(told),
        }
    })
}

/// Marks every term that was found. A term of a doubted equation is likely at best.
pub fn mark_terms(discovery: &mut Discovery) {
    for equation in &mut discovery.equations {
        let best = match equation.status {
            Status::Doubt => Mark::Likely,
            _ => Mark::Firm,
        };
        for t in equation.terms.iter_mut().filter(|t| !t.fixed) {
            let trust = t.evidence.get_or_insert_with(Box::default);
            trust.mark = MARKS.of(trust).min(best);
        }
    }
}

fn equation(discovery: &mut Discovery, target: Signal) -> Option<&mut Equation> {
    let mut all = discovery.equations.iter_mut();
    all.find(|e| e.target == target)
}

fn found_term<'a>(equation: &'a mut Equation, term: &Term) -> Option<&'a mut FoundTerm> {
    let mut all = equation.terms.iter_mut();
    all.find(|t| !t.fixed && t.term == *term)
}
