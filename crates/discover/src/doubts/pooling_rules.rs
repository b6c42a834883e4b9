//! Doubts about several runs of one plant: runs that the laws do not follow, coefficients that differ from run to run.
//!
//! In: what the estimate of all runs found. Out: reasons. Never changes an equation.

use crate::trajectory::{Differing, Problem, RunNotFollowed};
use sidc_lang::model::Model;
use sidc_lang::number::rounded;
use sidc_lang::term::{Language, SignalNames};
use sidc_lang::words::listed;
use sidc_system::discovery::{
    Change, Discovery, Equation, FoundTerm, Reason, ReasonCode, RunCoefficient,
};

/// The doubt `run-not-followed` for the runs that the equations were not found from.
pub(crate) fn not_followed(
    problem: &Problem,
    used: &[usize],
    left: &[RunNotFollowed],
    time_unit: &str,
) -> Option<Reason> {
    let name = |t: usize| problem.names.get(t).map_or("?", String::as_str);
    let place = |l: &RunNotFollowed| match l.time {
        Some(time) => format!(
            "{} at {} {time_unit}",
            name(l.trajectory),
            rounded(time, DIGITS)
        ),
        None => name(l.trajectory).to_owned(),
    };
    let places: Vec<String> = left.iter().map(place).collect();
    if places.is_empty() {
        return None;
    }
    let used: Vec<&str> = used.iter().map(|t| name(*t)).collect();
    let (alone, first) = (listed(&used), &left[0]);
    let reason = Reason::new(
        ReasonCode::RunNotFollowed,
        format!(
            "the laws leave the readings of {}: they were found from {alone} alone",
            places.join(", of ")
        ),
    );
    let file = name(first.trajectory);
    Some(reason.remedy(match first.time {
        Some(time) => format!(
            "look at {file} from {} {time_unit} on: another plant, a sensor that fails, a motion of which the library lacks the physics; leave it out if it is none of this plant",
            rounded(time, DIGITS)
        ),
        None => format!("look at {file}, and leave it out if it is none of this plant"),
    }))
}

/// The doubt `runs-differ` of one coefficient that the model does not declare `per run`.
pub(crate) fn differs(
    (model, names): (&Model, &Discovery),
    problem: &Problem,
    found: &Differing,
) -> Reason {
    let values: Vec<RunCoefficient> = found
        .values
        .iter()
        .map(|v| RunCoefficient {
            run: problem.names.get(v.trajectory).cloned().unwrap_or_default(),
            coefficient: v.value,
            standard_error: Some(v.variance.sqrt()).filter(|e| e.is_finite()),
        })
        .collect();
    let law = &problem.system.laws[problem.system.law_of(found.column)];
    let coefficient = (
        model.name(law.target),
        Language(names).term(problem.term(found.column)),
    );
    let found = Some(found.gain);
    runs_differ(&coefficient, &values, found)
}

/// The doubt `runs-differ` of coefficients that the answer has for each run, although the model does not declare them
/// `per run`.
pub(crate) fn undeclared(model: &Model, names: &Discovery, equation: &Equation) -> Option<Reason> {
    let terms: Vec<&FoundTerm> = undeclared_terms(model, equation).collect();
    let target = model.name(equation.target);
    let term = |t: &FoundTerm| Language(names).term(&t.term);
    match terms.as_slice() {
        [] => None,
        [one] => Some(runs_differ(&(target, term(one)), &one.runs, None)),
        many => {
            let named: Vec<String> = many.iter().map(|t| term(t)).collect();
            let line = |t: &String| format!("coef({target}, {t})");
            let declared: Vec<String> = named.iter().map(line).collect();
            let line = format!("{} : per run", declared.join(", "));
            let named: Vec<&str> = named.iter().map(String::as_str).collect();
            let reason = Reason::new(
                ReasonCode::RunsDiffer,
                format!(
                    "the coefficients of {} in {target} differ from run to run; {TOGETHER}",
                    listed(&named)
                ),
            );
            Some(reason.change(
                format!("say that they may: {line}"),
                Change::Model(vec![line]),
            ))
        }
    }
}

/// Whether the answer has coefficients for each run that the model does not declare `per run`.
pub(crate) fn has_undeclared(model: &Model, discovery: &Discovery) -> bool {
    let mut equations = discovery.equations.iter();
    equations.any(|e| undeclared_terms(model, e).next().is_some())
}

fn undeclared_terms<'a>(
    model: &'a Model,
    equation: &'a Equation,
) -> impl Iterator<Item = &'a FoundTerm> {
    let declared = |t: &FoundTerm| {
        let mut all = model.per_run.iter();
        all.any(|c| c.target == equation.target && c.term == t.term)
    };
    let by_run = equation.terms.iter().filter(|t| !t.runs.is_empty());
    by_run.filter(move |t| !declared(t))
}

/// The doubt of one coefficient.
fn runs_differ(
    (target, term): &(String, String),
    values: &[RunCoefficient],
    gain: Option<f64>,
) -> Reason {
    let told: Vec<String> = values
        .iter()
        .map(|v| format!("{} in {}", v.figure(), v.run))
        .collect();
    let why = match gain {
        Some(gain) => format!("the criterion prefers that by {gain:.0}"),
        None => TOGETHER.into(),
    };
    Reason::new(
        ReasonCode::RunsDiffer,
        format!(
            "the coefficient of {term} in {target} differs from run to run: {}; {why}",
            told.join(", ")
        ),
    )
    .change(
        format!("say that it may: coef({target}, {term}) : per run"),
        Change::Model(vec![format!("coef({target}, {term}) : per run")]),
    )
}

/// Digits of a time.
const DIGITS: usize = 4;

const TOGETHER: &str = "with one value for all the runs cannot be followed together";
