//! Findings: what makes an equation hard to find from these data, the leading cause first, each with advice.
//!
//! In: a design, its relations. Out: [`Finding`]s. Those that matter to the equation found are marked, and printed unasked.

use super::advice::{Exchange, advice};
use super::messages::{figure, percent, sentence, why};
use super::misspecification::{Misspecification, Specification, find_misspecification};
use super::unread_signals::{ReadAndUnread, what_to_look_for};
use crate::doubts::regression_rules::times;
use crate::doubts::thresholds::DOUBTS;
use crate::identifiability::collinearity::relation::ExplainedRelation;
use crate::identifiability::thresholds::{COLLINEARITY, FINDINGS};
use crate::scaled_design::ScaledDesign;
use sidc_data::median;
use sidc_lang::library::Library;
use sidc_lang::model::{Model, VarKind};
use sidc_lang::term::{Language, Signal, SignalNames};
use sidc_system::discovery::{Cause, Change, Finding, Reason, ReasonCode, Status};

/// Doubts that say that something is not explained.
pub const UNEXPLAINED: [ReasonCode; 9] = [
    ReasonCode::Misfit,
    ReasonCode::PoorFit,
    ReasonCode::NotSparse,
    ReasonCode::ExhaustedLibrary,
    ReasonCode::HeldOut,
    ReasonCode::InconsistentRows,
    ReasonCode::SolverInaccurate,
    ReasonCode::ColouredResiduals,
    ReasonCode::NoTrajectory,
];

/// The rows of `columns` have the measured target, where those of the design are of a fit.
pub fn findings(
    design: &ScaledDesign,
    library: &Library,
    columns: ReadAndUnread,
    relations: &[ExplainedRelation],
) -> Vec<Finding> {
    let mut all = Vec::new();
    all.extend(too_few_rows(design));
    let mut order: Vec<&ExplainedRelation> = relations.iter().collect();
    order.sort_by_key(|t| (!matters(design, t), !holds(design, t), t.why.cause));
    let (wrong_order, others): (Vec<&ExplainedRelation>, Vec<&ExplainedRelation>) =
        (order.into_iter()).partition(|t| t.why.cause == Cause::WrongOrder);
    all.extend(wrong_order.iter().map(|t| relation_finding(design, t)));
    if wrong_order.is_empty() && design.equation.status == Status::Doubt {
        all.extend(misspecification(design, library, columns));
    }
    all.extend(zero_columns(design, &all));
    all.extend(others.iter().map(|t| relation_finding(design, t)));
    all.extend(uncertain_terms(design));
    all
}

/// Whether a relation holds as far as the data can tell.
fn holds(design: &ScaledDesign, t: &ExplainedRelation) -> bool {
    t.reduced.residual < design.noise.relative.max(COLLINEARITY.exact)
}

/// Whether a relation bears on the equation that was found.
fn matters(design: &ScaledDesign, t: &ExplainedRelation) -> bool {
    let doubted = design.equation.status == Status::Doubt;
    match t.why.cause {
        // Where refits of the trajectory decided, an exchange on its rows alone is only a hint.
        _ if t.exchange.is_some() => doubted,
        Cause::Conserved => holds(design, t) && t.involves_support,
        Cause::WrongOrder => holds(design, t) && (doubted || t.involves_support),
        _ => false,
    }
}

/// The doubt `relation`: a law of lower order holds on these data for signals of the terms found. Laws that differ by multiples of it
/// fit alike, and its derivative can pass for the law.
pub fn relation_doubt(design: &ScaledDesign, relations: &[ExplainedRelation]) -> Option<Reason> {
    let bears = |t: &&ExplainedRelation| {
        t.why.cause == Cause::WrongOrder && shares_signals(design, t) && !has_target(design, t)
    };
    let found = relations.iter().filter(|t| holds(design, t)).find(bears)?;
    Some(
        Reason::new(
            ReasonCode::Relation,
            format!(
                "along these data {}: {}, and laws that differ by multiples of it fit alike",
                sentence(design, &found.reduced, found.left_term().as_ref()),
                why(design, &found.why),
            ),
        )
        .remedy(advice(design, &found.why, None).text),
    )
}

/// Whether the relation contains a target: then it may be the laws of the system with one target eliminated.
fn has_target(design: &ScaledDesign, t: &ExplainedRelation) -> bool {
    let targets: Vec<Signal> = design.model.equations.iter().map(|e| e.target).collect();
    t.reduced.signals().iter().any(|s| targets.contains(s))
}

