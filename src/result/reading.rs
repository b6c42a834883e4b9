//! How the data of a result were read, so that others can be read alike: the data block, courses of inputs, noise.
//!
//! In: a model. Out: plain text and numbers for the document; and back, lines of a data block that the language's own parser
//! reads. Text that could be anything else than one entry's arithmetic is refused.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::lang::model::{Between, ColumnExpr, ColumnKind, Model};
use crate::lang::parse::token::is_name;
use crate::term::{Signal, SignalNames, VarId};

/// What a model says of its data. Everything is absent in documents of earlier programs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// Signal → arithmetic on columns; `null` for one that is not to be read. Others are the columns of their names.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub columns: BTreeMap<String, Option<String>>,
    /// Sampling interval where there are no times, seconds.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub step: Option<f64>,
    /// Column that tells trajectories apart.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub run: Option<String>,
    /// Input → its course between samples, declared or decided.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub between: BTreeMap<String, CourseEntry>,
    /// Signal → standard deviation of its sensor, in units of the model, where it was said.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub noise: BTreeMap<String, f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CourseEntry {
    Hold,
    Linear,
}

impl Reading {
    /// What a model says. `between` of its inputs should be as decided, where it was not declared.
    pub fn of(model: &Model) -> Reading {
        let mut out = Reading {
            step: model.data.step.map(|(step, _)| step),
            run: model.data.run.as_ref().map(|(header, _)| header.clone()),
            ..Reading::default()
        };
        for e in &model.data.entries {
            let source = e.source.as_ref().map(|s| written(s, 0));
            out.columns.insert(model.name(e.signal), source);
        }
        for (id, var) in (0..).map(VarId).zip(&model.vars) {
            if let Some(between) = var.between {
                let course = match between {
                    Between::Hold => CourseEntry::Hold,
                    Between::Linear => CourseEntry::Linear,
                };
                out.between.insert(var.name.clone(), course);
            }
            for (der, sigma) in &var.noise {
                let name = model.name(Signal::derivative(id, *der));
                out.noise.insert(name, *sigma);
            }
        }
        out
    }

    /// The data block as a model has it; empty if there is none. `Err` is what is no entry.
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

    /// Puts what is not text of the data block into the model. `Err` is a name that the model does not have.
    pub(super) fn apply(&self, model: &mut Model) -> Result<(), String> {
        for (name, course) in &self.between {
            let var = model.vars.iter_mut().find(|v| v.name == *name);
            let var = var.ok_or_else(|| format!("{name:?} is no input"))?;
            var.between = Some(match course {
                CourseEntry::Hold => Between::Hold,
                CourseEntry::Linear => Between::Linear,
            });
        }
        for (name, sigma) in &self.noise {
            let signal = signal(model, name).ok_or_else(|| format!("{name:?} is no signal"))?;
            let var = model.vars.get_mut(usize::from(signal.var.0));
            if let Some(var) = var.filter(|_| *sigma > 0.0 && sigma.is_finite()) {
                var.noise.insert(signal.der, *sigma);
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

/// Names, numbers, operators and quoted headers: nothing that could end the line it stands on.
fn is_arithmetic(text: &str) -> bool {
    let mut quoted = false;
    for c in text.chars() {
        match c {
            '"' => quoted = !quoted,
            '\n' => return false,
            // Whatever a model may have in quotes.
            _ if quoted => {}
            c if c.is_ascii_alphanumeric() || " _.+-*/^(),".contains(c) => {}
            _ => return false,
        }
    }
    !quoted && !text.trim().is_empty()
}

/// Arithmetic as the language has it; `outer` is how strongly the operator around it binds.
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
