//! What the verdict rests on: every reason, marks, runs, warnings, what the data lack.

use crate::report::markup::{Section, counted, paragraph};
use crate::report::report_contents::{RecordRun, Role, Subject};
use crate::report::sections::trajectories::fit_text;
use crate::typeset::mathml::{MathMl, escape};
use sidc_lang::term::SignalNames;
use sidc_lang::words::listed;
use sidc_system::discovery::{Finding, Mark, Notice, Reason, Status};

pub(crate) fn html(s: &Subject) -> Section {
    let mut body = paragraph(&sentence(s));
    body.push_str(&reasons(s));
    let mut points: Vec<String> = Vec::new();
    points.extend(marks(s));
    points.extend(runs(s));
    points.extend(changed(s));
    points.extend(s.document.warnings.iter().map(warning));
    let points: String = (points.iter())
        .map(|p| format!("<li>{}</li>\n", escape(p)))
        .collect();
    if !points.is_empty() {
        body.push_str(&format!("<ul>\n{points}</ul>\n"));
    }
    body.push_str(&advice(s));
    Section::new("reasons", "What the verdict rests on", body)
}

fn sentence(s: &Subject) -> String {
    let d = s.discovery;
    let doubted = (d.equations.iter())
        .filter(|e| e.status == Status::Doubt)
        .count();
    let all = d.equations.len() + d.failed.len();
    match (all, doubted, d.failed.len()) {
        (0, _, _) => "The result has no equations.".into(),
        (1, 0, 0) => "The equation passes: nothing speaks against it on these data.".into(),
        (_, 0, 0) => "Every equation passes: nothing speaks against any of them on these data.".into(),
        (1, _, 0) => "The equation is doubted. It is the best that was found; settle the reasons before you use it.".into(),
        (_, n, 0) => format!("{n} of {all} equations {} doubted, for these reasons.", are(n)),
        (_, 0, n) => format!("{n} of {all} equations {} not found.", were(n)),
        (_, k, n) => format!("{n} of {all} equations {} not found, {k} {} doubted.", were(n), are(k)),
    }
}

fn are(n: usize) -> &'static str {
    if n == 1 { "is" } else { "are" }
}

fn were(n: usize) -> &'static str {
    if n == 1 { "was" } else { "were" }
}

/// Doubts and failures, equation by equation.
fn reasons(s: &Subject) -> String {
    let notation = MathMl(s.discovery);
    let mut out = String::new();
    let entry = |target, class: &str, all: &[Reason]| -> String {
        let each: String = (all.iter())
            .map(|r| {
                let (text, code) = (escape(&r.text), escape(r.code.as_str()));
                let help = escape(&r.explained_advice());
                format!(
                    "<dd><span class=\"{class}\">{text}</span> <code>{code}</code>; <strong>{help}</strong></dd>\n"
                )
            })
            .collect();
        format!("<dt>{}</dt>\n{each}", notation.symbol(target))
    };
    for e in s
        .discovery
        .equations
        .iter()
        .filter(|e| e.status == Status::Doubt)
    {
        out.push_str(&entry(e.target, "doubt", &e.reasons));
    }
    for f in &s.discovery.failed {
        out.push_str(&entry(f.target, "fail", &f.reasons));
    }
    match out.is_empty() {
        true => out,
        false => format!("<dl class=\"reasons\">\n{out}</dl>\n"),
    }
}

/// How many terms are firm, and which are not.
fn marks(s: &Subject) -> Option<String> {
    let d = s.discovery;
    let terms = d.equations.iter().flat_map(|e| {
        let judged = e
            .terms
            .iter()
            .filter_map(|t| Some((t, t.evidence.as_ref()?)));
        judged.map(move |(t, trust)| (e.target, t, trust.mark))
    });
    let terms: Vec<_> = terms.collect();
    let of = |mark: Mark| -> Vec<String> {
        let those = terms.iter().filter(|t| t.2 == mark);
        those
            .map(|(target, t, _)| {
                let term = sidc_lang::term::Language(d).term(&t.term);
                format!("{term} in {}", d.name(*target))
            })
            .collect()
    };
    let (likely, doubtful) = (of(Mark::Likely), of(Mark::Doubtful));
    let firm = terms.len() - likely.len() - doubtful.len();
    const MAX_NAMED: usize = 6;
    let named = |all: &[String]| match all.len() > MAX_NAMED {
        true => String::new(),
        false => format!(" ({})", listed(all)),
    };
    match (terms.len(), likely.len(), doubtful.len()) {
        (0, _, _) => None,
        (n, 0, 0) if n > 1 => Some(format!("All {n} terms are firm.")),
        (_, 0, 0) => Some("The term is firm.".into()),
        (n, _, _) => {
            let mut parts = Vec::new();
            if firm > 0 {
                parts.push(format!("{firm} firm"));
            }
            for (word, those) in [("likely", &likely), ("doubtful", &doubtful)] {
                if !those.is_empty() {
                    parts.push(format!("{} {word}{}", those.len(), named(those)));
                }
            }
            Some(format!("Of {}, {}.", counted(n, "term"), listed(&parts)))
        }
    }
}

