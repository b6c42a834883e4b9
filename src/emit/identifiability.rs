//! What the data tell apart, in words: the few sentences that matter by themselves, everything for those who ask.
//!
//! In: an [`Identifiability`]. Out: lines. Never judges: causes and figures come as they are.

use super::number::significant;
use crate::discover::{Cause, Excitation, Finding, Identifiability, Leverage, Reason, Relation};

/// Sentences that are said unasked, for one equation.
const UNASKED: usize = 3;
/// Relations and findings that are shown to those who ask.
const LISTED: usize = 12;

/// At most three lines: what bears on the equation, and what to do about it.
pub(super) fn brief(i: &Identifiability, doubts: &[Reason]) -> Vec<String> {
    // A doubt has said it already.
    let said = doubts.iter().any(|r| r.code == "dependent-states");
    let fresh = |f: &&Finding| f.matters && !(said && f.cause == Cause::Conserved);
    let matters: Vec<&Finding> = i.findings.iter().filter(fresh).collect();
    // Exchanges between terms of a wrong equation are beside the point.
    let decides = [Cause::TooFewRows, Cause::WrongOrder, Cause::MissingTerm];
    let most = match matters.first() {
        Some(first) if decides.contains(&first.cause) => 1,
        _ => UNASKED,
    };
    matters.into_iter().take(most).map(finding).collect()
}

/// Ranges and spectra of all signals, each once.
pub(super) fn ranges<'a>(all: impl Iterator<Item = &'a Identifiability>) -> Vec<String> {
    let mut seen: Vec<&Excitation> = Vec::new();
    for e in all.flat_map(|i| &i.excitation) {
        if seen.iter().all(|s| s.signal != e.signal) {
            seen.push(e);
        }
    }
    seen.into_iter().map(excitation).collect()
}

/// All that concerns one equation.
pub(super) fn whole(i: &Identifiability) -> Vec<String> {
    let mut lines = vec![scope(i)];
    lines.extend(condition(i));
    if let Some(p) = i.pairs.first() {
        let worst: Vec<String> = (i.pairs.iter().take(3))
            .map(|p| format!("{} and {} {}", p.first, p.second, cosine(p.cosine)))
            .collect();
        lines.push(format!(
            "coherence: {} ({})",
            cosine(p.cosine.abs()),
            worst.join("; ")
        ));
    }
    if let Some(m) = &i.isometry {
        lines.push(format!(
            "isometry: ‖Φa‖²/‖a‖² of {} random sums of {}: min {}, mean {}, max {}; singular values {} to {}",
            m.draws,
            counted(m.terms, "column"),
            short(m.least),
            short(m.mean),
            short(m.most),
            short(m.smallest),
            short(m.largest)
        ));
    }
    if !i.idle.is_empty() {
        let more = more(i.idle_more);
        lines.push(format!("never exercised: {}{more}", i.idle.join(", ")));
    }
    lines.extend(i.relations.iter().take(LISTED).map(relation));
    lines.extend(
        i.equivalent
            .iter()
            .map(|s| format!("as good: {{{}}}", s.join(", "))),
    );
    if i.equivalent_more > 0 {
        lines.push(format!("as good: {} more", i.equivalent_more));
    }
    lines.extend(i.leverage.iter().map(leverage));
    lines.extend(i.findings.iter().filter(|f| f.matters).map(finding));
    lines
}

fn finding(f: &Finding) -> String {
    let advice = match f.advice.as_str() {
        "" => String::new(),
        advice => format!("; {advice}"),
    };
    format!("data[{}]: {}{advice}", f.cause.name(), f.text)
}

fn scope(i: &Identifiability) -> String {
    let of = match i.columns + i.idle.len() + i.idle_more < i.candidates {
        true => format!(
            "{} of {} columns (the support and those that point most along it)",
            i.columns, i.candidates
        ),
        false => counted(i.columns, "column"),
    };
    format!(
        "rank: {} of {of} on {} rows (singular values above {} of the largest)",
        i.rank,
        i.rows,
        short(i.tolerance)
    )
}

fn condition(i: &Identifiability) -> Option<String> {
    let (term, worst) = i.neighbour.as_ref()?;
    Some(format!(
        "condition: {} of the support, at most {} with one more column ({term})",
        short(i.condition),
        short(*worst)
    ))
}

fn relation(r: &Relation) -> String {
    let through = match r.exchanges {
        true => ", and exchanges terms of the equation",
        false => "",
    };
    let touches = match r.touches.is_empty() || r.exchanges {
        true => String::new(),
        false => format!(", with {}", r.touches.join(", ")),
    };
    format!(
        "relation: {} (rest {}): {}{touches}{through}",
        r.text,
        short(r.size),
        r.why
    )
}

fn excitation(e: &Excitation) -> String {
    let mut out = format!(
        "range: {} {} to {}, spread {}",
        e.signal,
        short(e.least),
        short(e.most),
        short(e.spread)
    );
    if let Some((frequency, share)) = e.line.filter(|(f, _)| *f > 0.0) {
        out.push_str(&format!(
            "; {} % of its power at {} Hz",
            significant(100.0 * share, 2),
            short(frequency)
        ));
    }
    if let Some(band) = e.band {
        out.push_str(&format!("; 95 % under {} Hz", short(band)));
    }
    out
}

fn leverage(l: &Leverage) -> String {
    format!(
        "leverage: half of what is known of {} comes from {}; the best hundredth of all (t = {} to {}) has {} %",
        l.term,
        counted(l.half, "row"),
        short(l.from),
        short(l.to),
        significant(100.0 * l.top, 2)
    )
}

fn more(count: usize) -> String {
    match count {
        0 => String::new(),
        n => format!(", and {n} more"),
    }
}

fn counted(count: usize, what: &str) -> String {
    match count {
        1 => format!("1 {what}"),
        n => format!("{n} {what}s"),
    }
}

/// Near 1 the digits that count come late.
fn cosine(x: f64) -> String {
    let off = 1.0 - x.abs();
    match off < 1e-3 {
        true => format!(
            "{}1 − {}",
            if x < 0.0 { "−" } else { "" },
            short(off.max(0.0))
        ),
        false => significant(x, 3),
    }
}

fn short(x: f64) -> String {
    significant(x, 3)
}
