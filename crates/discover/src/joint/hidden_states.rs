//! Hidden states in an answer: the scale in which they are reported, and doubts about what the readings do not determine.
//!
//! In: an answer. Out: the same in the scale that is reported; in the discovery, what is known of each hidden state. Fits no other terms.

use std::borrow::Cow;

use crate::joint::constrained_search::ConstrainedAnswer;
use crate::joint::joint_fit::JointFit;
use crate::joint::unknown_constants::Constants;
use crate::selection::thresholds::TERM_SELECTION;
use crate::trajectory::{
    Parameter, Problem, ReportedScale, SoughtConstant, exchanged_constants, exchanged_lags,
    unidentifiable_directions, with_sparsest_offset, with_told_scales,
};
use sidc_lang::model::Model;
use sidc_lang::number::significant;
use sidc_lang::term::{Language, Signal, SignalNames};
use sidc_progress::EquationObserver;
use sidc_system::discovery::{Discovery, HiddenStart, HiddenState, Reason, ReasonCode, ScaleRule};

/// Digits of coefficients in a sentence.
const FIGURES: usize = 3;

/// Shifts hidden states so that the laws have the fewest terms, and brings those whose scale is free to the scale in which they are reported.
pub(crate) fn settle_scales(
    answer: &mut ConstrainedAnswer,
    watcher: &mut EquationObserver,
) -> Vec<ReportedScale> {
    if answer.fit.problem.system.hidden.is_empty() {
        return Vec::new();
    }
    let shifted = |answer: &ConstrainedAnswer, watcher: &mut EquationObserver| {
        with_sparsest_offset(&answer.fit.problem, &answer.fit.found, watcher)
    };
    while let Some((problem, found)) = shifted(answer, watcher) {
        answer.fit.problem = Cow::Owned(problem);
        answer.fit.found = found;
    }
    let scaled = with_told_scales(&answer.fit.problem, &answer.fit.found, watcher);
    let Some((problem, found, told)) = scaled else {
        return Vec::new();
    };
    answer.fit.problem = Cow::Owned(problem);
    answer.fit.found = found;
    told
}

/// Reports mean, spread and first values of every hidden state.
pub(crate) fn state(
    model: &Model,
    fit: &JointFit,
    scales: &[ReportedScale],
    discovery: &mut Discovery,
) {
    let problem = &fit.problem;
    let n = problem.states();
    let signals = problem.system.states.iter().enumerate();
    let hidden = signals.filter(|(i, _)| problem.system.is_hidden(*i));
    let told = hidden.map(|(i, signal)| {
        let along =
            |path: &Vec<f64>| -> Vec<f64> { path.iter().skip(i).step_by(n).copied().collect() };
        let columns: Vec<Vec<f64>> = fit.found.best.paths().iter().map(along).collect();
        let count = columns.iter().flatten().count().max(1) as f64;
        let mean = columns.iter().flatten().sum::<f64>() / count;
        let squares = columns.iter().flatten().map(|x| (x - mean).powi(2));
        let deviation = (squares.sum::<f64>() / count).sqrt();
        HiddenState {
            name: model.name(*signal),
            mean,
            deviation,
            starts: starts(problem, &columns),
            scale: rule(model, scales, *signal),
        }
    });
    discovery.hidden = told.collect();
}

/// The first value in each run.
fn starts(problem: &Problem, columns: &[Vec<f64>]) -> Vec<HiddenStart> {
    let mut starts: Vec<HiddenStart> = Vec::new();
    for (record, column) in problem.records.iter().zip(columns) {
        let Some(name) = problem.names.get(record.trajectory) else {
            continue;
        };
        let known = starts.iter().any(|s| s.run == *name);
        starts.extend(column.first().filter(|_| !known).map(|value| HiddenStart {
            run: name.clone(),
            value: *value,
        }));
    }
    starts
}

fn rule(model: &Model, scales: &[ReportedScale], signal: Signal) -> Option<ScaleRule> {
    let told = scales.iter().find(|s| s.state == signal)?;
    Some(ScaleRule {
        equation: model.name(told.target),
        term: Language(model).term(&told.term),
        coefficient: told.coefficient,
    })
}

