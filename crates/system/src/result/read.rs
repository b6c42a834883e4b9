//! Text → document → discovery, and the model that reads other data alike: names and terms go through the language's own parser.

use crate::discovery::{
    Correlations, Discovery, Equation, Failed, FoundTerm, HiddenState, SignalDelay, TermEvidence,
    UnknownValue,
};
use crate::result::{Document, EquationEntry, ResetEntry, TermEntry, TimeKind, VERSION};
use sidc_lang as lang;
use sidc_lang::Vocabulary;
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::model::{LibKind, Model, RightSide, Var, VarKind};
use sidc_lang::parse::is_name;
use sidc_lang::source::Sources;
use sidc_lang::term::{Signal, SignalNames, Term, VarId};
use sidc_lang::units;

/// A result, and the model that reads other data as its own were read.
#[derive(Clone, Debug)]
pub struct Opened {
    pub discovery: Discovery,
    /// Declares the discovery's variables, with data block, interpolation of inputs, noise and units.
    pub model: Model,
    pub document: Document,
}

/// Reads the discovery of a result document.
///
/// # Errors
/// As [`open`].
pub fn read(name: &str, text: &str) -> Result<Discovery, Diagnostic> {
    open(name, text).map(|opened| opened.discovery)
}

/// Reads a result document.
///
/// # Errors
/// One diagnostic for text that is no result document, for a newer version, or for terms that do not parse.
pub fn open(name: &str, text: &str) -> Result<Opened, Diagnostic> {
    let value: serde_json::Value =
        serde_json::from_str(text).map_err(|e| not_json(name, &e.to_string()))?;
    match value.get("sidc_result").and_then(serde_json::Value::as_u64) {
        None => return Err(no_result(name)),
        Some(v) if v > u64::from(VERSION) => return Err(newer(name, v)),
        Some(_) => {}
    }
    let document: Document =
        serde_json::from_value(value).map_err(|e| damaged(name, &e.to_string()))?;
    open_document(name, document)
}

/// Reads a document that is in memory.
///
/// # Errors
/// As [`open`].
pub fn open_document(name: &str, document: Document) -> Result<Opened, Diagnostic> {
    if document.sidc_result > VERSION {
        return Err(newer(name, document.sidc_result.into()));
    }
    let (discovery, model) = opened(name, &document)?;
    Ok(Opened {
        discovery,
        model,
        document,
    })
}

