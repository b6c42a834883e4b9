//! The first screen: the equations, the three answers, the worst prediction, what to do next.

use crate::report::markup::{section_head, with_code};
use crate::report::report_contents::Subject;
use crate::report::sections::{prediction, prediction_bands};
use crate::text::verdict::{Rival, answers, rival, rival_advice, shown};
use crate::thresholds::PRINTED;
use crate::typeset::mathml::{MathMl, escape};
use crate::unknown_constants;
use sidc_system::discovery::{Change, Discovery, Reason, Status};
use sidc_system::predict::{DataKind, Prediction, SignalPrediction};
use sidc_system::ranked_reasons::{change, foremost, ranked};
use sidc_system::verdict::{LawVerdict, RunStatus, Verdict};

/// Most equations that are shown above the answers.
const MAX_EQUATIONS: usize = 6;

/// The CSS class and the words of a badge.
pub(crate) type Badge = (&'static str, &'static str);
const GOOD: &str = "pass";
const OPEN: &str = "known";
const DOUBT: &str = "doubt";
const BAD: &str = "fail";

/// The badge of one equation.
pub(crate) fn badge(status: Status) -> &'static str {
    match status {
        Status::Known => "<span class=\"badge known\">stated by the model</span>",
        Status::Pass => "<span class=\"badge pass\">passes</span>",
        Status::Doubt => "<span class=\"badge doubt\">doubted</span>",
    }
}

pub(crate) fn html(s: &Subject) -> String {
    let body = [
        equations(s.discovery, MAX_EQUATIONS),
        three_answers(s),
        reasons(s.discovery, code),
        next(s),
        worst_prediction(s).unwrap_or_default(),
    ];
    section_head("verdict", "Verdict", &body.concat())
}

/// The first equations, what was not found, and the constants in them.
pub(crate) fn equations(d: &Discovery, most: usize) -> String {
    let notation = MathMl(d);
    let mut out = String::new();
    for e in d.equations.iter().take(most) {
        let pieces = notation.equation(e).concat();
        out.push_str(&format!(
            "<div class=\"equation\">\n<div class=\"formula\">{pieces}</div>\n{}\n</div>\n",
            badge(e.status)
        ));
    }
    let more = d.equations.len().saturating_sub(most);
    if more > 0 {
        out.push_str(&format!(
            "<p>{more} more under <a href=\"#equations\">Equations and proofs</a>.</p>\n"
        ));
    }
    let missing = d.failed.iter().map(|f| {
        let symbol = notation.symbol(f.target);
        format!("<p>{symbol} <span class=\"badge fail\">not found</span></p>\n")
    });
    out.extend(missing);
    let constants = unknown_constants::lines(d);
    out.extend(constants.map(|said| format!("<p>{}</p>\n", escape(&said))));
    out
}

/// The badges of the three answers; documents of earlier versions have only the first.
pub(crate) fn badges(s: &Subject) -> [Badge; 3] {
    let verdict = s.document.verdict.as_ref();
    [
        law(LawVerdict::of(s.discovery)),
        verdict.map_or((OPEN, "none"), |v| predicts(s.discovery, &v.prediction)),
        verdict.map_or((OPEN, "none"), runs),
    ]
}

/// Is it the law, how far ahead does it predict, does it run freely; documents of earlier versions answer only the first.
fn three_answers(s: &Subject) -> String {
    let d = s.discovery;
    let badges = badges(s);
    let Some(v) = &s.document.verdict else {
        let [law, ..] = badges;
        return format!("<dl class=\"answers\">\n{}</dl>\n", answer("law", law, ""));
    };
    let texts = answers(d, v).into_iter().zip(badges);
    let all: String = (texts)
        .map(|((name, text), badge)| answer(name, badge, &text))
        .collect();
    format!("<dl class=\"answers\">\n{all}</dl>\n")
}

fn answer(name: &str, (class, word): Badge, text: &str) -> String {
    let text = text.strip_prefix(word).unwrap_or(text);
    let text = escape(text.trim_start_matches([',', ' ']));
    format!(
        "<div class=\"{class}\"><dt>{name}</dt><dd><span class=\"badge {class}\">{word}</span> {text}</dd></div>\n"
    )
}

fn law(v: LawVerdict) -> Badge {
    match v {
        LawVerdict::Passes => (GOOD, "passes"),
        LawVerdict::Doubted => (DOUBT, "doubted"),
        LawVerdict::Failed => (BAD, "not all found"),
    }
}

