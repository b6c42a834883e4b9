//! What to try next: a command, or a line of the model.
//!
//! In: what was found, the command that was given. Out: a line, wrapped if it is long. If there are doubts, it is the first remedy with a concrete change. An
//! answer that passes is first tested on held-out data, then saved, then reported.

use super::arguments::Args;
use crate::outputs::paths::quoted;
use sidc::pipeline::ModelSource;
use sidc_emit::{TEXT_WIDTH, rival, rival_advice, wrapped};
use sidc_lang::term::SignalNames;
use sidc_system::discovery::{Change, Discovery, ReasonCode};
use sidc_system::predict::Prediction;
use sidc_system::ranked_reasons::{RankedReason, change, ranked};
use sidc_system::result::FileEntry;

/// Room after `next: `, minus that for a backslash.
const WIDTH: usize = TEXT_WIDTH - "next:  \\".len();
/// The part of a record that is proposed for holding out.
const HELD_OUT: &str = "--holdout=25%";
/// The file that is proposed for the result.
const RESULT: &str = "result.json";

/// For example `next: sidc identify model.sid data.csv --robust`. `held_out` says whether some data were not used.
pub fn line(
    args: &Args,
    source: &ModelSource,
    (discovery, prediction): (&Discovery, &Prediction),
    held_out: bool,
) -> String {
    let reasons = ranked(discovery);
    // On data that it was fitted to, a linear model proves nothing.
    let simpler = rival(discovery, prediction).filter(|_| held_out);
    let step = match (reasons.first(), simpler) {
        (None, Some(rival)) => words(&rival_advice(discovery, rival)),
        (None, None) => command(&step_after_pass(args, &source.files, held_out)),
        (Some(first), _) => {
            let cost = first.reason.code.cost();
            let alike = reasons.iter().filter(|r| r.reason.code.cost() == cost);
            let mut at_hand = alike.filter_map(|r| Some((&r.reason.code, change(r.reason)?)));
            match at_hand.next() {
                Some((_, Change::Options(options))) => command(&again(options)),
                Some((code, Change::Model(_))) => {
                    statements(&source.name, discovery, &reasons, code)
                }
                None => words(first.reason.advice()),
            }
        }
    };
    format!("next: {step}\n")
}

/// The lines of the model that remedy all reasons with one code, and what they replace. Entries of the data block are joined in one block.
fn statements(
    model: &str,
    discovery: &Discovery,
    reasons: &[RankedReason],
    code: &ReasonCode,
) -> String {
    let of_code = reasons.iter().filter(|r| r.reason.code == *code);
    let mut lines: Vec<&String> = Vec::new();
    for change in of_code.filter_map(|r| change(r.reason)) {
        if let Change::Model(more) = change {
            // Only one change of each statement is proposed.
            let fresh = |l: &&String| lines.iter().all(|k| subject(k) != subject(l));
            let more: Vec<&String> = more.iter().filter(fresh).collect();
            lines.extend(more);
        }
    }
    let entries: Vec<&str> = lines.iter().filter_map(|l| entry(l)).collect();
    let others = lines.iter().filter(|l| entry(l).is_none());
    let block = (!entries.is_empty()).then(|| format!("data {{ {} }}", entries.join("; ")));
    // Statements are wrapped after an operator or a comma.
    let each = others.map(|l| words(l)).chain(block);
    let each: Vec<String> = each.collect();
    let replaced: Vec<String> = lines.iter().flat_map(|l| replaced(discovery, l)).collect();
    let place = match replaced.is_empty() {
        true => String::new(),
        false => format!(", in place of {}", replaced.join(", ")),
    };
    format!("add to {model}{place}:\n    {}", each.join("\n    "))
}

/// What a line of the model replaces: the equations of its targets, or the declaration of a variable.
fn replaced(d: &Discovery, line: &str) -> Vec<String> {
    let declared = ["state ", "input ", "output ", "param "];
    if let Some(rest) = declared.iter().find_map(|word| line.strip_prefix(word)) {
        let name = rest.split([' ', ':', ',']).next().unwrap_or(rest);
        let known = d.variables.iter().any(|v| v.name == name);
        return known
            .then(|| format!("the declaration of {name}"))
            .into_iter()
            .collect();
    }
    let asked = d.equations.iter().map(|e| e.target);
    let asked = asked.chain(d.failed.iter().map(|f| f.target));
    let asked: Vec<String> = asked.map(|target| d.name(target)).collect();
    let left = subject(line).split(',').map(str::trim);
    let known = left.filter(|t| asked.iter().any(|a| a == t));
    known.map(|t| format!("the equation of {t}")).collect()
}

/// The target of an equation, or the text of a declaration up to `=`.
fn subject(line: &str) -> &str {
    line.split(['~', '=']).next().unwrap_or(line)
}

/// For example `dx = none` from `data { dx = none }`.
fn entry(line: &str) -> Option<&str> {
    line.strip_prefix("data { ")?.strip_suffix(" }")
}

fn words(text: &str) -> String {
    wrapped(text, WIDTH, "", "        ").join("\n")
}

/// Wraps a command with backslashes.
fn command(text: &str) -> String {
    wrapped(text, WIDTH, "", "    ").join(" \\\n")
}

/// The next step after an answer without doubts.
fn step_after_pass(args: &Args, files: &[FileEntry], held_out: bool) -> String {
    match &args.output {
        _ if !held_out => again(HELD_OUT),
        None => again(&format!("-o {RESULT}")),
        Some(path) => {
            let mut words = vec![
                "sidc".into(),
                "report".into(),
                quoted(&path.to_string_lossy()),
            ];
            let tables = files.iter().filter(|f| !f.name.ends_with(".sid"));
            words.extend(tables.map(|file| quoted(&file.name)));
            words.extend(["-o".into(), "report.html".into()]);
            words.join(" ")
        }
    }
}

/// The command that was given, with `options` in place of its own.
fn again(options: &str) -> String {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let name = options.split([' ', '=']).next().unwrap_or(options);
    let mut words = vec!["sidc".to_string()];
    words.extend(without(&given, name).iter().map(|w| quoted(w)));
    words.push(options.into());
    words.join(" ")
}

/// The words of a command without one option and its value.
fn without(words: &[String], option: &str) -> Vec<String> {
    let mut kept = Vec::new();
    let mut words = words.iter();
    while let Some(word) = words.next() {
        match word.strip_prefix(option) {
            Some("") => drop(words.next()),
            Some(value) if value.starts_with('=') => {}
            _ => kept.push(word.clone()),
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_option_is_taken_out_with_its_value() {
        let words = |text: &str| -> Vec<String> { text.split(' ').map(String::from).collect() };
        for given in [
            "m.sid d.csv --method joint -v",
            "m.sid --method=joint d.csv -v",
        ] {
            assert_eq!(without(&words(given), "--method"), words("m.sid d.csv -v"));
        }
    }
}
