//! Inference on coefficients as text: intervals, marks, alternatives to a term, and the rule of the marks.
//!
//! In: an equation whose terms are marked. Out: lines. Judges nothing.

use crate::thresholds::PRINTED;
use sidc_lang::number::{distinguishing_digits, significant};
use sidc_lang::term::{Language, SignalNames};
use sidc_system::discovery::{
    Discovery, DropOneRefit, Equation, FoundTerm, MARKS, Mark, OmittedTerm, TermEvidence,
};

/// Names in a list before `and 4 more`.
const MAX_NAMED_TERMS: usize = 3;

/// A line for each term, then the term left out that comes nearest.
pub(crate) fn lines(d: &Discovery, e: &Equation) -> Vec<String> {
    let found = e
        .terms
        .iter()
        .filter_map(|t| Some((t, t.evidence.as_deref()?)));
    let halves = e.evidence.as_ref().and_then(|e| e.halves.as_ref());
    let drawn = halves.map_or(0, |h| h.drawn);
    let line = |(t, trust): (&FoundTerm, &TermEvidence)| {
        let mut figures = vec![trust.mark.name().to_string()];
        figures.extend(trust.interval.map(between));
        figures.extend(reasons(trust, drawn));
        format!("term {}: {}", Language(d).term(&t.term), figures.join(", "))
    };
    let mut lines: Vec<String> = found.map(line).collect();
    let nearest = e.evidence.as_ref().and_then(|e| e.omitted.as_ref());
    let nearest = nearest.filter(|n| n.earns > PRINTED.nearest && !lines.is_empty());
    lines.extend(nearest.map(missing));
    lines
}

/// `every term firm`, or which are not; `None` where nothing was marked.
pub(crate) fn firmness(d: &Discovery) -> Option<String> {
    let terms = d.equations.iter().flat_map(|e| {
        let marked = e
            .terms
            .iter()
            .filter_map(|t| Some((t, t.evidence.as_ref()?.mark)));
        marked.map(move |(t, mark)| (e.target, t, mark))
    });
    let terms: Vec<_> = terms.collect();
    let open: Vec<String> = (terms.iter().filter(|(_, _, mark)| *mark != Mark::Firm))
        .map(|(target, t, _)| format!("{} in {}", Language(d).term(&t.term), d.name(*target)))
        .collect();
    let firm = terms.len() - open.len();
    match (terms.len(), open.len()) {
        (0, _) => None,
        (_, 0) => Some("every term is firm".into()),
        _ if terms.iter().all(|t| t.2 == Mark::Likely) => Some("every term is likely".into()),
        (_, _) if firm == 0 => Some("no term is firm".into()),
        (all, _) => Some(format!(
            "{firm} of {all} terms firm, not {}",
            several(&open)
        )),
    }
}

/// `left out: x^2 would earn 9.8 where a term costs 11; 1.7 times as much data would decide`
fn missing(n: &OmittedTerm) -> String {
    let mut line = format!(
        "left out: {} would earn {} where a term costs {}",
        n.terms.join(" or "),
        significant(n.earns, 2),
        significant(n.costs, 2),
    );
    if n.longer > 1.0 {
        let times = significant(n.longer, 2);
        line.push_str(&format!(
            "; {times} times as much of such data would decide"
        ));
    }
    line
}

/// The rule of the marks, where there are any.
pub(crate) fn rule(d: &Discovery) -> Option<String> {
    let mut terms = d.equations.iter().flat_map(|e| &e.terms);
    terms.any(|t| t.evidence.is_some()).then(|| {
        format!(
            "firm: 95 % interval without 0, found in {:.0} % of half records or more, at least {} lost without it, equation passes; \
             doubtful: interval with 0, found in under {:.0} %, or less than {} lost; likely: the rest",
            100.0 * MARKS.stable,
            MARKS.cost,
            100.0 * MARKS.unstable,
            MARKS.tied
        )
    })
}

/// An interval with the digits that its width determines.
fn between((low, high): (f64, f64)) -> String {
    let digits = distinguishing_digits(low, high);
    format!(
        "95 % {} to {}",
        significant(low, digits),
        significant(high, digits)
    )
}

fn reasons(trust: &TermEvidence, drawn: usize) -> Vec<String> {
    let mut all = Vec::new();
    if let Some((low, high)) = trust.interval
        && low <= 0.0
        && high >= 0.0
    {
        all.push("0 is in its interval".into());
    }
    if let Some(share) = trust.stability {
        let times = (share * drawn as f64).round();
        all.push(format!("in {times} of {drawn} half records"));
    }
    let without = trust.without.as_ref().map(without);
    all.extend(without.map(|w| format!("without it: {w}")));
    all
}

/// `x, x^2 and 4 more`
fn several(names: &[String]) -> String {
    let (shown, more) = names.split_at(names.len().min(MAX_NAMED_TERMS));
    match more.len() {
        0 => shown.join(" and "),
        more => format!("{} and {more} more", shown.join(", ")),
    }
}

/// The equation without a term: `x^2 instead, 14 lost`.
pub fn without(w: &DropOneRefit) -> String {
    let mut parts = Vec::new();
    if !w.enter.is_empty() {
        parts.push(format!("{} instead", several(&w.enter)));
    }
    if !w.leave.is_empty() {
        parts.push(format!("no longer {}", several(&w.leave)));
    }
    parts.push(match w.cost {
        _ if w.same => "which is the same".into(),
        cost if cost >= PRINTED.large_loss => "over 1000 lost".into(),
        cost if cost < 0.0 => format!("{} won", significant(-cost, 2)),
        cost => format!("{} lost", significant(cost, 2)),
    });
    parts.join(", ")
}
