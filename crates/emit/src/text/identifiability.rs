//! Identifiability as text: which terms the data tell apart, and what to record next.
//!
//! In: an [`Identifiability`]. Out: lines. Judges nothing.

use sidc_lang::number::significant;
use sidc_system::discovery::{Excitation, Finding, Identifiability, Leverage, Relation};

/// Most relations that are printed.
const MAX_LISTED_RELATIONS: usize = 12;

/// Ranges and spectra of all signals, each once.
pub(crate) fn ranges<'a>(
    all: impl Iterator<Item = &'a Identifiability>,
    frequency_unit: &str,
) -> Vec<String> {
    let mut seen: Vec<&Excitation> = Vec::new();
    for e in all.flat_map(|i| &i.excitation) {
        if seen.iter().all(|s| s.signal != e.signal) {
            seen.push(e);
        }
    }
    let line = |e: &Excitation| excitation(e, frequency_unit);
    seen.into_iter().map(line).collect()
}

/// Everything about one equation.
pub(crate) fn lines(i: &Identifiability) -> Vec<String> {
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
            significant(m.least, 3),
            significant(m.mean, 3),
            significant(m.most, 3),
            significant(m.smallest, 3),
            significant(m.largest, 3)
        ));
    }
    if !i.idle.is_empty() {
        let more = more(i.idle_more);
        lines.push(format!("never exercised: {}{more}", i.idle.join(", ")));
    }
    lines.extend(i.relations.iter().take(MAX_LISTED_RELATIONS).map(relation));
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
        significant(i.tolerance, 3)
    )
}

fn condition(i: &Identifiability) -> Option<String> {
    let (term, worst) = i.neighbour.as_ref()?;
    Some(format!(
        "condition: {} of the support, at most {} with one more column ({term})",
        significant(i.condition, 3),
        significant(*worst, 3)
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
        significant(r.size, 3),
        r.why
    )
}

fn excitation(e: &Excitation, frequency_unit: &str) -> String {
    let mut out = format!(
        "range: {} {} to {}, spread {}",
        e.signal,
        significant(e.least, 3),
        significant(e.most, 3),
        significant(e.spread, 3)
    );
    if let Some((frequency, share)) = e.line.filter(|(f, _)| *f > 0.0) {
        out.push_str(&format!(
            "; {} % of its power at {} {frequency_unit}",
            significant(100.0 * share, 2),
            significant(frequency, 3)
        ));
    }
    if let Some(band) = e.band {
        out.push_str(&format!(
            "; 95 % under {} {frequency_unit}",
            significant(band, 3)
        ));
    }
    out
}

fn leverage(l: &Leverage) -> String {
    format!(
        "leverage: half of what is known of {} comes from {}; the best hundredth of all (t = {} to {}) has {} %",
        l.term,
        counted(l.half, "row"),
        significant(l.from, 3),
        significant(l.to, 3),
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

/// Near 1, the difference from 1 is printed.
fn cosine(x: f64) -> String {
    let off = 1.0 - x.abs();
    match off < 1e-3 {
        true => format!(
            "{}1 − {}",
            if x < 0.0 { "−" } else { "" },
            significant(off.max(0.0), 3)
        ),
        false => significant(x, 3),
    }
}