/// Whether the relation and the terms found have signals in common.
fn shares_signals(design: &ScaledDesign, t: &ExplainedRelation) -> bool {
    let signals = t.reduced.signals();
    let mut support = design.support.iter().map(|p| design.term(*p));
    support.any(|term| signals.iter().any(|s| term.mentions(*s)))
}

/// Signals that are zero on every row, and with them columns of the library.
fn zero_columns(design: &ScaledDesign, known: &[Finding]) -> Option<Finding> {
    let mut zero: Vec<Signal> = Vec::new();
    for term in &design.zero_columns {
        term.for_each_signal(&mut |s| {
            let is_zero = |c: &sidc_data::Column| c.values.iter().all(|v| *v == 0.0);
            if design.samples.column(s).is_some_and(is_zero) && !zero.contains(&s) {
                zero.push(s);
            }
        });
    }
    if zero.is_empty() || !known.is_empty() {
        return None;
    }
    let names: Vec<String> = zero.iter().map(|s| design.model.name(*s)).collect();
    let count = design.zero_columns.len();
    Some(Finding {
        cause: Cause::ConstantSignal,
        text: format!(
            "{} is 0 on every row, and so {} of the library's terms: none of them can be found",
            names.join(" and "),
            count
        ),
        advice: format!("move {}", names.join(" and ")),
        change: None,
        reach: None,
        matters: design.equation.status == Status::Doubt,
    })
}

fn relation_finding(design: &ScaledDesign, t: &ExplainedRelation) -> Finding {
    let left = t.left_term();
    let advice = match (&t.exchange, matters(design, t)) {
        (Some((leaving, entering)), _) => {
            let kept = design.support.iter().map(|p| design.term(*p).clone());
            let exchange = Exchange {
                leaving,
                entering,
                kept: kept.filter(|k| k != leaving).collect(),
            };
            Some(advice(design, &t.why, Some(&exchange)))
        }
        (None, true) => Some(advice(design, &t.why, None)),
        (None, false) => None,
    };
    let (text, reach) = advice.map_or((String::new(), None), |a| (a.text, a.reach));
    Finding {
        cause: t.why.cause,
        text: format!(
            "{}: {}",
            sentence(design, &t.reduced, left.as_ref()),
            why(design, &t.why)
        ),
        advice: text,
        change: None,
        reach,
        matters: matters(design, t),
    }
}

/// Fewer rows than terms, and fewer than the selection among so many terms needs.
fn too_few_rows(design: &ScaledDesign) -> Option<Finding> {
    let (m, n, k) = (
        design.rows(),
        design.candidates,
        design.support.len().max(1),
    );
    let wanted = (FINDINGS.rows_per_choice * k as f64 * (n.max(2) as f64).ln()).ceil() as usize;
    if m >= n || m >= wanted {
        return None;
    }
    let more = wanted.min(FINDINGS.max_rows_per_term * n).max(m + 1) - m;
    let seconds = median_step(design).map(|s| s * more as f64);
    let time = seconds.map_or_else(String::new, |s| {
        format!(" ({} {} more)", figure(s, 2), design.model.time_unit())
    });
    Some(Finding {
        cause: Cause::TooFewRows,
        text: format!("{m} rows for {n} terms: many sets of terms fit them"),
        advice: format!("record {more} rows more{time}, or leave terms out"),
        change: None,
        reach: Some(more as f64),
        matters: design.equation.status == Status::Doubt,
    })
}

/// The median time between rows of the record.
fn median_step(design: &ScaledDesign) -> Option<f64> {
    let time = &design.all_samples.time;
    let mut steps: Vec<f64> = time.windows(2).map(|w| w[1] - w[0]).collect();
    steps.retain(|s| *s > 0.0);
    median(&mut steps)
}

/// What is wrong with the library or the order, if something is unexplained.
fn misspecification(
    design: &ScaledDesign,
    library: &Library,
    columns: ReadAndUnread,
) -> Option<Finding> {
    let unexplained = |r: &Reason| UNEXPLAINED.contains(&r.code);
    let specification = Specification {
        model: design.model,
        library,
        equation: design.equation,
        unexplained: design.equation.reasons.iter().any(unexplained),
    };
    let found = find_misspecification(&specification, columns.0)?;
    let target = design.equation.target;
    Some(misspecification_finding(
        design.model,
        target,
        &found,
        columns,
    ))
}

