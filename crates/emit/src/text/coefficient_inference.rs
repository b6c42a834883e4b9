//! Inference on coefficients as text: intervals, marks, alternatives to a term, and the rule of the marks.
//!
//! In: an equation whose terms are marked. Out: lines. Judges nothing.

use crate::thresholds::PRINTED;
use sidc_lang::number::{digits_apart, significant};
use sidc_lang::term::Language;
use sidc_system::discovery::{
    Discovery, Equation, FoundTerm, MARKS, Mark, Nearest, Status, Trust, Without,
};

/// Terms of one mark, and intervals, beyond which reasons and intervals are printed only with all evidence.
const MAX_REASONED_TERMS: usize = 8;
const MAX_LISTED_INTERVALS: usize = 16;
/// Names in a list before `and 4 more`.
const MAX_NAMED_TERMS: usize = 3;

/// Visible intervals, then terms by their marks; with `whole` a line for each term.
pub(crate) fn lines(d: &Discovery, e: &Equation, whole: bool) -> Vec<String> {
    let found: Vec<(&FoundTerm, &Trust)> = (e.terms.iter())
        .filter_map(|t| Some((t, t.trust.as_deref()?)))
        .collect();
    if found.is_empty() {
        return Vec::new();
    }
    let drawn = drawn(e);
    let nearest = e.evidence.as_ref().and_then(|e| e.nearest.as_ref());
    let nearest = nearest
        .filter(|n| {
            n.earns
                > if whole {
                    1.0
                } else {
                    n.costs - PRINTED.near_miss
                }
        })
        .map(missing);
    if whole {
        let line = |(t, trust): &(&FoundTerm, &Trust)| {
            let mut figures = vec![trust.mark.name().to_string()];
            figures.extend(trust.interval.map(between));
            figures.extend(reasons(trust, drawn));
            format!("term {}: {}", Language(d).term(&t.term), figures.join(", "))
        };
        return found.iter().map(line).chain(nearest).collect();
    }
    let widths: Vec<String> = found.iter().filter_map(|f| width(d, f)).collect();
    let mut lines = Vec::new();
    if widths.len() > MAX_LISTED_INTERVALS {
        lines.push(format!("95 %: {} intervals, with --evidence", widths.len()));
    } else if !widths.is_empty() {
        lines.push(format!("95 %: {}", widths.join(", ")));
    }
    lines.extend(marks(d, e, &found));
    lines.extend(nearest);
    lines
}

/// `left out: x^2 would earn 9.8 where a term costs 11; 1.7 times as much data would decide`
fn missing(n: &Nearest) -> String {
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

/// Terms by mark: one word if all are alike, else those that are not firm with their reasons.
fn marks(d: &Discovery, e: &Equation, found: &[(&FoundTerm, &Trust)]) -> Vec<String> {
    let all = |mark: Mark| found.iter().all(|(_, t)| t.mark == mark);
    if all(Mark::Firm) {
        return vec!["firm: every term".into()];
    }
    let capped = e.status == Status::Doubt;
    let own = |t: &Trust| MARKS.of(t);
    if capped && all(Mark::Likely) && found.iter().all(|(_, t)| own(t) == Mark::Firm) {
        return vec!["likely: every term, firm but for the doubts".into()];
    }
    let drawn = drawn(e);
    if drawn == 0 && found.iter().all(|(_, t)| own(t) == Mark::Likely) {
        return vec!["likely: every term; there are no half records to find them in again".into()];
    }
    let one = |(t, trust): &(&FoundTerm, &Trust)| {
        let reasons = reasons(trust, drawn);
        format!("{} ({})", Language(d).term(&t.term), reasons.join(", "))
    };
    let of = |mark: Mark| {
        let those: Vec<_> = found.iter().filter(|(_, t)| own(t) == mark).collect();
        if those.len() > MAX_REASONED_TERMS {
            let (many, all) = (those.len(), found.len());
            let name = mark.name();
            return Some(format!(
                "{name}: {many} of {all} terms (--evidence says why)"
            ));
        }
        let those: Vec<String> = those.into_iter().map(one).collect();
        (!those.is_empty()).then(|| format!("{}: {}", mark.name(), those.join("; ")))
    };
    [Mark::Doubtful, Mark::Likely]
        .into_iter()
        .filter_map(of)
        .collect()
}

/// The rule of the marks, where a term is not firm or all evidence is printed.
pub(crate) fn rule(d: &Discovery, whole: bool) -> Option<String> {
    let marks = || {
        let terms = d.equations.iter().flat_map(|e| &e.terms);
        terms.filter_map(|t| Some(MARKS.of(t.trust.as_ref()?)))
    };
    let open = marks().any(|m| m != Mark::Firm);
    (open || (whole && marks().next().is_some())).then(|| {
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

fn drawn(e: &Equation) -> usize {
    let halves = e.evidence.as_ref().and_then(|e| e.halves.as_ref());
    halves.map_or(0, |h| h.drawn)
}

/// `F ±0.0012 (0.09 %)`
fn width(d: &Discovery, (t, trust): &(&FoundTerm, &Trust)) -> Option<String> {
    let (low, high) = trust.interval?;
    let half = 0.5 * (high - low);
    let part = half / t.coefficient.abs();
    (part > PRINTED.visible_interval).then(|| {
        format!(
            "{} ±{} ({} %)",
            Language(d).term(&t.term),
            significant(half, 2),
            significant(100.0 * part, 2)
        )
    })
}

/// An interval with the digits that its width determines.
fn between((low, high): (f64, f64)) -> String {
    let digits = digits_apart(low, high);
    format!(
        "95 % {} to {}",
        significant(low, digits),
        significant(high, digits)
    )
}

fn reasons(trust: &Trust, drawn: usize) -> Vec<String> {
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
pub fn without(w: &Without) -> String {
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
