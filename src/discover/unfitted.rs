//! A system that could not be fitted together with its trajectory: why, as far as the readings tell.
//!
//! In: the problem. Out: an answer without equations, each with its reason; the states as they were read. Fits nothing.

use super::dependent::Measured;
use super::{Discovery, Failed, Reason};
use crate::lang::model::Model;
use crate::term::SignalNames;
use crate::trajectory::Problem;

/// Spread of the readings over the noise below which a state does not move.
const STILL: f64 = 1.2;

/// Equations of a system that could not be fitted together.
pub fn nothing_fits(model: &Model, problem: &Problem) -> Discovery {
    let mut discovery = Discovery::of(model);
    let still: Vec<String> = measured_states(problem)
        .iter()
        .filter(|m| spread(&m.values) < STILL * m.noise)
        .map(|m| model.name(m.signal))
        .collect();
    let reason = if still.is_empty() {
        Reason::new(
            "no-trajectory",
            "no equations from these libraries lead along the data: hidden states, a library without the physics, or \
             samples too far apart; `--method regression` shows what each equation fits alone",
        )
    } else {
        Reason::new(
            "no-motion",
            format!(
                "{}: no motion beyond the noise of the sensor; record data in which the system moves",
                still.join(", ")
            ),
        )
    };
    for law in &problem.system.laws {
        discovery.failed.push(Failed {
            target: law.target,
            reasons: vec![reason.clone()],
        });
    }
    discovery
}

/// Standard deviation of what was read.
fn spread(values: &[f64]) -> f64 {
    let read: Vec<f64> = values.iter().copied().filter(|x| x.is_finite()).collect();
    let count = read.len().max(1) as f64;
    let mean = read.iter().sum::<f64>() / count;
    (read.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count).sqrt()
}

/// The states as they were read.
pub(super) fn measured_states(problem: &Problem) -> Vec<Measured> {
    let states = problem.system.states.iter().enumerate();
    let read = states.filter(|(i, s)| s.der == 0 && problem.readings[*i] > 0);
    read.map(|(i, signal)| Measured {
        signal: *signal,
        values: (problem.records.iter())
            .flat_map(|r| r.measured[i].iter().copied())
            .collect(),
        noise: problem.noise[i],
    })
    .collect()
}
