//! How to reproduce the result: files by content, settings, the command, the model.

use crate::report::markup::{Section, lead, number, paragraph};
use crate::report::report_contents::Subject;
use crate::typeset::mathml::escape;
use sidc_lang::number::significant;
use sidc_system::predict::ErrorLimit;
use sidc_system::result::{EquationEntry, FileEntry, Settings};

/// Longest text of a model that is printed, in bytes.
const MAX_MODEL_BYTES: usize = 100_000;

pub(crate) fn html(s: &Subject) -> Section {
    let settings = &s.document.settings;
    let mut body = lead(
        "The same files, command and program give the same result, digit by digit on one machine. sha256sum FILE tells whether a file is the same.",
    );
    body.push_str(&files(s));
    if !settings.model.is_empty() {
        let command = command(s);
        body.push_str(&format!(
            "<pre tabindex=\"0\"><code>{}</code></pre>\n",
            escape(&command)
        ));
    }
    body.push_str(&table(settings));
    body.push_str(&signals(s));
    body.push_str(&model(settings));
    Section::new("repeat", "To repeat it", body)
}

fn files(s: &Subject) -> String {
    let known = &s.document.settings.files;
    let now = |f: &FileEntry| s.files.iter().find(|g| g.name == f.name);
    let row = |f: &FileEntry, words: &str| {
        format!(
            "<tr><th scope=\"row\">{}</th><td><code class=\"hash\">{}</code></td><td>{words}</td></tr>\n",
            escape(&f.name),
            escape(&f.sha256)
        )
    };
    let mut rows = String::new();
    for (i, f) in known.iter().enumerate() {
        let words = match (i, now(f)) {
            (0, _) => "model",
            (_, None) => "data, not given to this report",
            (_, Some(g)) if g.sha256 == f.sha256 => "data, the same here",
            (_, Some(_)) => "data; the file of this name given here is another",
        };
        rows.push_str(&row(f, words));
    }
    for g in s.files {
        if !known.iter().skip(1).any(|f| f == g) {
            rows.push_str(&row(g, "data given here"));
        }
    }
    let none = match (known.is_empty(), s.document.settings.source.is_empty()) {
        (false, _) => String::new(),
        (true, false) => paragraph("The data were arrays in memory, not files."),
        (true, true) => paragraph(
            "The result was written by an earlier program: it does not say which content its files had.",
        ),
    };
    format!(
        "{none}<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"files\"><table>\n<thead><tr><th scope=\"col\">file</th><th scope=\"col\">SHA-256</th><th scope=\"col\"></th></tr></thead>\n\
         <tbody>\n{rows}</tbody></table></div>\n"
    )
}

/// A word quoted for the shell.
fn word(text: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "_-+=.,:/%@".contains(c);
    match !text.is_empty() && text.chars().all(plain) {
        true => text.to_string(),
        false => format!("'{}'", text.replace('\'', "'\\''")),
    }
}

/// `sidc identify …`, then the report.
fn command(s: &Subject) -> String {
    let settings = &s.document.settings;
    let mut words = vec!["sidc".to_string(), "identify".into()];
    match s.document.candidates.as_slice() {
        [] => words.push(word(&settings.model)),
        several => words.extend(several.iter().map(|c| word(&c.model))),
    }
    let data: Vec<String> = match settings.files.is_empty() {
        true => settings.data.clone(),
        false => settings
            .files
            .iter()
            .skip(1)
            .map(|f| f.name.clone())
            .collect(),
    };
    words.extend(data.iter().map(|f| word(f)));
    words.extend(options(settings));
    if s.document.equations.iter().any(|e| !e.path.is_empty()) {
        words.push("--path".into());
    }
    let verified = |e: &EquationEntry| {
        let evidence = e.evidence.as_ref();
        evidence.is_some_and(|e| e.verification.is_some())
    };
    if s.document.equations.iter().any(verified) {
        words.push("--verify".into());
    }
    let bounded = |e: &EquationEntry| e.evidence.as_ref().is_some_and(|e| e.sparsest.is_some());
    if s.document.equations.iter().any(bounded) {
        words.push("--prove-sparsest".into());
    }
    words.extend(["-o".into(), word(s.name)]);
    let given: Vec<String> = s.files.iter().map(|f| word(&f.name)).collect();
    let html = match s.name.strip_suffix(".json") {
        Some(stem) => format!("{stem}.html"),
        None => format!("{}.html", s.name),
    };
    format!(
        "{}\nsidc report {} {} -o {}",
        words.join(" "),
        word(s.name),
        given.join(" "),
        word(&html)
    )
}