fn opened(name: &str, doc: &Document) -> Result<(Discovery, Model), Diagnostic> {
    plain_words(name, doc)?;
    let reading = &doc.settings.reading;
    let block = reading.block().map_err(|why| damaged(name, &why))?;
    let mut sources = Sources::default();
    let file = sources.add(name, as_model(doc) + &block);
    let vocabulary = Vocabulary { generators: vec![] };
    let (model, found) = lang::compile(file, &sources, &vocabulary);
    let Some(mut model) = model else {
        let first = found.iter().find(|d| d.is_error());
        let why = first.map_or_else(String::new, |d| d.message.clone());
        return Err(damaged(name, &why));
    };
    let asked = doc.equations.len() + doc.failed.len();
    if model.equations.len() != asked || model.vars.len() != doc.variables.len() + 1 {
        return Err(damaged(
            name,
            "its names and terms are not one declaration and one equation each",
        ));
    }
    let of_rate = model.equations.iter().any(|e| e.target.der > 0);
    let contradiction = match doc.time {
        TimeKind::Continuous if model.discrete => {
            Some("continuous, and it has an equation for a next sample")
        }
        TimeKind::Discrete if of_rate => Some("discrete, and it has an equation for a derivative"),
        _ => None,
    };
    if let Some(why) = contradiction {
        return Err(damaged(name, &format!("its time is {why}")));
    }
    let mut d = Discovery::of(&model);
    d.system = doc.system.clone();
    d.discrete = doc.time == TimeKind::Discrete;
    d.runs_left.clone_from(&doc.runs_left);
    d.rests.clone_from(&doc.rests);
    read_units(name, doc, &mut d)?;
    for (entry, equation) in doc.equations.iter().zip(&model.equations) {
        let terms = terms(&equation.right);
        if terms.len() != entry.terms.len() {
            return Err(damaged(
                name,
                &format!("the terms of {} do not parse one by one", entry.target),
            ));
        }
        d.equations.push(equation_of(entry, equation.target, terms));
    }
    for entry in &doc.failed {
        let target = model
            .equations
            .iter()
            .map(|e| e.target)
            .find(|t| model.name(*t) == entry.target);
        if let Some(target) = target {
            d.failed.push(Failed {
                target,
                reasons: entry.reasons.clone(),
            });
        }
    }
    let jumps = |r: &ResetEntry| r.jumps.len();
    let as_many = doc
        .resets
        .iter()
        .map(jumps)
        .eq(d.resets.iter().map(|r| r.jumps.len()));
    if !as_many {
        return Err(damaged(
            name,
            "its resets are not one condition and its jumps each",
        ));
    }
    d.relations.clone_from(&doc.relations);
    d.delays.clone_from(&doc.delays);
    let unknown = |delay: &&SignalDelay| {
        let mut names = d.variables.iter().map(|v| &v.name);
        !delay.seconds.is_finite() || !names.any(|name| *name == delay.signal)
    };
    if let Some(delay) = d.delays.iter().find(unknown) {
        let why = format!("{:?} is delayed and is no variable", delay.signal);
        return Err(damaged(name, &why));
    }
    d.unknowns.clone_from(&doc.unknowns);
    let is_unknown = |u: &UnknownValue| {
        let mut all = d.variables.iter();
        u.value.is_finite() && all.any(|v| v.name == u.name && v.kind == VarKind::Unknown)
    };
    if let Some(u) = d.unknowns.iter().find(|u| !is_unknown(u)) {
        let why = format!("{:?} has a value and is no unknown constant", u.name);
        return Err(damaged(name, &why));
    }
    d.correlations.clone_from(&doc.correlations);
    if !d.correlations.iter().all(Correlations::is_sound) {
        return Err(damaged(
            name,
            "its correlations are not one for each pair of coefficients",
        ));
    }
    d.hidden.clone_from(&doc.hidden);
    let wrong = |h: &&HiddenState| {
        let sound = h.mean.is_finite() && h.deviation.is_finite() && h.deviation >= 0.0;
        !sound || !hidden_names(&model).contains(&h.name)
    };
    if let Some(h) = d.hidden.iter().find(wrong) {
        return Err(damaged(
            name,
            &format!("{:?} is hidden and is no state", h.name),
        ));
    }
    if model.data.entries.len() != reading.columns.len() {
        return Err(damaged(name, "its data block is not one entry a signal"));
    }
    model.discrete = d.discrete;
    let applied = reading.apply(&mut model);
    applied.map_err(|why| damaged(name, &why))?;
    Ok((d, model))
}

/// The names of hidden states and of their derivatives below the highest.
fn hidden_names(model: &Model) -> Vec<String> {
    let chain = |(id, var): (VarId, &Var)| {
        let order = var.order;
        (0..order).map(move |der| Signal::derivative(id, der))
    };
    let signals = model.hidden_states().flat_map(chain);
    signals.map(|s| model.name(s)).collect()
}

/// The units of time and of the variables, in the order of the document.
fn read_units(name: &str, doc: &Document, d: &mut Discovery) -> Result<(), Diagnostic> {
    let written = doc.variables.iter().map(|v| v.unit.as_deref());
    let all = std::iter::once(doc.time_unit.as_deref()).chain(written);
    for (variable, text) in d.variables.iter_mut().zip(all) {
        let Some(text) = text else { continue };
        let (unit, _) = units::parse(text)
            .map_err(|fault| damaged(name, &format!("{text:?} is no unit: {}", fault.cause)))?;
        variable.unit = Some(unit);
    }
    Ok(())
}

/// Checks that text that becomes part of a model is what it claims to be: a name is a word, and no term or target can
/// end its statement.
fn plain_words(name: &str, doc: &Document) -> Result<(), Diagnostic> {
    let names = doc.variables.iter().map(|v| &v.name).chain(&doc.system);
    for text in names {
        if !is_name(text) {
            return Err(damaged(name, &format!("{text:?} is no name")));
        }
    }
    const KINDS: [&str; 5] = ["state", "input", "output", "param", "unknown"];
    if let Some(v) = doc
        .variables
        .iter()
        .find(|v| !KINDS.contains(&v.kind.as_str()))
    {
        let why = format!("{:?} is no kind of variable", v.kind);
        return Err(damaged(name, &why));
    }
    let targets = doc.equations.iter().map(|e| &e.target);
    let written = targets
        .chain(doc.failed.iter().map(|f| &f.target))
        .chain(doc.equations.iter().flat_map(|e| &e.terms).map(|t| &t.term));
    for text in written {
        if text
            .chars()
            .any(|c| c.is_control() || "#~=;{}\"".contains(c))
        {
            return Err(damaged(name, &format!("{text:?} is no term")));
        }
    }
    let jumps = doc.resets.iter().flat_map(|r| &r.jumps);
    let parts = jumps.flat_map(|j| [(&j.signal, "#~=;:{}\"<>"), (&j.value, "#~=;:{}\"<>")]);
    let parts = parts.chain(doc.resets.iter().map(|r| (&r.when, "#~=;:{}\"")));
    for (text, reserved) in parts {
        if text.contains(|c: char| c.is_control() || reserved.contains(c)) {
            return Err(damaged(name, &format!("{text:?} is no part of a reset")));
        }
    }
    Ok(())
}