/// Doubts what the readings do not determine of a system with hidden states: parameters that can change together without a change of any
/// reading, and laws with the same terms that follow the readings as well.
pub(crate) fn doubt(
    (model, constants): (&Model, &[SoughtConstant]),
    fit: &JointFit,
    discovery: &mut Discovery,
    watcher: &mut EquationObserver,
) {
    let (problem, found) = (&fit.problem, &fit.found);
    let nothing_hidden = problem.system.hidden.is_empty() && constants.is_empty();
    if nothing_hidden || watcher.stop().is_some() {
        return;
    }
    // Constants that were held at their start are among the parameters, too.
    let free = constants.iter().map(|c| SoughtConstant {
        range: (f64::NEG_INFINITY, f64::INFINITY),
        ..*c
    });
    let free: Vec<SoughtConstant> = free.collect();
    let directions =
        unidentifiable_directions(problem, &found.best, &free, found.inefficiency, watcher);
    // A coefficient of a term without hidden states has the doubt `uncertain-coefficient` instead.
    let alone = |p: &Parameter| match p {
        Parameter::Coefficient(j) => !problem.system.mentions_hidden(problem.term(*j)),
        Parameter::Constant(_) => false,
    };
    let one_measured = |d: &&Vec<(Parameter, f64)>| matches!(&d[..], [(p, _)] if alone(p));
    for direction in directions.iter().filter(|d| !one_measured(d)) {
        let names: Vec<(String, f64)> = (direction.iter())
            .map(|(p, power)| (named(model, problem, constants, *p), *power))
            .collect();
        let reason = unidentifiable(&names, problem.system.hidden.is_empty());
        let first = direction.iter().find_map(|(p, _)| match p {
            Parameter::Coefficient(j) => {
                Some(problem.system.laws[problem.system.law_of(*j)].target)
            }
            Parameter::Constant(_) => None,
        });
        let target = first.or(problem.system.laws.first().map(|l| l.target));
        let mut all = discovery.equations.iter_mut();
        if let Some(equation) = all.find(|e| Some(e.target) == target) {
            equation.doubt(reason);
        }
    }
    let tie = TERM_SELECTION.tie * found.inefficiency;
    let lags = exchanged_lags(problem, found, tie, watcher);
    let text = match lags.map(|twin| laws(model, problem, &twin.point.active())) {
        Some(written) => Some(format!(
            "the readings do not tell in which order lags follow each other: {written} follow them as well"
        )),
        None => exchanged_constants(problem, found, constants, tie, watcher).map(|twin| {
            let values = values_of(model, &twin.constants);
            let with = match laws(model, problem, &twin.terms) {
                laws if laws.is_empty() => String::new(),
                laws => format!(" with {laws}"),
            };
            format!(
                "the readings are followed as well by other values in the same laws: {values}{with}"
            )
        }),
    };
    if let Some(text) = text {
        let way = "state one of the coefficients, as `known(…)`, or measure what is hidden";
        let reason = Reason::new(ReasonCode::Tie, text).remedy(way);
        discovery.doubt_each(|_, _| Some(reason.clone()));
    }
}

/// Doubts constants of which other values follow the readings as well, with the same terms.
pub(crate) fn doubt_twins(model: &Model, twins: &[Constants], discovery: &mut Discovery) {
    let Some(twin) = twins.first() else { return };
    let known = discovery.doubt_codes();
    if known.contains(&ReasonCode::Tie) || known.contains(&ReasonCode::Unidentifiable) {
        return;
    }
    let values = values_of(model, twin.sought());
    let text =
        format!("the readings are followed as well by other values in the same laws: {values}");
    let way = "narrow a range, state one of the constants, or measure what is hidden";
    let reason = Reason::new(ReasonCode::Tie, text).remedy(way);
    discovery.doubt_each(|_, _| Some(reason.clone()));
}

fn values_of(model: &Model, constants: &[SoughtConstant]) -> String {
    let value = |c: &SoughtConstant| significant(c.value, FIGURES);
    let named = constants.iter();
    let named = named.map(|c| format!("{} = {}", model.name(c.signal), value(c)));
    named.collect::<Vec<_>>().join(", ")
}

fn unidentifiable(moves: &[(String, f64)], nothing_hidden: bool) -> Reason {
    let text = match moves {
        [(name, _)] if nothing_hidden => {
            format!(
                "the readings do not tell {name}: near the value found nothing that is read depends on it"
            )
        }
        [(name, _)] => format!(
            "the readings do not tell {name}: {ANY_SCALE}, and nothing that is read changes"
        ),
        _ => format!(
            "the readings do not tell these parameters one by one: {}",
            changes_nothing(moves)
        ),
    };
    let reason = Reason::new(ReasonCode::Unidentifiable, text);
    match nothing_hidden {
        true => reason
            .remedy("state one of the parameters, or record where the terms that hold them bend"),
        false => reason,
    }
}

pub(super) const ANY_SCALE: &str = "a hidden state may have any scale beside it";

/// Per cent along a direction, for a step in which the parameter that changes most doubles or halves.
fn changes_nothing(moves: &[(String, f64)]) -> String {
    let told = |(name, power): &(String, f64)| {
        let by = 100.0 * (2.0_f64.powf(*power) - 1.0);
        let way = if by > 0.0 { "rises" } else { "falls" };
        format!("{name} {way} by {} %", significant(by.abs(), 2))
    };
    let moves: Vec<String> = moves.iter().map(told).collect();
    format!("nothing that is read changes where {}", moves.join(" and "))
}

fn named(
    model: &Model,
    problem: &Problem,
    constants: &[SoughtConstant],
    parameter: Parameter,
) -> String {
    match parameter {
        Parameter::Constant(k) => {
            let run = constants[k].run.and_then(|run| problem.names.get(run));
            let name = model.name(constants[k].signal);
            run.map_or(name.clone(), |run| format!("{name} of {run}"))
        }
        Parameter::Coefficient(j) => coefficient(model, problem, j),
    }
}

pub(super) fn coefficient(model: &Model, problem: &Problem, column: usize) -> String {
    let target = problem.system.laws[problem.system.law_of(column)].target;
    let term = Language(model).term(problem.term(column));
    format!("coef({}, {term})", model.name(target))
}

/// The searched laws of columns with coefficients, on one line.
fn laws(model: &Model, problem: &Problem, active: &[(usize, f64)]) -> String {
    let searched = problem.system.laws.iter().filter(|l| !l.columns.is_empty());
    let law = |l: &crate::trajectory::Law| {
        let own = active.iter().filter(|(j, _)| l.columns.contains(j));
        let terms = own.map(|(j, a)| (*a, problem.term(*j)));
        let right = Language(model).sum(terms, FIGURES);
        format!("{} = {right}", model.name(l.target))
    };
    searched.map(law).collect::<Vec<_>>().join(" with ")
}