/// A misspecification in words, of an equation that was sought on these samples.
pub fn misspecification_finding(
    model: &Model,
    target: Signal,
    found: &Misspecification,
    columns: ReadAndUnread,
) -> Finding {
    let var = model.variable(target.var);
    let name = model.name(target);
    let finding = |cause, text, advice, change: Option<Vec<String>>| Finding {
        cause,
        text,
        advice,
        change: change.map(Change::Model),
        reach: None,
        matters: true,
    };
    match found {
        Misspecification::MissingTerm { term, factor, part } => {
            let term = Language(model).term(term);
            let stated = model.equations.iter().find(|e| e.target == target);
            let line = stated.map(|e| vec![e.with(std::slice::from_ref(&term))]);
            finding(
                Cause::MissingTerm,
                format!(
                    "the whole library leaves {} of {name}; {term}, which it lacks, would leave {} times less",
                    percent(*part),
                    match *factor < 10.0 {
                        true => figure(*factor, 2),
                        false => times(*factor),
                    }
                ),
                format!("add {term} to the library"),
                line,
            )
        }
        Misspecification::OrderTooLow { residual, part } => {
            let order = target.der + 1;
            finding(
                Cause::WrongOrder,
                format!(
                    "the whole library leaves {} of {name}, but all except {} of its derivative follows from it: {var} moves as by a law \
                     of order {order} or more",
                    percent(*part),
                    percent(*residual)
                ),
                format!(
                    "declare {var} with order {order} and look for {}, with {name} among its terms",
                    model.name(Signal::derivative(target.var, order))
                ),
                of_higher_order(model, target),
            )
        }
        Misspecification::OrderTooHigh { residual } => {
            let order = target.der - 1;
            let lower = model.name(Signal::derivative(target.var, order));
            finding(
                Cause::WrongOrder,
                format!(
                    "the library's terms without {lower} give all of it but {}: {var} moves by a law of order {order}",
                    percent(*residual)
                ),
                format!(
                    "declare {var} with order {order}, or excite it so that {lower} moves on its own"
                ),
                None,
            )
        }
        Misspecification::Unknown { part } => {
            let (advice, line) = what_to_look_for(model, target, columns);
            finding(
                Cause::MissingTerm,
                format!(
                    "the whole library leaves {} of {name}, and no simple term of the signals that are used explains it",
                    percent(*part)
                ),
                advice,
                line,
            )
        }
    }
}

/// The lines of a model of one state with an order more: its declaration, and the equation of its next derivative.
fn of_higher_order(model: &Model, target: Signal) -> Option<Vec<String>> {
    let states = model.vars.iter().filter(|v| v.kind == VarKind::State);
    let stated = model.equations.iter().find(|e| e.target == target)?;
    let (left, right) = stated.written.split_once('~')?;
    let (name, order) = (model.name(target), target.der + 1);
    let next = model.name(Signal::derivative(target.var, order));
    let simple = states.count() == 1 && left.trim() == name;
    let declared = model.var(target.var).is_some_and(|v| v.order >= order);
    let declaration = format!("state {} : order {order}", model.variable(target.var));
    let mut lines: Vec<String> = (!declared).then_some(declaration).into_iter().collect();
    lines.push(format!("{next} ~{right} + <{name}>"));
    simple.then_some(lines)
}

/// Terms whose coefficients could as well be zero.
fn uncertain_terms(design: &ScaledDesign) -> Vec<Finding> {
    let seconds = design.all_samples.time.len() as f64 * median_step(design).unwrap_or(0.0);
    let free = design.equation.terms.iter().filter(|t| !t.fixed);
    free.filter_map(|t| {
        let part = t.standard_error? / t.coefficient.abs();
        (part > DOUBTS.uncertain && part.is_finite()).then(|| {
            let times = (part / FINDINGS.wanted_error).powi(2);
            let more = seconds * (times - 1.0);
            let name = Language(design.model).term(&t.term);
            let larger = match t.term.is_one() {
                true => String::new(),
                false => format!(", or make {name} {} times larger", figure(times.sqrt(), 2)),
            };
            Finding {
                cause: Cause::WeakTerm,
                text: format!("the coefficient of {name} is known to {}", percent(part)),
                advice: format!(
                    "{} {} more of such data bring it to {}{larger}",
                    figure(more, 2),
                    design.model.time_unit(),
                    percent(FINDINGS.wanted_error),
                ),
                change: None,
                reach: Some(more),
                matters: true,
            }
        })
    })
    .collect()
}
