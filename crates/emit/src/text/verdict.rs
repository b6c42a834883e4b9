//! The three answers as text: the law, the prediction, the run, a line each.
//!
//! In: a discovery, its verdict. Out: lines of at most [`TEXT_WIDTH`] characters. Says nothing that the verdict does not hold.

use crate::text::coefficient_inference::firmness;
use crate::text::layout::{self, TEXT_WIDTH};
use crate::thresholds::PRINTED;
use sidc_lang::number::significant;
use sidc_lang::term::{Signal, SignalNames, VarId};
use sidc_system::discovery::{Discovery, Form};
use sidc_system::predict::{DataKind, ErrorFigures, Prediction, SignalPrediction};
use sidc_system::ranked_reasons::ranked;
use sidc_system::verdict::{LawVerdict, RunStatus, RunVerdict, SignalRun, Verdict};

/// `law: …`, `prediction: …`, `run: …`; every line ends in a newline.
pub fn verdict(d: &Discovery, v: &Verdict) -> String {
    let parts = parts(d, v).map(|(name, parts)| wrapped(name, &parts));
    let text = parts.concat();
    // A part may be wider than a line.
    let lines = text.lines().flat_map(|line| {
        let indent: String = line.chars().take_while(|c| *c == ' ').collect();
        layout::wrapped(line, TEXT_WIDTH, &indent, "    ")
    });
    lines.map(|l| format!("{l}\n")).collect()
}

/// The same, each in one line, however long.
pub fn sentences(d: &Discovery, v: &Verdict) -> [String; 3] {
    answers(d, v).map(|(name, text)| format!("{name}: {text}"))
}

