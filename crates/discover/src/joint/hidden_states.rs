//! States that nothing measured, as an answer tells them.
//!
//! In: an answer. Out: the same in the scale that is told; what is known of each hidden state, in the discovery. Fits no other terms.

use std::borrow::Cow;

use crate::joint::constrained_search::ConstrainedAnswer;
use crate::joint::joint_fit::JointFit;
use crate::trajectory::{ToldScale, with_told_scales};
use sidc_lang::model::Model;
use sidc_lang::term::{Language, Signal, SignalNames};
use sidc_progress::EquationObserver;
use sidc_system::discovery::{Discovery, HiddenStart, HiddenState, ScaleRule};

/// Gives the hidden states whose scale is free the one that is told.
pub(crate) fn settle_scales(
    answer: &mut ConstrainedAnswer,
    watcher: &mut EquationObserver,
) -> Vec<ToldScale> {
    if answer.fit.problem.system.hidden.is_empty() {
        return Vec::new();
    }
    let scaled = with_told_scales(&answer.fit.problem, &answer.fit.found, watcher);
    let Some((problem, found, told)) = scaled else {
        return Vec::new();
    };
    answer.fit.problem = Cow::Owned(problem);
    answer.fit.found = found;
    told
}

/// States the course of every hidden state.
pub(crate) fn state(
    model: &Model,
    fit: &JointFit,
    scales: &[ToldScale],
    discovery: &mut Discovery,
) {
    let problem = &fit.problem;
    let n = problem.states();
    let signals = problem.system.states.iter().enumerate();
    let hidden = signals.filter(|(i, _)| problem.system.is_hidden(*i));
    let told = hidden.map(|(i, signal)| {
        let along = |path: &Vec<f64>| -> Vec<f64> {
            path.iter().skip(i).step_by(n).copied().collect()
        };
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
fn starts(problem: &crate::trajectory::Problem, columns: &[Vec<f64>]) -> Vec<HiddenStart> {
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

fn rule(model: &Model, scales: &[ToldScale], signal: Signal) -> Option<ScaleRule> {
    let told = scales.iter().find(|s| s.state == signal)?;
    Some(ScaleRule {
        equation: model.name(told.target),
        term: Language(model).term(&told.term),
        coefficient: told.coefficient,
    })
}
