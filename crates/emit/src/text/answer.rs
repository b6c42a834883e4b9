//! The answer on one screen: the equations with the digits that their standard errors justify, the three answers, the foremost reasons with
//! what to do.
//!
//! In: a discovery, its verdict. Out: text. The figures behind it are in [`super::evidence`].

use std::collections::BTreeSet;

use crate::text::equations::equations_with_errors;
use crate::text::layout::{TEXT_WIDTH, wrapped};
use crate::text::verdict::verdict;
use crate::text::{disturbance, relations, solution_path, sparsest};
use crate::thresholds::PRINTED;
use crate::unknown_constants;
use sidc_lang::term::SignalNames;
use sidc_system::discovery::Discovery;
use sidc_system::ranked_reasons::{RankedReason, foremost, ranked};
use sidc_system::verdict::Verdict;

/// Equations, verdict, reasons; ends in a newline.
pub fn answer(d: &Discovery, v: &Verdict) -> String {
    let mut out = String::new();
    for (e, lines) in d.equations.iter().zip(equations_with_errors(d)) {
        out.push_str(&lines);
        out.push_str(&solution_path::table(d, e));
    }
    out.push_str(&lines(d.resets.iter().map(|r| r.text(d))));
    out.push_str(&lines(unknown_constants::lines(d)));
    out.push_str(&lines(d.hidden_sentences().into_iter()));
    out.push_str(&lines(disturbance::sentences(d)));
    for f in &d.failed {
        out.push_str(&format!("{}: not found\n", d.name(f.target)));
    }
    out.push_str(&lines(d.delay_sentences().into_iter()));
    out.push_str(&lines(d.cubic_sentences().into_iter()));
    out.push_str(&lines(d.rest_sentences().into_iter()));
    out.push_str(&sparsest_answers(d));
    out.push_str(&other_laws(d));
    out.push('\n');
    out.push_str(&verdict(d, v));
    out.push_str(&reasons(d));
    out
}

/// Sentences, each on lines of its own.
fn lines(sentences: impl Iterator<Item = String>) -> String {
    let wrapped = sentences.flat_map(|s| wrapped(&s, TEXT_WIDTH, "", "    "));
    wrapped.map(|l| format!("{l}\n")).collect()
}

/// What is known of the sparsest equations, if that was asked.
fn sparsest_answers(d: &Discovery) -> String {
    let mut out = String::new();
    for e in &d.equations {
        for line in sparsest::lines(e).iter().take(PRINTED.sparsest_lines) {
            let line = format!("{}, {line}", d.name(e.target));
            let wrapped = wrapped(&line, TEXT_WIDTH, "", "    ");
            out.extend(wrapped.iter().map(|l| format!("{l}\n")));
        }
    }
    out
}

/// Other ways to write the relations, after a blank line.
fn other_laws(d: &Discovery) -> String {
    let mut out = String::new();
    for (head, laws) in relations::told(d) {
        let head = wrapped(&head, TEXT_WIDTH, "", "    ");
        out.push('\n');
        out.extend(head.iter().map(|l| format!("{l}\n")));
        out.push_str(&laws);
    }
    out
}

/// The foremost reasons, each with what to do; the codes of the others.
fn reasons(d: &Discovery) -> String {
    let all = ranked(d);
    let shown = foremost(&all, PRINTED.reasons);
    let mut lines: Vec<String> = Vec::new();
    for r in &shown {
        lines.extend(wrapped(&head(d, r), TEXT_WIDTH, "", "    "));
        let help = format!("help: {}", r.reason.explained_advice());
        lines.extend(wrapped(&help, TEXT_WIDTH, "    ", "        "));
    }
    let left: Vec<&RankedReason> = all.iter().filter(|r| !shown.contains(r)).collect();
    let codes: BTreeSet<&str> = left.iter().map(|r| r.reason.code.as_str()).collect();
    if !codes.is_empty() {
        let codes: Vec<&str> = codes.into_iter().collect();
        let more = format!("{} more ({}): --evidence", left.len(), codes.join(", "));
        lines.extend(wrapped(&more, TEXT_WIDTH, "", "    "));
    }
    let lines: String = lines.iter().map(|l| format!("{l}\n")).collect();
    match lines.is_empty() {
        true => lines,
        false => format!("\n{lines}"),
    }
}

/// `doubt[tie] of ddx, ddy: these data …`; a system of one equation needs no name.
fn head(d: &Discovery, r: &RankedReason) -> String {
    let kind = match r.failed {
        true => "failed",
        false => "doubt",
    };
    let of = match d.equations.len() + d.failed.len() {
        1 => String::new(),
        n if r.targets.len() == n => " of every equation".into(),
        _ => format!(" of {}", r.targets.join(", ")),
    };
    format!("{kind}[{}]{of}: {}", r.reason.code, r.reason.text)
}