/// The same by name.
pub(crate) fn answers(d: &Discovery, v: &Verdict) -> [(&'static str, String); 3] {
    parts(d, v).map(|(name, parts)| (name, parts.join(", ")))
}

fn parts(d: &Discovery, v: &Verdict) -> [(&'static str, Vec<String>); 3] {
    let data = data(&v.prediction);
    [
        ("law", law(d, v.law)),
        ("prediction", prediction(d, &v.prediction, &data)),
        ("run", run(&v.run, &v.prediction.unit, &data)),
    ]
}

/// Parts separated by commas; a line ends between parts.
fn wrapped(name: &str, parts: &[String]) -> String {
    let mut out = format!("{name}: ");
    let mut width = out.chars().count();
    for (i, part) in parts.iter().enumerate() {
        let long = part.chars().count() + 2;
        if i > 0 {
            out.push(',');
            match width + long > TEXT_WIDTH {
                true => {
                    out.push_str("\n    ");
                    width = 4;
                }
                false => out.push(' '),
            }
        }
        out.push_str(part);
        width += long;
    }
    out.push('\n');
    out
}

/// `passes`, and how firm its terms are; `doubted (misfit, tie)`, the costliest first.
fn law(d: &Discovery, law: LawVerdict) -> Vec<String> {
    let mut codes: Vec<String> = Vec::new();
    for r in ranked(d) {
        let code = r.reason.code.to_string();
        if !codes.contains(&code) {
            codes.push(code);
        }
    }
    let more = codes.len().saturating_sub(PRINTED.doubt_codes);
    codes.truncate(PRINTED.doubt_codes);
    let codes = codes.join(", ");
    match (law, more) {
        (LawVerdict::Passes, _) => [law.as_str().into()]
            .into_iter()
            .chain(firmness(d))
            .collect(),
        _ if codes.is_empty() => vec![law.as_str().into()],
        (_, 0) => vec![format!("{} ({codes})", law.as_str())],
        _ => vec![format!("{} ({codes} and {more} more)", law.as_str())],
    }
}

/// `the last 25 %`, `test.csv`, `the data used`.
fn data(p: &Prediction) -> String {
    let one = |what: &String| match what.strip_suffix('%') {
        Some(part) => format!("the last {part} %"),
        None => match what.split_once("..") {
            Some(("", to)) => format!("times up to {to}"),
            Some((from, "")) => format!("times from {from} on"),
            Some((from, to)) => format!("times {from} to {to}"),
            None => what.clone(),
        },
    };
    match (p.on, p.held_out.as_slice()) {
        (DataKind::Used, _) => "the data used".into(),
        (DataKind::HeldOut, [one_part]) => one(one_part),
        (DataKind::HeldOut, _) => "what was held out".into(),
    }
}

fn prediction(d: &Discovery, p: &Prediction, data: &str) -> Vec<String> {
    let met = p.good.map(|good| match good {
        true => "good enough".to_string(),
        false if p.on == DataKind::Used => "not judged without data held out".into(),
        false => not_good(p),
    });
    if let Some(why) = p.unavailable.as_ref().filter(|_| p.signals.is_empty()) {
        let none = format!("none: {}", why.text);
        return [none].into_iter().chain(met).collect();
    }
    let mut signals = shown(d, p);
    let hidden = signals.len().saturating_sub(PRINTED.predicted_signals);
    if hidden > 0 {
        // The worst are shown, in the order of the model.
        let relative =
            |s: &SignalPrediction| s.error.quantile_90.unwrap_or(f64::INFINITY) / s.spread;
        let mut sizes: Vec<f64> = signals.iter().map(|s| relative(s)).collect();
        sizes.sort_by(|a, b| b.total_cmp(a));
        let least = sizes
            .get(PRINTED.predicted_signals - 1)
            .copied()
            .unwrap_or(0.0);
        signals.retain(|s| relative(s) >= least);
        signals.truncate(PRINTED.predicted_signals);
    }
    let ended: usize = p.ended.iter().map(|e| e.starts).sum();
    let reached = p.starts.saturating_sub(ended);
    let ahead = format!("{} {} ahead", significant(p.horizon, 3), p.unit);
    let mut parts = Vec::new();
    if reached == 0 {
        let why: Vec<&str> = p.ended.iter().map(|e| e.code.as_str()).collect();
        let (all, why) = (p.starts, why.join(", "));
        parts.push(format!(
            "none of {all} starts on {data} gets {ahead} ({why})"
        ));
    } else {
        parts.extend(signals.iter().map(|s| signal(s)));
        if let Some(first) = parts.first_mut() {
            *first = format!("{ahead} {first}");
        }
        if hidden > 0 {
            parts.push(format!("{hidden} more with smaller parts of their spread"));
        }
        parts.push(format!("90 % of {reached} starts on {data}"));
        parts.extend(shown(d, p).into_iter().filter_map(band_misses));
        for ended in &p.ended {
            parts.push(format!("{} more end early ({})", ended.starts, ended.code));
        }
    }
    let divergence_time = divergence_time(p);
    let rival = rival(d, p).map(|r| r.text().to_string());
    parts.extend(divergence_time.into_iter().chain(rival));
    parts.extend(p.unavailable.iter().map(|why| why.text.clone()));
    parts.extend(met);
    parts
}

/// The lowest measured derivative of each variable, and every signal that misses the limit of `--good`.
pub(crate) fn shown<'a>(d: &Discovery, p: &'a Prediction) -> Vec<&'a SignalPrediction> {
    let lowest = |var: usize, order: u8| {
        let names = (0..=order).map(|der| d.name(Signal::derivative(VarId(var as u16), der)));
        let mut found = names.filter(|n| p.signals.iter().any(|s| s.signal == *n));
        found.next()
    };
    let variables = d.variables.iter().enumerate();
    let lowest: Vec<String> = variables.filter_map(|(i, v)| lowest(i, v.order)).collect();
    let signals = p.signals.iter();
    let wanted = signals.filter(|s| s.good == Some(false) || lowest.contains(&s.signal));
    wanted.collect()
}

/// `theta to 0.02 rad (no change 0.58, linear 0.1)`
fn signal(s: &SignalPrediction) -> String {
    let unit = s
        .unit
        .as_ref()
        .map_or_else(String::new, |u| format!(" {u}"));
    let linear = s.linear.map(|l| format!(", linear {}", figure(l)));
    format!(
        "{} to {}{unit} (no change {}{})",
        s.signal,
        error(s),
        figure(s.no_change),
        linear.unwrap_or_default()
    )
}

/// Set if predictions of held-out data miss a band more than twice as often as the one time in ten that it promises.
fn band_misses(s: &SignalPrediction) -> Option<String> {
    let band = s.band.as_ref()?;
    let held = band
        .held_out
        .as_ref()
        .filter(|h| h.fixed < PRINTED.band_share)?;
    Some(format!(
        "{} there beyond the {} of the data used in {:.0} % instead of 10",
        s.signal,
        significant(band.half_width, 2),
        100.0 * (1.0 - held.fixed)
    ))
}

/// The error of the equations; one that is only rounding is given as a bound.
fn error(s: &SignalPrediction) -> String {
    let rounding = PRINTED.exact_prediction * s.spread;
    match s.error.quantile_90 {
        Some(e) if e < rounding => format!("below {}", significant(rounding, 1)),
        _ => figure(s.error),
    }
}

fn figure(e: ErrorFigures) -> String {
    e.quantile_90.map_or("∞".into(), |x| significant(x, 2))
}

/// What predicts better than the equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rival {
    NoChange,
    Linear,
}

