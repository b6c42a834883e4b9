//! A system for which no trajectory could be fitted: the reason, as far as the readings show it.
//!
//! In: the problem. Out: a discovery in which every equation failed; the readings of the states. Never fits anything.

use crate::doubts::dependent_states::MeasuredState;
use crate::joint::thresholds::JOINT;
use crate::trajectory::Problem;
use sidc_lang::model::Model;
use sidc_lang::term::{Signal, SignalNames};
use sidc_system::discovery::{Change, Discovery, Failed, Reason, ReasonCode};

/// The discovery for a system that could not be fitted.
pub fn nothing_fits(model: &Model, problem: &Problem) -> Discovery {
    let mut discovery = Discovery::of(model);
    let still: Vec<String> = still(problem).iter().map(|s| model.name(*s)).collect();
    let hidden: Vec<&str> = model
        .hidden_states()
        .map(|(_, v)| v.name.as_str())
        .collect();
    let reason = if still.is_empty() && problem.system.columns.is_empty() {
        let text =
            "these laws do not lead along the data, whatever start their constants were given";
        let way = "look for a term or a sign that the laws lack, give narrower ranges, or record a calmer or shorter run";
        Reason::new(ReasonCode::NoTrajectory, text).remedy(way)
    } else if still.is_empty() && !hidden.is_empty() {
        let text = format!(
            "no course of the hidden {} was found from which these libraries lead along the data",
            hidden.join(", ")
        );
        let way = "give the law of what is hidden, with `unknown` constants in narrower ranges, or record a calmer or shorter run";
        Reason::new(ReasonCode::NoTrajectory, text).remedy(way)
    } else if still.is_empty() {
        Reason::new(
            ReasonCode::NoTrajectory,
            "no equations from these libraries lead along the data: hidden states, a library without the physics, or \
             samples too far apart",
        )
        .change(
            ReasonCode::NoTrajectory.usual_remedy(),
            Change::Options("--method regression".into()),
        )
    } else {
        Reason::new(
            ReasonCode::NoMotion,
            format!(
                "{}: no motion beyond the noise of the sensor",
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

/// The states whose readings show no motion beyond the noise of their sensor.
pub(crate) fn still(problem: &Problem) -> Vec<Signal> {
    let states = measured_states(problem).into_iter();
    let still = states.filter(|m| spread(&m.values) < JOINT.no_motion * m.noise);
    still.map(|m| m.signal).collect()
}

/// Standard deviation of the finite readings.
fn spread(values: &[f64]) -> f64 {
    let read: Vec<f64> = values.iter().copied().filter(|x| x.is_finite()).collect();
    let count = read.len().max(1) as f64;
    let mean = read.iter().sum::<f64>() / count;
    (read.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count).sqrt()
}

/// The readings of the measured states.
pub(crate) fn measured_states(problem: &Problem) -> Vec<MeasuredState> {
    let states = problem.system.states.iter().enumerate();
    let read: Vec<usize> = problem.read_states().collect();
    let read = states.filter(|(i, s)| s.der == 0 && read.contains(i));
    read.map(|(i, signal)| MeasuredState {
        signal: *signal,
        values: (problem.records.iter())
            .flat_map(|r| r.measured[i].iter().copied())
            .collect(),
        noise: problem.noise[i] * problem.rms_over_level(i),
    })
    .collect()
}