/// How the equations run along the records, one sentence for each of the first few.
fn runs(s: &Subject) -> Vec<String> {
    const MAX_RUNS: usize = 5;
    let mut out: Vec<String> = s
        .runs
        .iter()
        .take(MAX_RUNS)
        .filter_map(|a| along(s, a))
        .collect();
    let more = s.runs.len().saturating_sub(MAX_RUNS);
    if more > 0 {
        out.push(format!(
            "{} more under “Measured against simulated”.",
            counted(more, "run")
        ));
    }
    let begun = s.runs.iter().map(|a| a.trajectory).max();
    if begun.is_none_or(|last| last + 1 < s.dataset.trajectories.len()) {
        out.push("The runs were stopped before the last record.".into());
    }
    if s.document.validation.is_none() {
        out.push("Nothing was held out when the equations were found (--holdout): how they run on data they have not seen is not shown by this result alone.".into());
    }
    out
}

fn along(s: &Subject, a: &RecordRun) -> Option<String> {
    let trajectory = s.dataset.trajectories.get(a.trajectory)?;
    let name = &trajectory.name;
    let run = match &a.run {
        Ok(run) => run,
        Err(why) => return Some(format!("No run along {name}: {why}.")),
    };
    let unseen = a.held_out || matches!(s.role(trajectory), Role::Held | Role::Other);
    let begin = run.time.first().copied().unwrap_or(0.0);
    let place = match (unseen, a.held_out) {
        (true, true) => format!(
            "On what was held out of {name}, run freely from {}",
            s.time_text(begin)
        ),
        (true, false) => format!("Run freely along {name}, which they were not found from"),
        _ => format!("Run freely along {name} from {}", s.time_text(begin)),
    };
    let worst = run.scores.iter().min_by(|a, b| a.fit.total_cmp(&b.fit));
    let fit = worst.map_or_else(String::new, |w| {
        let (name, fit) = (s.discovery.name(w.signal), fit_text(w.fit));
        match run.scores.len() {
            1 => format!("; the fit of {name} is {fit}"),
            _ => format!("; the worst fit is that of {name}, {fit}"),
        }
    });
    let least = run
        .scores
        .iter()
        .filter_map(|c| Some((c.follows?, c.signal)));
    let least = least.min_by(|a, b| a.0.total_cmp(&b.0));
    Some(match (run.fault(), least) {
        (Some(fault), _) => format!(
            "{place}, the equations end early, at {}: {}{fit}.",
            s.time_text(fault.time),
            fault.text(s.discovery)
        ),
        (None, Some((t, signal))) => format!(
            "{place}, the equations follow {} for {}{fit}.",
            s.discovery.name(signal),
            s.duration_text(t)
        ),
        (None, None) if run.scores.is_empty() => format!(
            "Along {name} nothing that is simulated was measured after the start: there is nothing to compare."
        ),
        (None, None) => {
            format!("{place}, the equations follow every signal to the end{fit}.")
        }
    })
}

/// Records whose file has changed.
fn changed(s: &Subject) -> Vec<String> {
    let all = s.dataset.trajectories.iter();
    let other = all.filter(|t| s.role(t) == Role::Changed);
    other
        .map(|t| format!("{} is {}.", t.name, Role::Changed.description()))
        .collect()
}

fn warning(r: &Notice) -> String {
    format!("Warning {}: {}", r.code, r.text)
}

/// What the data lack, and what to record.
fn advice(s: &Subject) -> String {
    let judged = s
        .discovery
        .equations
        .iter()
        .filter_map(|e| e.evidence.as_ref());
    let findings = judged.filter_map(|e| e.identifiability.as_deref());
    let mut said: Vec<&Finding> = Vec::new();
    for f in findings.flat_map(|i| &i.findings).filter(|f| f.matters) {
        if !said.iter().any(|s| s.text == f.text) {
            said.push(f);
        }
    }
    const MAX_ADVICE: usize = 6;
    let each: String = (said.iter().take(MAX_ADVICE))
        .map(|f| {
            let advice = match f.advice.is_empty() {
                true => String::new(),
                false => format!("; <strong>{}</strong>", escape(&f.advice)),
            };
            format!(
                "<li>{}{advice} <code>{}</code></li>\n",
                escape(&f.text),
                f.cause.name()
            )
        })
        .collect();
    match each.is_empty() {
        true => each,
        false => format!("<h3>What the data lack</h3>\n<ul>\n{each}</ul>\n"),
    }
}
