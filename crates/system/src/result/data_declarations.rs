//! How the data of a result were read, so that other data can be read alike: data block, interpolation of inputs,
//! noise.
//!
//! In: a model. Out: plain text and numbers for the document, and back. Text that could be more than the arithmetic of
//! one entry is refused: it goes to the parser of the language.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use sidc_lang::model::{Between, ColumnExpr, ColumnKind, Model};
use sidc_lang::parse::is_name;
use sidc_lang::sensor_noise::SensorNoise;
use sidc_lang::term::{Signal, SignalNames, VarId};

/// What a model declares about its data. All absent in documents of earlier versions.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// Signal → arithmetic on columns; `null` for one that is not read. Other signals are columns of their own name.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub columns: BTreeMap<String, Option<String>>,
    /// Sampling interval in seconds where no times are read.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub step: Option<f64>,
    /// Column that separates trajectories.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub run: Option<String>,
    /// Input → its interpolation between samples, declared or decided.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub between: BTreeMap<String, CourseEntry>,
    /// Signal → standard deviation of its sensor, in units of the model, where declared.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub noise: BTreeMap<String, f64>,
    /// Signal → noise as a share of the value, where declared.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub noise_share: BTreeMap<String, f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CourseEntry {
    Hold,
    Linear,
    Cubic,
}

impl Reading {
    /// The declarations of a model, whose `between` of inputs should be filled in where it was decided.
    pub fn of(model: &Model) -> Reading {
        let mut out = Reading {
            step: model.data.step.map(|(step, _)| step),
            run: model.data.run.as_ref().map(|(header, _)| header.clone()),
            ..Reading::default()
        };
        for e in &model.data.entries {
            let all = e.source.iter().chain(&e.beside).map(|s| written(s, 0));
            let all: Vec<String> = all.collect();
            let source = Some(all.join(", ")).filter(|_| e.source.is_some());
            out.columns.insert(model.name(e.signal), source);
        }
        for (id, var) in (0..).map(VarId).zip(&model.vars) {
            if let Some(between) = var.between {
                let course = match between {
                    Between::Hold => CourseEntry::Hold,
                    Between::Linear => CourseEntry::Linear,
                    Between::Cubic => CourseEntry::Cubic,
                };
                out.between.insert(var.name.clone(), course);
            }
            for (der, noise) in &var.noise {
                let name = model.name(Signal::derivative(id, *der));
                if noise.grows() {
                    out.noise_share.insert(name.clone(), noise.share);
                }
                if noise.floor > 0.0 {
                    out.noise.insert(name, noise.floor);
                }
            }
        }
        out
    }

    /// The noise of every sensor that was declared, by name.
    pub fn sensors(&self) -> BTreeMap<&str, SensorNoise> {
        let mut out: BTreeMap<&str, SensorNoise> = BTreeMap::new();
        for (name, floor) in &self.noise {
            out.entry(name).or_default().floor = *floor;
        }
        for (name, share) in &self.noise_share {
            out.entry(name).or_default().share = *share;
        }
        out
    }

    /// The data block as text; empty if there is none. `Err` is text that is not an entry.
    pub(super) fn block(&self) -> Result<String, String> {
        let mut lines = Vec::new();
        for (signal, source) in &self.columns {
            let source = source.as_deref().unwrap_or("none");
            if !is_name(signal) || !is_arithmetic(source) {
                return Err(format!(
                    "{signal:?} = {source:?} is no entry of a data block"
                ));
            }
            lines.push(format!("  {signal} = {source}\n"));
        }
        if let Some(step) = self.step {
            if !(step > 0.0 && step.is_finite()) {
                return Err(format!("{step} is no sampling interval"));
            }
            lines.push(format!("  step {step:?}\n"));
        }
        if let Some(run) = &self.run {
            if run.contains(['"', '\n']) {
                return Err(format!("{run:?} is no header"));
            }
            lines.push(format!("  run = \"{run}\"\n"));
        }
        if lines.is_empty() {
            return Ok(String::new());
        }
        Ok(format!("data {{\n{}}}\n", lines.concat()))
    }

    /// Adds to a model what is not text of the data block. `Err` is a name that the model does not have.
    pub(super) fn apply(&self, model: &mut Model) -> Result<(), String> {
        for (name, course) in &self.between {
            let var = model.vars.iter_mut().find(|v| v.name == *name);
            let var = var.ok_or_else(|| format!("{name:?} is no input"))?;
            var.between = Some(match course {
                CourseEntry::Hold => Between::Hold,
                CourseEntry::Linear => Between::Linear,
                CourseEntry::Cubic => Between::Cubic,
            });
        }
        for (name, noise) in self.sensors() {
            let signal = signal(model, name).ok_or_else(|| format!("{name:?} is no signal"))?;
            let var = model.vars.get_mut(usize::from(signal.var.0));
            if let Some(var) = var.filter(|_| noise.is_valid()) {
                var.noise.insert(signal.der, noise);
            }
        }
        Ok(())
    }
}

/// A variable or one of its derivatives, by name.
fn signal(model: &Model, name: &str) -> Option<Signal> {
    let all = (0..).map(VarId).zip(&model.vars);
    let mut signals = all.flat_map(|(id, v)| (0..=v.order).map(move |d| Signal::derivative(id, d)));
    signals.find(|s| model.name(*s) == name)
}

/// Allows names, numbers, operators and quoted headers: nothing that could end a line.
fn is_arithmetic(text: &str) -> bool {
    let mut quoted = false;
    for c in text.chars() {
        match c {
            '"' => quoted = !quoted,
            '\n' => return false,
            // Any text that a model may have in quotes.
            _ if quoted => {}
            c if c.is_ascii_alphanumeric() || " _.+-*/^(),".contains(c) => {}
            _ => return false,
        }
    }
    !quoted && !text.trim().is_empty()
}

/// Arithmetic in the syntax of the language; `outer` is the precedence around it.
fn written(e: &ColumnExpr, outer: u8) -> String {
    let two = |a: &ColumnExpr, op: &str, b: &ColumnExpr, own: u8| {
        let text = format!("{} {op} {}", written(a, own), written(b, own + 1));
        (text, own)
    };
    let (text, own) = match &e.kind {
        ColumnKind::Number(x) if *x < 0.0 => (format!("-{:?}", -x), 0),
        ColumnKind::Number(x) => (format!("{x:?}"), 9),
        ColumnKind::Column(header) => (format!("\"{header}\""), 9),
        ColumnKind::Negate(a) => (format!("-{}", written(a, 3)), 0),
        ColumnKind::Add(a, b) => two(a, "+", b, 1),
        ColumnKind::Subtract(a, b) => two(a, "-", b, 1),
        ColumnKind::Multiply(a, b) => two(a, "*", b, 2),
        ColumnKind::Divide(a, b) => two(a, "/", b, 2),
        ColumnKind::Power(a, p) => (format!("{}^({p:?})", written(a, 9)), 4),
        ColumnKind::Unwrap(a, p) => (format!("unwrap({}, {p:?})", written(a, 0)), 9),
        ColumnKind::Call(f, args) => {
            let args: Vec<String> = args.iter().map(|a| written(a, 0)).collect();
            (format!("{}({})", f.name, args.join(", ")), 9)
        }
    };
    match own < outer {
        true => format!("({text})"),
        false => text,
    }
}