fn options(s: &Settings) -> Vec<String> {
    let mut out = Vec::new();
    if let Some(n) = s.samples {
        out.push(format!("--samples={n}"));
    }
    if s.samples.is_some() || s.seed != 0 {
        out.push(format!("--seed={}", s.seed));
    }
    if let Some(window) = s.window {
        out.push(format!("--window={}", stretch(window)));
    }
    out.extend(s.holdout.iter().map(|h| format!("--holdout={}", word(h))));
    if !matches!(s.method.as_str(), "" | "auto") {
        out.push(format!("--method={}", word(&s.method)));
    }
    if !matches!(s.solver.as_str(), "" | "homotopy") {
        out.push(format!("--solver={}", word(&s.solver)));
    }
    for (name, values) in &s.params {
        let values: Vec<String> = values.iter().map(f64::to_string).collect();
        out.push(format!(
            "--param={}",
            word(&format!("{name}={}", values.join(",")))
        ));
    }
    for (name, noise) in s.reading.sensors() {
        out.push(format!("--noise={}", word(&format!("{name}={noise}"))));
    }
    if s.robust {
        out.push("--robust".into());
    }
    if let Some(ahead) = s.prediction.horizon {
        out.push(format!("--horizon={ahead}"));
    }
    for limit in &s.prediction.good {
        out.push(match limit {
            ErrorLimit::Share(part) => format!("--good={}%", significant(100.0 * part, 12)),
            ErrorLimit::Signal(name, error) => {
                format!("--good={}", word(&format!("{name}={error}")))
            }
        });
    }
    out
}

fn stretch((from, to): (Option<f64>, Option<f64>)) -> String {
    let end = |t: Option<f64>| t.map_or_else(String::new, |t| t.to_string());
    format!("{}..{}", end(from), end(to))
}

fn table(s: &Settings) -> String {
    let mut rows: Vec<(&str, String)> = Vec::new();
    let mut add = |name, value: String| {
        if !value.is_empty() {
            rows.push((name, value));
        }
    };
    add("method", s.method.clone());
    add("solver", s.solver.clone());
    add(
        "rows drawn",
        s.samples
            .map_or_else(String::new, |n| format!("{n}, seed {}", s.seed)),
    );
    add("window", s.window.map_or_else(String::new, stretch));
    add("held out", s.holdout.join(", "));
    let columns = s.reading.columns.iter();
    let columns: Vec<String> = columns
        .map(|(signal, from)| format!("{signal} = {}", from.as_deref().unwrap_or("none")))
        .collect();
    add("columns", columns.join("; "));
    add(
        "sampling interval",
        s.reading.step.map_or_else(String::new, |h| format!("{h}")),
    );
    add("program", format!("sidc {}", env!("CARGO_PKG_VERSION")));
    let rows: String = (rows.iter())
        .map(|(name, value)| {
            format!(
                "<tr><th scope=\"row\">{name}</th><td>{}</td></tr>\n",
                escape(value)
            )
        })
        .collect();
    format!("<table class=\"settings\">\n<tbody>\n{rows}</tbody></table>\n")
}

/// What was measured and what was estimated.
fn signals(s: &Subject) -> String {
    let rows: String = (s.document.signals.iter())
        .map(|e| {
            let error = e.error.map_or_else(|| "–".into(), |x| number(x, 2));
            format!(
                "<tr><th scope=\"row\">{}</th><td>{}</td><td>{error}</td></tr>\n",
                escape(&e.signal),
                escape(&e.origin)
            )
        })
        .collect();
    match rows.is_empty() {
        true => rows,
        false => format!(
            "<h3>Signals</h3>\n<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"signals\"><table>\n<thead><tr><th scope=\"col\">signal</th><th scope=\"col\">where from</th>\
             <th scope=\"col\">error, parts of its size</th></tr></thead>\n<tbody>\n{rows}</tbody></table></div>\n"
        ),
    }
}

fn model(s: &Settings) -> String {
    if s.source.is_empty() {
        return paragraph(
            "The result was written by an earlier program: it does not hold the text of its model.",
        );
    }
    let mut shown = s.source.as_str();
    let mut more = String::new();
    if shown.len() > MAX_MODEL_BYTES {
        let end = (0..=MAX_MODEL_BYTES)
            .rev()
            .find(|i| shown.is_char_boundary(*i))
            .unwrap_or(0);
        shown = shown.get(..end).unwrap_or_default();
        more = paragraph("The text goes on; the result document has it whole.");
    }
    format!(
        "<h3>The model, {}</h3>\n<pre tabindex=\"0\"><code>{}</code></pre>\n{more}",
        escape(&s.model),
        escape(shown.trim_end())
    )
}