/// Good is what meets `--good` or, without that option, what beats a linear model on held-out data.
fn predicts(d: &Discovery, p: &Prediction) -> Badge {
    match p.good {
        _ if p.signals.is_empty() => (OPEN, "none"),
        Some(true) => (GOOD, "good enough"),
        Some(false) if p.on == DataKind::HeldOut => (BAD, "not good enough"),
        _ if rival(d, p).is_some() => (DOUBT, rival(d, p).map_or("", Rival::text)),
        _ if p.on == DataKind::Used => (OPEN, "on the data used alone"),
        _ if beats_linear(&shown(d, p)) => (GOOD, "better than a linear model"),
        _ => (OPEN, "not better in every signal"),
    }
}

/// Whether every signal is predicted better than by the linear model, or exactly up to rounding.
fn beats_linear(signals: &[&SignalPrediction]) -> bool {
    let beats = |s: &SignalPrediction| {
        let own = s.error.quantile_90.unwrap_or(f64::INFINITY);
        let linear = s.linear.and_then(|e| e.quantile_90);
        own < PRINTED.exact_prediction * s.spread || linear.is_some_and(|linear| own < linear)
    };
    signals.iter().all(|s| beats(s))
}

fn runs(v: &Verdict) -> Badge {
    match v.run.status {
        RunStatus::Follows => (GOOD, "follows"),
        RunStatus::Departs => (DOUBT, "departs"),
        RunStatus::Sensitive => (OPEN, "cannot judge"),
        RunStatus::Ended => (BAD, "ends early"),
        RunStatus::NotRun => (OPEN, "none"),
    }
}

/// The foremost reasons, each with what to do and with what `behind` adds.
pub(crate) fn reasons(d: &Discovery, behind: impl Fn(&Reason) -> String) -> String {
    let ranked = ranked(d);
    let foremost = foremost(&ranked, PRINTED.reasons);
    let each = foremost.iter().map(|r| {
        let (text, help) = (&r.reason.text, r.reason.explained_advice());
        format!(
            "<li>{}; <strong>{}</strong>{}{}</li>\n",
            escape(text),
            escape(&help),
            behind(r.reason),
            lines(r.reason)
        )
    });
    let each: String = each.collect();
    match each.is_empty() {
        true => each,
        false => format!("<ul>\n{each}</ul>\n"),
    }
}

/// The lines of a model that answer a reason, ready to be copied.
fn lines(r: &Reason) -> String {
    match change(r) {
        Some(Change::Model(lines)) => format!("<pre>{}</pre>", escape(&lines.join("\n"))),
        _ => String::new(),
    }
}

/// The code under which the documentation lists a reason.
fn code(r: &Reason) -> String {
    format!(" <code>{}</code>", escape(r.code.as_str()))
}

/// The next step if the equations pass, else nothing.
fn next(s: &Subject) -> String {
    let d = s.discovery;
    let held_out = s.document.verdict.as_ref();
    let held_out = held_out.is_some_and(|v| v.prediction.on == DataKind::HeldOut);
    let simpler = s
        .document
        .verdict
        .as_ref()
        .and_then(|v| rival(d, &v.prediction));
    if let (LawVerdict::Passes, Some(rival), true) = (LawVerdict::of(d), simpler, held_out) {
        return format!(
            "<p><b>Next:</b> {}</p>\n",
            with_code(&rival_advice(d, rival))
        );
    }
    let result = escape(s.name);
    let next = match (LawVerdict::of(d), held_out) {
        (LawVerdict::Passes, false) => {
            "hold out a part of the data, so that predictions are judged on what the equations have not seen: <code>sidc identify … --holdout=25%</code>".to_string()
        }
        (LawVerdict::Passes, true) => {
            format!("use it: <code>sidc export {result} --to python</code> writes code, <code>sidc simulate {result} DATA</code> runs it")
        }
        _ => return String::new(),
    };
    format!("<p><b>Next:</b> {next}</p>\n")
}

/// The signal with the largest error relative to its spread: its predictions of held-out data, or how its error grows.
fn worst_prediction(s: &Subject) -> Option<String> {
    let p = &s.document.verdict.as_ref()?.prediction;
    let share = |s: &SignalPrediction| s.error.quantile_90.unwrap_or(f64::INFINITY) / s.spread;
    let worst = shown(s.discovery, p)
        .into_iter()
        .max_by(|a, b| share(a).total_cmp(&share(b)))?;
    prediction_bands::picture(p, worst).or_else(|| prediction::picture(p, worst))
}
