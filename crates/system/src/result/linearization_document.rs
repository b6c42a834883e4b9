//! The local analysis of a system as a document: matrices by rows, signals by name.
//!
//! Pinned as the result document is: first key `"sidc_linearization": 1`; fields are only ever added; numbers
//! round-trip f64.

use std::collections::BTreeMap;

use nalgebra::DMatrix;
use serde::Serialize;

use crate::algebra::{LocalAnalysis, Mode, Point, Stability};
use crate::discovery::{Discovery, Notice};
use crate::result::TimeKind;
use sidc_lang::term::{Signal, SignalNames};

/// Version of the document.
const VERSION: u32 = 1;

/// The document. Keys come out in this order.
#[derive(Serialize)]
struct Linearization {
    sidc_linearization: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    system: Option<String>,
    time: TimeKind,
    /// The point: states, inputs and parameters.
    at: BTreeMap<String, f64>,
    /// Signals of the point that were not given.
    assumed: Vec<String>,
    states: Vec<String>,
    inputs: Vec<String>,
    /// What the rows of A and B give.
    rates: Vec<String>,
    #[serde(rename = "A")]
    a: Vec<Vec<f64>>,
    #[serde(rename = "B")]
    b: Vec<Vec<f64>>,
    /// ẋ, or x\[k+1\] − x\[k\], at the point.
    f: Vec<f64>,
    equilibrium: bool,
    /// Inputs for which the point would be an equilibrium.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    balance: BTreeMap<String, f64>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    outputs: Vec<String>,
    #[serde(rename = "C", skip_serializing_if = "Vec::is_empty")]
    c: Vec<Vec<f64>>,
    #[serde(rename = "D", skip_serializing_if = "Vec::is_empty")]
    d: Vec<Vec<f64>>,
    /// Outputs at the point.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    y: Vec<f64>,
    /// All n of them; empty if they were not found.
    eigenvalues: Vec<Eigenvalue>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stability: Option<&'static str>,
    /// Inputs that count for the controllable rank.
    actuators: Vec<String>,
    controllable_rank: usize,
    warnings: Vec<Notice>,
}

#[derive(Serialize)]
struct Eigenvalue {
    re: f64,
    im: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    damping: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    frequency: Option<f64>,
    /// Negative if the mode grows.
    #[serde(skip_serializing_if = "Option::is_none")]
    time_constant: Option<f64>,
}

/// The document of a local analysis. `named` are the signals whose value was given.
///
/// # Errors
/// Those of the JSON writer.
pub fn linearization(
    d: &Discovery,
    near: &LocalAnalysis,
    point: &Point,
    named: &[Signal],
    warnings: &[Notice],
) -> Result<String, serde_json::Error> {
    let l = &near.linear;
    let names = |all: &[Signal]| -> Vec<String> { all.iter().map(|s| d.name(*s)).collect() };
    let signals: Vec<Signal> = l.states.iter().chain(&l.inputs).copied().collect();
    let given = point.0.keys().filter(|s| !signals.contains(s));
    let at = signals.iter().chain(given);
    let balance = near.actuators.iter().zip(near.balance.iter().flatten());
    let assumed: Vec<Signal> = (signals.iter().copied())
        .filter(|s| !named.contains(s))
        .collect();
    let document = Linearization {
        sidc_linearization: VERSION,
        system: d.system.clone(),
        time: match d.discrete {
            true => TimeKind::Discrete,
            false => TimeKind::Continuous,
        },
        at: at.map(|s| (d.name(*s), point.value(*s))).collect(),
        assumed: names(&assumed),
        states: names(&l.states),
        inputs: names(&l.inputs),
        rates: names(&l.rates),
        a: rows(&l.a),
        b: rows(&l.b),
        f: l.drift.clone(),
        equilibrium: l.is_equilibrium(),
        balance: balance.map(|(s, v)| (d.name(*s), *v)).collect(),
        outputs: names(&l.outputs),
        c: rows(&l.c),
        d: rows(&l.d),
        y: l.output.clone(),
        eigenvalues: near.modes.iter().flatten().flat_map(both).collect(),
        stability: near.stability.map(|s| match s {
            Stability::Stable => "stable",
            Stability::Marginal(_) => "border",
            Stability::Unstable(_) => "unstable",
        }),
        actuators: names(&near.actuators),
        controllable_rank: near.controllable_rank,
        warnings: warnings.to_vec(),
    };
    Ok(serde_json::to_string_pretty(&document)? + "\n")
}

fn rows(m: &DMatrix<f64>) -> Vec<Vec<f64>> {
    // Adding zero turns −0, whose sign means nothing, into 0.
    let row = |i| m.row(i).iter().map(|x| x + 0.0).collect();
    (0..m.nrows()).map(row).collect()
}

/// A real eigenvalue, or both of a pair.
fn both(m: &Mode) -> Vec<Eigenvalue> {
    let one = |im: f64| Eigenvalue {
        re: m.re + 0.0,
        im,
        damping: m.damping(),
        frequency: m.frequency(),
        time_constant: m.time_constant(),
    };
    match m.im > 0.0 {
        true => vec![one(m.im), one(-m.im)],
        false => vec![one(0.0)],
    }
}