impl Rival {
    pub fn text(self) -> &'static str {
        match self {
            Rival::NoChange => "worse than no change",
            Rival::Linear => "a linear model is better",
        }
    }
}

/// What predicts every signal better than the equations do, if their errors are more than rounding. A chaotic motion cannot be predicted
/// for long by anything: there a rival has to be better from the first step on.
pub fn rival(d: &Discovery, p: &Prediction) -> Option<Rival> {
    let signals = shown(d, p);
    let chaotic = signals.iter().any(|s| s.follows.is_some());
    [Rival::NoChange, Rival::Linear].into_iter().find(|rival| {
        let at_horizon = |s: &SignalPrediction| {
            let other = match rival {
                Rival::NoChange => Some(s.no_change),
                Rival::Linear => s.linear,
            };
            loses(s, s.error, other)
        };
        let at_first = |s: &SignalPrediction| {
            s.curve.first().is_some_and(|first| {
                let other = match rival {
                    Rival::NoChange => Some(first.no_change),
                    Rival::Linear => first.linear,
                };
                loses(s, first.error, other)
            })
        };
        let beaten = |s: &&SignalPrediction| at_horizon(s) && (!chaotic || at_first(s));
        !signals.is_empty() && signals.iter().all(beaten)
    })
}

/// Whether an error is larger than another, and than rounding.
fn loses(s: &SignalPrediction, own: ErrorFigures, other: Option<ErrorFigures>) -> bool {
    let own = own.quantile_90.unwrap_or(f64::INFINITY);
    let visible = own > PRINTED.exact_prediction * s.spread;
    visible && other.and_then(|e| e.quantile_90).is_some_and(|r| r < own)
}

/// What to try if something simpler predicts better than equations that have no other doubt.
pub fn rival_advice(d: &Discovery, rival: Rival) -> String {
    match rival {
        Rival::NoChange => {
            "look where they fail: no change at all predicts better than these equations".into()
        }
        Rival::Linear => {
            let form = Form::new(d);
            let own = d.equations.iter().filter(|e| !e.terms.is_empty());
            let targets: Vec<String> = own.map(|e| d.name(e.target)).collect();
            let signals = form.state.iter().chain(&form.inputs);
            let signals: Vec<String> = signals.map(|s| d.name(*s)).collect();
            format!(
                "a linear model predicts better than these equations; try it, `{} ~ poly({}; 1)`",
                targets.join(", "),
                signals.join(", ")
            )
        }
    }
}

/// The earliest time at which the error of a signal reaches half its spread.
fn divergence_time(p: &Prediction) -> Option<String> {
    let reached = p
        .signals
        .iter()
        .filter_map(|s| Some((s.follows?, &s.signal)));
    let (time, name) = reached.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(format!(
        "half the spread of {name} after {} {}",
        significant(time, 2),
        p.unit
    ))
}

fn not_good(p: &Prediction) -> String {
    let band_misses = p.signals.iter().find(|s| s.good == Some(false));
    match band_misses.and_then(|s| Some((s, s.limit?))) {
        Some((s, limit)) => format!(
            "not good enough: {} is to be within {}",
            s.signal,
            significant(limit, 2)
        ),
        None => "not good enough: not every signal asked for is measured".into(),
    }
}

fn run(r: &RunVerdict, unit: &str, data: &str) -> Vec<String> {
    let long = |s: &SignalRun| {
        let follows = s.follows.map_or(s.long, |t| t);
        let (follows, long) = (significant(follows, 3), significant(s.long, 3));
        format!("{} for {follows} of {long} {unit}", s.signal)
    };
    match r.status {
        RunStatus::NotRun => vec!["none".into()],
        RunStatus::Sensitive => vec![
            "cannot judge: a start moved by the error of its readings leads elsewhere (unstable, chaotic, or badly known)".into(),
            "so go by the prediction".into(),
        ],
        RunStatus::Ended => {
            let why = r.ended.as_ref().map_or("", |n| n.text.as_str());
            vec![format!("ends early on {data}: {why}")]
        }
        RunStatus::Follows => vec![format!(
            "follows every signal to the end of {} {unit} on {data}",
            significant(r.long, 3)
        )],
        RunStatus::Departs => {
            let departs = r.signals.iter().filter(|s| s.follows.is_some());
            let mut all: Vec<String> = departs.take(PRINTED.predicted_signals).map(long).collect();
            if let Some(first) = all.first_mut() {
                *first = format!("follows {first}");
            }
            if r.signals.iter().any(|s| s.follows.is_none()) {
                all.push("others to the end".into());
            }
            all.push(format!("on {data}"));
            all
        }
    }
}
