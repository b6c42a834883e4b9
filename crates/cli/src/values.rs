//! How the values of options are written, and what they mean: methods, solvers, stretches of time, noises, parameters.

use std::path::{Path, PathBuf};

use super::{Failure, hint};
use sidc::pipeline::{self, NoiseFault, Program};
use sidc_data::HoldOutRange;
use sidc_discover::{METHODS, Method};
use sidc_lang::diagnostic::did_you_mean;
use sidc_solve::{SOLVERS, Solver};

/// What a name stands for among those known.
pub fn one_of<T>(
    name: &str,
    all: impl Iterator<Item = (&'static str, T)> + Clone,
) -> Result<T, String> {
    let names = all.clone().map(|(n, _)| n);
    let mut all = all;
    all.find(|(n, _)| *n == name)
        .map(|(_, found)| found)
        .ok_or_else(|| {
            let known: Vec<&str> = names.clone().collect();
            match did_you_mean(name, names) {
                Some(n) => format!("did you mean `{n}`? known: {}", known.join(", ")),
                None => format!("known: {}", known.join(", ")),
            }
        })
}

/// A name of `identify --method`.
pub fn method(name: &str) -> Result<Method, String> {
    one_of(name, METHODS.iter().copied())
}

/// A name of `--solver`.
pub fn solver(name: &str) -> Result<&'static dyn Solver, String> {
    one_of(name, SOLVERS.iter().map(|s| (s.name(), *s)))
}

/// `2..10`, `..5`, `3..`
pub fn window(text: &str) -> Result<(Option<f64>, Option<f64>), String> {
    let (from, to) = text
        .split_once("..")
        .ok_or("write a stretch of time as A..B")?;
    let end = |t: &str| -> Result<Option<f64>, String> {
        if t.trim().is_empty() {
            return Ok(None);
        }
        match t.trim().parse::<f64>() {
            Ok(x) if x.is_finite() => Ok(Some(x)),
            _ => Err(format!("`{t}` is not a time in seconds")),
        }
    };
    let (from, to) = (end(from)?, end(to)?);
    match (from, to) {
        (Some(a), Some(b)) if a >= b => Err(format!("{a} is not before {b}")),
        ends => Ok(ends),
    }
}

/// What `--holdout` takes: a part of every record, or a file.
#[derive(Clone, Debug)]
pub enum Held {
    Stretch(HoldOutRange),
    File(PathBuf),
}

impl Held {
    pub fn file(&self) -> Option<&PathBuf> {
        match self {
            Held::File(path) => Some(path),
            Held::Stretch(_) => None,
        }
    }
}

/// `30..40`, `25%`, `test.csv`
pub fn held(text: &str) -> Result<Held, String> {
    if let Some(part) = text.strip_suffix('%') {
        return match part.trim().parse::<f64>() {
            Ok(p) if p > 0.0 && p < 100.0 => Ok(Held::Stretch(HoldOutRange::Last(p / 100.0))),
            _ => Err("a part is above 0 % and below 100 %".into()),
        };
    }
    let path = Path::new(text);
    if path.is_file() {
        return Ok(Held::File(path.into()));
    }
    if !text.contains("..") {
        return Err(
            "there is no data file of this name; a stretch of time is written A..B, a part of every record 25%"
                .into(),
        );
    }
    let (from, to) = window(text)?;
    Ok(Held::Stretch(HoldOutRange::Times(from, to)))
}

/// `-60`
pub fn decibels(text: &str) -> Result<f64, String> {
    let number = text.trim_end_matches("dB").trim();
    match number.parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err("write decibels as -60; 0 dB is an error as large as the signal".into()),
    }
}

/// `theta=0.01`
pub fn noise(text: &str) -> Result<(String, f64), String> {
    match parameter(text)? {
        (name, values) if values.len() == 1 && values.iter().all(|x| *x > 0.0) => {
            Ok((name, values.iter().sum()))
        }
        _ => Err("a noise is one number above 0, a standard deviation".into()),
    }
}

/// What the command line says of the sensors holds over the model.
pub fn set_noise(program: &mut Program, noise: &[(String, f64)]) -> Result<(), Failure> {
    pipeline::set_noise(program, noise).map_err(|fault| match fault {
        NoiseFault::Twice(name) => given_twice("--noise", &name),
        NoiseFault::Unknown { name, measured } => {
            let hint = hint(&name, measured.iter().map(String::as_str));
            Failure::new(format!(
                "error[unknown-noise]: --noise {name}: the model measures no signal of this name{hint}\n  = measured: {}",
                measured.join(", ")
            ))
        }
    })
}

/// A name of an option that takes one value for each.
pub fn given_twice(option: &str, name: &str) -> Failure {
    Failure::new(format!(
        "error[given-twice]: {option} {name}: this has a value already\n  = help: one value a name"
    ))
}

/// `m=0.3,0.5`
pub fn parameter(text: &str) -> Result<(String, Vec<f64>), String> {
    let (name, values) = text
        .split_once('=')
        .ok_or("write a parameter as name=value")?;
    let values: Result<Vec<f64>, String> = values
        .split(',')
        .map(|v| match v.trim().parse::<f64>() {
            Ok(x) if x.is_finite() => Ok(x),
            _ => Err(format!("`{v}` is not a number")),
        })
        .collect();
    Ok((name.trim().to_string(), values?))
}
