//! States that are not independent of each other along the data: S + E + I + R = 1.
//!
//! In: what was measured of the states, with its noise. Out: a doubt with the relation. Through it terms can be exchanged for others
//! without a trace in the data, so that the sparsest equations are one choice among many. A relation counts where the sum of the
//! states, as measured, varies no more than the noise of its parts (the smallest eigenvalue of their covariance in units of noise).

use nalgebra::DMatrix;

use super::{Discovery, Reason, Status};
use crate::term::{Signal, SignalNames};

/// Variance, over that of the noise, below which a combination is constant: noise is known to some 5 %.
const CONSTANT: f64 = 1.15;
/// Noise of data that have none, over their spread.
const CLEAN: f64 = 1e-7;
/// Part of the largest one's that a state has to contribute to be named.
const NAMED: f64 = 0.02;

/// Readings of one state; NaN where there is none.
pub(super) struct Measured {
    pub signal: Signal,
    pub values: Vec<f64>,
    /// Standard deviation; 0 if nothing is known of it.
    pub noise: f64,
}

/// A relation between states.
struct Relation {
    signals: Vec<Signal>,
    text: String,
}

/// Turns equations between states that depend on each other into doubts.
pub(super) fn judge(d: &mut Discovery, states: &[Measured]) {
    let Some(relation) = relation(d, states) else {
        return;
    };
    let text = format!(
        "{} all along, within the noise: through it terms can be exchanged for others, and these are only the simplest; leave \
         one of these states out of the libraries, or record data in which the relation does not hold",
        relation.text
    );
    for e in &mut d.equations {
        let mut within = false;
        for t in &e.terms {
            t.term
                .for_each_signal(&mut |s| within |= relation.signals.contains(&s));
        }
        if within && e.status != Status::Known {
            e.status = Status::Doubt;
            e.reasons.push(Reason::new("dependent-states", &text));
        }
    }
}

fn relation(names: &Discovery, states: &[Measured]) -> Option<Relation> {
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
        .map(|i| states[i].noise.max(CLEAN * spread[i]))
        .collect();
    if noise.contains(&0.0) {
        return None;
    }
    let scaled = DMatrix::from_fn(n, n, |i, j| product(i, j) / (noise[i] * noise[j]));
    let eigen = scaled.symmetric_eigen();
    let least = eigen.eigenvalues.imin();
    if eigen.eigenvalues[least] > CONSTANT {
        return None;
    }
    let weights: Vec<f64> = (0..n)
        .map(|i| eigen.eigenvectors[(i, least)] / noise[i])
        .collect();
    let part = |i: usize| (weights[i] * spread[i]).abs();
    let most = (0..n).map(part).fold(0.0, f64::max);
    // The largest weight is 1, so that sums look like sums.
    let unit = (0..n)
        .filter(|i| part(*i) > NAMED * most)
        .map(|i| weights[i])
        .max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    // As round as the noise allows.
    let rounded = |scale: f64| -> Vec<f64> {
        let round = |i: usize| (scale * weights[i] / unit).round() / scale;
        let named = |i: usize| {
            if part(i) > NAMED * most {
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
        varies <= CONSTANT * noise
    };
    let weights = [1.0, 10.0, 100.0, 1000.0]
        .map(rounded)
        .into_iter()
        .find(constant)
        .unwrap_or_else(|| rounded(1e3));
    let named: Vec<usize> = (0..n).filter(|i| weights[*i] != 0.0).collect();
    (named.len() > 1).then(|| Relation {
        signals: named.iter().map(|i| states[*i].signal).collect(),
        text: written(names, states, &named, &weights, &mean),
    })
}

/// `x0 + 0.98*x1 stays near 1.2`
fn written(
    names: &Discovery,
    states: &[Measured],
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
    use crate::term::VarId;

    fn measured(i: u16, values: Vec<f64>) -> Measured {
        Measured {
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
            let all = [
                measured(0, x.clone()),
                measured(1, y.clone()),
                measured(2, z),
            ];
            relation(&names, &all).map(|r| r.signals.len())
        };
        assert_eq!(three(rest), Some(3));
        assert_eq!(three(bent), None);
    }
}
