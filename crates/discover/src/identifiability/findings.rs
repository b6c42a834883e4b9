//! What speaks for itself of all figures: causes, in order, with what to do about each.
//!
//! In: a frame, its relations, its equivalent supports. Out: [`Finding`]s, the leading one first. What bears on the equation that was
//! found is marked, and said unasked; the rest is for those who ask.

use super::advice::{Exchange, advice};
use super::cause::{Reason, Reduced};
use super::shortfall::{Asked, Shortfall, shortfall};
use super::tell::{figure, percent, sentence, why};
use crate::scaled_design::ScaledDesign;
use sidc_data::Samples;
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_lang::term::{Language, Signal, SignalNames, Term};
use sidc_system::discovery::{Cause, Finding, Reason as Doubt, ReasonCode, Status};

/// Rest under which a relation holds exactly, as far as coefficients are concerned.
const EXACT: f64 = 1e-6;
/// Rows that it takes to choose k of N terms: this many times k ln N (Candès & Wakin 2008 have the order).
const ROWS_A_CHOICE: f64 = 10.0;
/// Standard error over coefficient above which a term could as well be absent, and what it should fall to.
const UNCERTAIN: f64 = 0.3;
const WANTED: f64 = 0.1;
/// Doubts that say that something is not explained.
pub(super) const UNEXPLAINED: [ReasonCode; 9] = [
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

/// A relation with all that is known of it.
pub(super) struct Told {
    pub reduced: Reduced,
    pub reason: Reason,
    /// Terms of the support that stand in it.
    pub touches: Vec<Term>,
    /// The exchange that it allows: what goes, what comes.
    pub exchange: Option<(Term, Term)>,
    /// States of the support stand in it, if it is of signals.
    pub concerns: bool,
}

impl Told {
    /// The term that stands on the left: the derivative that is given by lower ones, or a term of the equation.
    pub fn lead(&self) -> Option<Term> {
        match (&self.reason.about, self.reason.cause) {
            (Some((about, _, _)), Cause::WrongOrder) => Some(about.clone().into_term().1),
            _ => self.touches.first().cloned(),
        }
    }
}

/// `read` are rows with the target as it was read, where the frame's are those of a fit.
pub(super) fn findings(
    frame: &ScaledDesign,
    library: &Library,
    read: &Samples,
    told: &[Told],
) -> Vec<Finding> {
    let mut all = Vec::new();
    all.extend(few_rows(frame));
    let mut order: Vec<&Told> = told.iter().collect();
    order.sort_by_key(|t| (!matters(frame, t), !holds(frame, t), t.reason.cause));
    let (first, rest): (Vec<&Told>, Vec<&Told>) =
        (order.into_iter()).partition(|t| t.reason.cause == Cause::WrongOrder);
    all.extend(first.iter().map(|t| of_relation(frame, t)));
    if first.is_empty() && frame.equation.status == Status::Doubt {
        all.extend(lacking(frame, library, read));
    }
    all.extend(idle(frame, &all));
    all.extend(rest.iter().map(|t| of_relation(frame, t)));
    all.extend(weak(frame));
    all
}

/// Whether a relation holds as far as the data can tell.
fn holds(frame: &ScaledDesign, t: &Told) -> bool {
    t.reduced.size < frame.noise.relative.max(EXACT)
}

/// Whether a relation bears on the equation that was found.
fn matters(frame: &ScaledDesign, t: &Told) -> bool {
    let doubted = frame.equation.status == Status::Doubt;
    match t.reason.cause {
        // Where refits decided, an exchange on the fitted trajectory alone is no more than a hint.
        _ if t.exchange.is_some() => doubted,
        Cause::Conserved => holds(frame, t) && t.concerns,
        Cause::WrongOrder => holds(frame, t) && (doubted || t.concerns),
        _ => false,
    }
}

/// Signals without which columns of the library are zero.
fn idle(frame: &ScaledDesign, known: &[Finding]) -> Option<Finding> {
    let mut still: Vec<Signal> = Vec::new();
    for term in &frame.zero_columns {
        term.for_each_signal(&mut |s| {
            let zero = |c: &sidc_data::Column| c.values.iter().all(|v| *v == 0.0);
            if frame.samples.column(s).is_some_and(zero) && !still.contains(&s) {
                still.push(s);
            }
        });
    }
    if still.is_empty() || !known.is_empty() {
        return None;
    }
    let names: Vec<String> = still.iter().map(|s| frame.model.name(*s)).collect();
    let count = frame.zero_columns.len();
    Some(Finding {
        cause: Cause::ConstantSignal,
        text: format!(
            "{} is 0 on every row, and so {} of the library's terms: none of them can be found",
            names.join(" and "),
            count
        ),
        advice: format!("let {} move", names.join(" and ")),
        reach: None,
        matters: frame.equation.status == Status::Doubt,
    })
}

fn of_relation(frame: &ScaledDesign, t: &Told) -> Finding {
    let lead = t.lead();
    let advice = match (&t.exchange, matters(frame, t)) {
        (Some((out, into)), _) => {
            let kept = frame.support.iter().map(|p| frame.term(*p).clone());
            let exchange = Exchange {
                out,
                into,
                kept: kept.filter(|k| k != out).collect(),
            };
            Some(advice(frame, &t.reason, Some(&exchange)))
        }
        (None, true) => Some(advice(frame, &t.reason, None)),
        (None, false) => None,
    };
    let (text, reach) = advice.map_or((String::new(), None), |a| (a.text, a.reach));
    Finding {
        cause: t.reason.cause,
        text: format!(
            "{}: {}",
            sentence(frame, &t.reduced, lead.as_ref()),
            why(frame, &t.reason)
        ),
        advice: text,
        reach,
        matters: matters(frame, t),
    }
}

/// Fewer rows than terms, and fewer than a choice among so many takes.
fn few_rows(frame: &ScaledDesign) -> Option<Finding> {
    let (m, n, k) = (frame.rows(), frame.candidates, frame.support.len().max(1));
    let wanted = (ROWS_A_CHOICE * k as f64 * (n.max(2) as f64).ln()).ceil() as usize;
    if m >= n || m >= wanted {
        return None;
    }
    let more = wanted.min(3 * n).max(m + 1) - m;
    let seconds = step(frame).map(|s| s * more as f64);
    let time = seconds.map_or_else(String::new, |s| format!(" ({} s more)", figure(s, 2)));
    Some(Finding {
        cause: Cause::TooFewRows,
        text: format!("{m} rows for {n} terms: many sets of terms fit them"),
        advice: format!("record {more} rows more{time}, or leave terms out"),
        reach: Some(more as f64),
        matters: frame.equation.status == Status::Doubt,
    })
}

/// Typical time between rows of the record.
fn step(frame: &ScaledDesign) -> Option<f64> {
    let time = &frame.all_samples.time;
    let mut steps: Vec<f64> = time.windows(2).map(|w| w[1] - w[0]).collect();
    steps.retain(|s| *s > 0.0);
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied()
}

/// What the library lacks, as far as a doubt asks for it.
fn lacking(frame: &ScaledDesign, library: &Library, read: &Samples) -> Option<Finding> {
    let unexplained = |r: &Doubt| UNEXPLAINED.contains(&r.code);
    let asked = Asked {
        library,
        equation: frame.equation,
        unexplained: frame.equation.reasons.iter().any(unexplained),
    };
    let shortfall = shortfall(&asked, read)?;
    Some(told(frame.model, frame.equation.target, &shortfall))
}

/// A shortfall in words.
pub(super) fn told(model: &Model, target: Signal, shortfall: &Shortfall) -> Finding {
    let var = model.variable(target.var);
    let name = model.name(target);
    let finding = |cause, text, advice| Finding {
        cause,
        text,
        advice,
        reach: None,
        matters: true,
    };
    match shortfall {
        Shortfall::Term { term, factor, part } => {
            let term = Language(model).term(term);
            finding(
                Cause::MissingTerm,
                format!(
                    "the whole library leaves {} of {name}; {term}, which it lacks, would leave {} times less",
                    percent(*part),
                    figure(*factor, 2)
                ),
                format!("add {term} to the library"),
            )
        }
        Shortfall::Higher { rest, part } => {
            let order = target.der + 1;
            finding(
                Cause::WrongOrder,
                format!(
                    "the whole library leaves {} of {name}, but all except {} of its derivative follows from it: {var} moves as by a law \
                     of order {order} or more",
                    percent(*part),
                    percent(*rest)
                ),
                format!("declare {var} with order {order}"),
            )
        }
        Shortfall::Lower { rest } => {
            let order = target.der - 1;
            let lower = model.name(Signal::derivative(target.var, order));
            finding(
                Cause::WrongOrder,
                format!(
                    "the library's terms without {lower} give all of it but {}: {var} moves by a law of order {order}",
                    percent(*rest)
                ),
                format!(
                    "declare {var} with order {order}, or excite it so that {lower} moves on its own"
                ),
            )
        }
        Shortfall::Unknown { part } => finding(
            Cause::MissingTerm,
            format!(
                "the whole library leaves {} of {name}, and no simple term of the measured signals explains it",
                percent(*part)
            ),
            "look for an input or a state that is not measured".into(),
        ),
    }
}

/// Terms whose coefficients could as well be zero.
fn weak(frame: &ScaledDesign) -> Vec<Finding> {
    let seconds = frame.all_samples.time.len() as f64 * step(frame).unwrap_or(0.0);
    let free = frame.equation.terms.iter().filter(|t| !t.fixed);
    free.filter_map(|t| {
        let part = t.standard_error? / t.coefficient.abs();
        (part > UNCERTAIN && part.is_finite()).then(|| {
            let times = (part / WANTED).powi(2);
            let more = seconds * (times - 1.0);
            let name = Language(frame.model).term(&t.term);
            Finding {
                cause: Cause::WeakTerm,
                text: format!("the coefficient of {name} is known to {}", percent(part)),
                advice: format!(
                    "{} s more of such data bring it to {}, or let {name} be {} times larger",
                    figure(more, 2),
                    percent(WANTED),
                    figure(times.sqrt(), 2)
                ),
                reach: Some(more),
                matters: true,
            }
        })
    })
    .collect()
}