/// A model that declares the document's variables and lists its terms, so that one parser reads both.
fn as_model(doc: &Document) -> String {
    let mut text = String::new();
    for v in &doc.variables {
        match (v.kind.as_str(), v.order) {
            ("state", _) if doc.time == TimeKind::Discrete => {
                text.push_str(&format!("state {}\n", v.name));
            }
            ("state", n) if doc.hidden.iter().any(|h| h.name == v.name) => {
                text.push_str(&format!("state {} : order {n}, hidden\n", v.name));
            }
            ("state" | "input", n) => {
                text.push_str(&format!("{} {} : order {n}\n", v.kind, v.name));
            }
            (kind, _) => text.push_str(&format!("{kind} {}\n", v.name)),
        }
    }
    for e in &doc.equations {
        let terms: Vec<&str> = e.terms.iter().map(|t| t.term.as_str()).collect();
        let right = if terms.is_empty() {
            "= 0".to_string()
        } else {
            format!("~ <{}>", terms.join(", "))
        };
        text.push_str(&format!("{} {right}\n", e.target));
    }
    for f in &doc.failed {
        text.push_str(&format!("{} = 0\n", f.target));
    }
    for r in &doc.resets {
        let jumps = r.jumps.iter();
        let jumps = jumps.map(|j| format!("{} -> {}", j.signal, j.value));
        let jumps = jumps.collect::<Vec<_>>().join(", ");
        text.push_str(&format!("when {} : {jumps}\n", r.when));
    }
    text
}

fn terms(right: &RightSide) -> Vec<Term> {
    let RightSide::Search {
        library: Some(library),
        ..
    } = right
    else {
        return Vec::new();
    };
    let LibKind::List(items) = &library.kind else {
        return Vec::new();
    };
    items
        .iter()
        .filter_map(|i| match &i.kind {
            LibKind::Term(e) => Some(e.clone().into_term().1),
            _ => None,
        })
        .collect()
}

fn equation_of(
    entry: &EquationEntry,
    target: sidc_lang::term::Signal,
    terms: Vec<Term>,
) -> Equation {
    Equation {
        target,
        terms: entry
            .terms
            .iter()
            .zip(terms)
            .map(|(t, term)| FoundTerm {
                term,
                coefficient: t.coefficient,
                fixed: t.fixed,
                standard_error: t.standard_error,
                evidence: trust(t),
                runs: t.runs.clone(),
            })
            .collect(),
        status: entry.status,
        reasons: entry.reasons.clone(),
        evidence: entry.evidence.clone(),
        // Readers do not need the solution path.
        path: Vec::new(),
    }
}

/// `None` for terms that were not judged.
fn trust(t: &TermEntry) -> Option<Box<TermEvidence>> {
    Some(Box::new(TermEvidence {
        interval: t.interval,
        stability: t.stability,
        without: t.without.clone(),
        mark: t.mark?,
    }))
}

fn not_json(name: &str, why: &str) -> Diagnostic {
    Diagnostic::error("result-not-json", format!("{name} is not JSON: {why}"))
        .help("give the file that `sidc identify … -o R.json` wrote")
}

fn no_result(name: &str) -> Diagnostic {
    Diagnostic::error(
        "result-unknown",
        format!("{name} is JSON, but not a result of sidc: it has no `sidc_result`"),
    )
    .help("give the file that `sidc identify … -o R.json` wrote")
}

fn newer(name: &str, version: u64) -> Diagnostic {
    Diagnostic::error(
        "result-newer",
        format!("{name} is a result of version {version}; this program reads up to {VERSION}"),
    )
    .help("update sidc")
}

fn damaged(name: &str, why: &str) -> Diagnostic {
    Diagnostic::error("result-damaged", format!("{name} is damaged: {why}"))
        .help("write it again with `sidc identify … -o R.json`")
}
