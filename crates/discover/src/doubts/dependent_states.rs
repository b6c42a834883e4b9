//! States that are linearly dependent along the data, such as S + E + I + R = 1.
//!
//! In: readings of the states with their noise. Out: a doubt with the relation. Through such a relation terms can be exchanged for
//! others without a trace in the data. It is found as the smallest eigenvalue of the covariance of the states in units of noise: a
//! combination that varies no more than the noise of its parts is constant. Never removes a state.

use crate::doubts::thresholds::DEPENDENT_STATES;
use nalgebra::DMatrix;

use sidc_data::{Origin, Samples};
use sidc_lang::model::Model;
use sidc_lang::term::{Signal, SignalNames, Term};
use sidc_solve::{rms_autocorrelation, white_noise_bound};
use sidc_system::discovery::{Discovery, FoundTerm, Reason, ReasonCode, Status};

/// Readings of one state; NaN where there is none.
pub(crate) struct MeasuredState {
    pub signal: Signal,
    pub values: Vec<f64>,
    /// Standard deviation; 0 if nothing is known of it.
    pub noise: f64,
}

/// A linear relation between states.
struct LinearRelation {
    signals: Vec<Signal>,
    text: String,
}

/// The measured states of a model, with the noise declared for them.
pub(crate) fn states_in_samples(model: &Model, samples: &Samples) -> Vec<MeasuredState> {
    let state = |s: Signal| {
        s.der == 0
            && model
                .equations
                .iter()
                .any(|e| e.target.var == s.var && e.target.der > 0)
    };
    let columns = samples.columns.iter().filter(|c| state(c.signal));
    columns
        .filter_map(|c| match &c.origin {
            Origin::Measured { noise } => Some(MeasuredState {
                signal: c.signal,
                values: c.values.clone(),
                noise: noise.map_or(0.0, |noise| noise.rms(&c.values)),
            }),
            Origin::Estimated { .. } => None,
        })
        .collect()
}

/// Doubts every equation that is the time derivative of a relation between states: its terms are nothing but targets of other
/// equations, with constant coefficients. It says that a combination of states stays constant, and no more.
fn doubt_total_derivatives(d: &mut Discovery) {
    let targets: Vec<Signal> = d.equations.iter().map(|e| e.target).collect();
    let other_target = |t: &FoundTerm, own: Signal| {
        let among = targets.iter().find(|s| t.term == Term::signal(**s));
        among.copied().filter(|s| *s != own && s.der > 0)
    };
    d.doubt_each(|d, e| {
        if e.terms.is_empty() {
            return None;
        }
        let others = e.terms.iter().map(|t| other_target(t, e.target));
        let others: Option<Vec<Signal>> = others.collect();
        let mut states = vec![e.target];
        states.extend(others?);
        let below = states.iter().map(|s| Signal {
            der: s.der - 1,
            ..*s
        });
        let names: Vec<String> = below.map(|s| d.name(s)).collect();
        Some(Reason::new(
            ReasonCode::DependentStates,
            format!(
                "it says only that a combination of {} stays constant, and not how they move: two sensors of one motion, or a \
                 conserved sum",
                names.join(" and ")
            ),
        ))
    });
}

/// Doubts every equation that contains a state of a linear relation, or is one. A term can be exchanged only where the library offers
/// all states of the relation; `offered` are the signals in the library of each target.
pub(crate) fn doubt_dependent_states(
    d: &mut Discovery,
    states: &[MeasuredState],
    offered: &[(Signal, Vec<Signal>)],
) {
    doubt_total_derivatives(d);
    let Some(relation) = relation(d, states) else {
        return;
    };
    let text = format!(
        "{} all along, within the noise: through it terms can be exchanged for others, and these are only the simplest",
        relation.text
    );
    let remedy =
        "leave one of these states out of the libraries, or record data in which it does not stay";
    for e in &mut d.equations {
        let mut within = false;
        for t in &e.terms {
            t.term
                .for_each_signal(&mut |s| within |= relation.signals.contains(&s));
        }
        let all_offered = offered.iter().any(|(target, signals)| {
            *target == e.target && relation.signals.iter().all(|s| signals.contains(s))
        });
        if within && all_offered && e.status != Status::Known {
            e.doubt(Reason::new(ReasonCode::DependentStates, &text).remedy(remedy));
        }
    }
}

