//! What speaks for itself of all figures: causes, in order, with what to do about each.
//!
//! In: a frame, its relations, its equivalent supports. Out: [`Finding`]s, the leading one first. What bears on the equation that was
//! found is marked, and said unasked; the rest is for those who ask.

use super::advice::{Exchange, advice};
use super::cause::{Reason, Reduced};
use super::frame::Frame;
use super::shortfall::{Shortfall, shortfall};
use super::tell::{figure, percent, sentence, why};
use crate::discover::{Cause, Finding, Status};
use crate::library::Library;
use crate::term::{Language, SignalNames, Term};

/// Rest under which a relation holds exactly, as far as coefficients are concerned.
const EXACT: f64 = 1e-6;
/// Rows that it takes to choose k of N terms: this many times k ln N (Candès & Wakin 2008 have the order).
const ROWS_A_CHOICE: f64 = 10.0;
/// Standard error over coefficient above which a term could as well be absent, and what it should fall to.
const UNCERTAIN: f64 = 0.3;
const WANTED: f64 = 0.1;
/// Doubts that say that something is not explained.
const UNEXPLAINED: [&str; 8] = [
    "misfit",
    "poor-fit",
    "not-sparse",
    "exhausted-library",
    "held-out",
    "inconsistent-rows",
    "solver-inaccurate",
    "coloured-residuals",
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

pub(super) fn findings(frame: &Frame, library: &Library, told: &[Told]) -> Vec<Finding> {
    let mut all = Vec::new();
    all.extend(few_rows(frame));
    let mut order: Vec<&Told> = told.iter().collect();
    order.sort_by_key(|t| (!matters(t), t.reduced.size > EXACT, t.reason.cause));
    let (first, rest): (Vec<&Told>, Vec<&Told>) =
        (order.into_iter()).partition(|t| t.reason.cause == Cause::WrongOrder);
    all.extend(first.iter().map(|t| of_relation(frame, t)));
    let unexplained = |r: &crate::discover::Reason| UNEXPLAINED.contains(&r.code.as_str());
    if frame.equation.reasons.iter().any(unexplained) {
        all.extend(lacking(frame, library));
    }
    all.extend(rest.iter().map(|t| of_relation(frame, t)));
    all.extend(weak(frame));
    all
}

/// Whether a relation bears on the equation that was found.
fn matters(t: &Told) -> bool {
    let exact = t.reduced.size < EXACT;
    let exchanged = t.exchange.is_some();
    match t.reason.cause {
        Cause::Conserved | Cause::WrongOrder => exchanged || (exact && t.concerns),
        _ => exchanged,
    }
}

fn of_relation(frame: &Frame, t: &Told) -> Finding {
    let lead = t.touches.first();
    let advice = match (&t.exchange, matters(t)) {
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
            sentence(frame, &t.reduced, lead),
            why(frame, &t.reason)
        ),
        advice: text,
        reach,
        matters: matters(t),
    }
}

/// Fewer rows than terms, and fewer than a choice among so many takes.
fn few_rows(frame: &Frame) -> Option<Finding> {
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
fn step(frame: &Frame) -> Option<f64> {
    let time = &frame.all.time;
    let mut steps: Vec<f64> = time.windows(2).map(|w| w[1] - w[0]).collect();
    steps.retain(|s| *s > 0.0);
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied()
}

fn lacking(frame: &Frame, library: &Library) -> Option<Finding> {
    let (shortfall, part) = shortfall(frame, library)?;
    let target = frame.model.name(frame.equation.target);
    let open = percent(part);
    Some(match shortfall {
        Shortfall::Term(term, factor) => {
            let term = Language(frame.model).term(&term);
            Finding {
                cause: Cause::MissingTerm,
                text: format!(
                    "the whole library leaves {open} of {target}; {term}, which it lacks, would leave {} times less",
                    figure(factor, 2)
                ),
                advice: format!("add {term} to the library"),
                reach: None,
                matters: true,
            }
        }
        Shortfall::Order(rest) => {
            let var = frame.equation.target.var;
            let order = frame.equation.target.der + 1;
            Finding {
                cause: Cause::WrongOrder,
                text: format!(
                    "the whole library leaves {open} of {target}, but all except {} of its derivative follows from it: {} moves by a \
                     law of order {order} or more",
                    percent(rest),
                    frame.model.variable(var)
                ),
                advice: format!("declare {} with order {order}", frame.model.variable(var)),
                reach: None,
                matters: true,
            }
        }
        Shortfall::Unknown => Finding {
            cause: Cause::MissingTerm,
            text: format!("the whole library leaves {open} of {target}, and no simple term of the measured signals explains it"),
            advice: "look for an input or a state that is not measured".into(),
            reach: None,
            matters: true,
        },
    })
}

/// Terms whose coefficients could as well be zero.
fn weak(frame: &Frame) -> Vec<Finding> {
    let seconds = frame.all.time.len() as f64 * step(frame).unwrap_or(0.0);
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
