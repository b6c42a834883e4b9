//! Coupled equations judged together: are they independent relations, or one relation rearranged?
//!
//! Least squares cannot know: θ̈ = a sin θ + b ẍ cos θ solved for ẍ fits ẍ as well. The mass matrix along the data does.

use super::weights::rms;
use super::{Discovery, Form, Reason, Status};
use crate::data::Samples;
use crate::term::{Signal, SignalNames};

/// Scaled condition number above which two equations are taken for one.
const SINGULAR: f64 = 1e3;
/// Rows looked at.
const ROWS: usize = 200;

/// Turns coupled equations whose mass matrix is nearly singular along the data into doubts.
pub(super) fn judge_together(d: &mut Discovery, samples: &Samples) {
    let form = Form::new(d);
    if form.rows.len() < 2 || !form.coupled() || samples.is_empty() {
        return;
    }
    let scales: Vec<f64> = form.unknowns.iter().map(|u| scale(samples, *u)).collect();
    let condition = typical_condition(&form, &scales, samples);
    if condition < SINGULAR {
        return;
    }
    let names: Vec<String> = form.unknowns.iter().map(|u| d.name(*u)).collect();
    let text = format!(
        "the equations of {} are nearly one relation written twice: their mass matrix has condition {condition:.0} along the data, \
         so they cannot be solved for the highest derivatives; physics of one of them is missing from its library",
        names.join(" and ")
    );
    for e in &mut d.equations {
        if form.unknowns.contains(&e.target) && e.status != Status::Known {
            e.status = Status::Doubt;
            e.reasons.push(Reason::new("same-relation", &text));
        }
    }
}

/// Median condition number of M with rows and columns in units of the unknowns' own sizes.
fn typical_condition(form: &Form, scales: &[f64], samples: &Samples) -> f64 {
    let step = (samples.len() / ROWS).max(1);
    let mut all: Vec<f64> = (0..samples.len())
        .step_by(step)
        .map(|row| {
            let at = |s: Signal| samples.column(s).map_or(f64::NAN, |c| c.values[row]);
            let mut mass = form.mass(&at);
            for i in 0..scales.len() {
                for j in 0..scales.len() {
                    mass[(i, j)] *= scales[j] / scales[i];
                }
            }
            condition(mass)
        })
        .collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied().unwrap_or(1.0)
}

fn condition(mass: nalgebra::DMatrix<f64>) -> f64 {
    if mass.iter().any(|x| !x.is_finite()) {
        return 1.0;
    }
    let values = mass.singular_values();
    match (values.max(), values.min()) {
        (_, 0.0) => f64::MAX,
        (largest, smallest) => largest / smallest,
    }
}

fn scale(samples: &Samples, s: Signal) -> f64 {
    let size = samples.column(s).map_or(1.0, |c| rms(&c.values));
    if size > 0.0 { size } else { 1.0 }
}