fn relation(names: &Discovery, states: &[MeasuredState]) -> Option<LinearRelation> {
    let rows: Vec<usize> = (0..states.first()?.values.len())
        .filter(|k| {
            states
                .iter()
                .all(|s| s.values.get(*k).is_some_and(|x| x.is_finite()))
        })
        .collect();
    let n = states.len();
    if n < 2 || rows.len() < 4 * n {
        return None;
    }
    let count = rows.len() as f64;
    let at = |i: usize, k: usize| states[i].values[k];
    let mean: Vec<f64> = (0..n)
        .map(|i| rows.iter().map(|k| at(i, *k)).sum::<f64>() / count)
        .collect();
    let product = |i: usize, j: usize| {
        let both = rows
            .iter()
            .map(|k| (at(i, *k) - mean[i]) * (at(j, *k) - mean[j]));
        both.sum::<f64>() / count
    };
    let spread: Vec<f64> = (0..n).map(|i| product(i, i).sqrt()).collect();
    let noise: Vec<f64> = (0..n)
        .map(|i| {
            states[i]
                .noise
                .max(DEPENDENT_STATES.clean_noise * spread[i])
        })
        .collect();
    if noise.contains(&0.0) {
        return None;
    }
    let scaled = DMatrix::from_fn(n, n, |i, j| product(i, j) / (noise[i] * noise[j]));
    let eigen = scaled.symmetric_eigen();
    let least = eigen.eigenvalues.imin();
    if eigen.eigenvalues[least] > DEPENDENT_STATES.constant {
        return None;
    }
    let weights: Vec<f64> = (0..n)
        .map(|i| eigen.eigenvectors[(i, least)] / noise[i])
        .collect();
    let part = |i: usize| (weights[i] * spread[i]).abs();
    let most = (0..n).map(part).fold(0.0, f64::max);
    // The largest weight becomes 1, so that conserved sums are printed as sums.
    let unit = (0..n)
        .filter(|i| part(*i) > DEPENDENT_STATES.named * most)
        .map(|i| weights[i])
        .max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    // Weights are rounded as far as the combination stays constant.
    let rounded = |scale: f64| -> Vec<f64> {
        let round = |i: usize| (scale * weights[i] / unit).round() / scale;
        let named = |i: usize| {
            if part(i) > DEPENDENT_STATES.named * most {
                round(i)
            } else {
                0.0
            }
        };
        (0..n).map(named).collect()
    };
    let constant = |w: &Vec<f64>| {
        let pairs = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
        let varies: f64 = pairs.map(|(i, j)| w[i] * w[j] * product(i, j)).sum();
        let noise: f64 = (0..n).map(|i| (w[i] * noise[i]).powi(2)).sum();
        varies <= DEPENDENT_STATES.constant * noise
    };
    let weights = [1.0, 10.0, 100.0, 1000.0]
        .map(rounded)
        .into_iter()
        .find(constant)
        .unwrap_or_else(|| rounded(1e3));
    let named: Vec<usize> = (0..n).filter(|i| weights[*i] != 0.0).collect();
    let combined = |k: &usize| -> f64 { (0..n).map(|i| weights[i] * (at(i, *k) - mean[i])).sum() };
    let moves = || moves_slowly(&rows.iter().map(combined).collect::<Vec<f64>>());
    let known = states.iter().any(|s| s.noise > 0.0);
    (named.len() > 1 && !(known && moves())).then(|| LinearRelation {
        signals: named.iter().map(|i| states[*i].signal).collect(),
        text: written(names, states, &named, &weights, &mean),
    })
}

/// Whether successive values follow each other: the noise of sensors is white, and a motion below it is not.
fn moves_slowly(values: &[f64]) -> bool {
    let square: f64 = values.iter().map(|v| v * v).sum();
    let correlations = std::array::from_fn(|lag| {
        let later = values.iter().skip(lag + 1);
        let product: f64 = values.iter().zip(later).map(|(a, b)| a * b).sum();
        product / square.max(f64::MIN_POSITIVE)
    });
    rms_autocorrelation(&correlations) > white_noise_bound(values.len() as f64)
}

/// `x0 + 0.98*x1 stays near 1.2`
fn written(
    names: &Discovery,
    states: &[MeasuredState],
    named: &[usize],
    weights: &[f64],
    mean: &[f64],
) -> String {
    let mut sum = String::new();
    for i in named {
        let w = weights[*i];
        let sign = match (sum.is_empty(), w < 0.0) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        let factor = match w.abs() {
            1.0 => String::new(),
            size => format!("{size}*"),
        };
        sum.push_str(&format!("{sign}{factor}{}", names.name(states[*i].signal)));
    }
    let level: f64 = named.iter().map(|i| weights[*i] * mean[*i]).sum();
    format!("{sum} stays near {level:.3}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use sidc_lang::term::VarId;

    fn state(i: u16, values: Vec<f64>) -> MeasuredState {
        MeasuredState {
            signal: Signal::new(VarId(i)),
            values,
            noise: 0.0,
        }
    }

    #[test]
    fn a_sum_that_stays_is_found_and_one_that_moves_is_not() {
        let wave = |w: f64| (0..100).map(move |k| (w * f64::from(k)).sin());
        let (x, y): (Vec<f64>, Vec<f64>) = (wave(0.1).collect(), wave(0.17).collect());
        let rest: Vec<f64> = x.iter().zip(&y).map(|(x, y)| 1.0 - x - y).collect();
        let bent: Vec<f64> = rest.iter().map(|z| z + 1e-5 * z * z).collect();
        let names = Discovery::default();
        let three = |z: Vec<f64>| {
            let all = [state(0, x.clone()), state(1, y.clone()), state(2, z)];
            relation(&names, &all).map(|r| r.signals.len())
        };
        assert_eq!(three(rest), Some(3));
        assert_eq!(three(bent), None);
    }
}
