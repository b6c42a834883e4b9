//! Laws with their derivatives by states and parameters, and steps of a run with its sensitivities.
//!
//! In: a system, laws, the signals that are parameters. Out: z and ∂z/∂(parameters, start) a step later. Fits nothing.

use crate::trajectory::model::System;
use sidc_lang::term::{Expr, Signal, Tape};

/// A state with its sensitivities.
#[derive(Clone, Debug)]
pub(crate) struct SensitiveState {
    /// Length n.
    pub z: Vec<f64>,
    /// n × (parameters + starts), row after row.
    pub s: Vec<f64>,
}

/// The laws, compiled.
pub(crate) struct SensitiveLaws<'a> {
    system: &'a System,
    tape: Tape,
    /// Law and state of each derivative, in the order of the tape's outputs.
    by_state: Vec<(usize, usize)>,
    /// The same of parameters.
    by_parameter: Vec<(usize, usize)>,
    /// Places of the exogenous signals that are no parameters.
    exogenous: Vec<usize>,
    pub parameters: usize,
}

impl<'a> SensitiveLaws<'a> {
    /// One expression for each law of the system. `None` where they contain rates.
    pub fn new(
        system: &'a System,
        laws: &[Expr],
        parameters: &[Signal],
    ) -> Option<SensitiveLaws<'a>> {
        let derivatives = |by: &[Signal]| {
            let mut places = Vec::new();
            let mut values = Vec::new();
            for (l, law) in laws.iter().enumerate() {
                for (k, signal) in by.iter().enumerate() {
                    let slope = law.derivative(*signal);
                    if slope.as_number() != Some(0.0) {
                        places.push((l, k));
                        values.push(slope);
                    }
                }
            }
            (places, values)
        };
        let (by_state, state_slopes) = derivatives(&system.states);
        let (by_parameter, slopes) = derivatives(parameters);
        let outputs = [laws, &state_slopes, &slopes].concat();
        let all = system.exogenous.iter().enumerate();
        let exogenous = all.filter(|(_, s)| !parameters.contains(s));
        let exogenous: Vec<usize> = exogenous.map(|(place, _)| place).collect();
        let given = exogenous.iter().map(|place| system.exogenous[*place]);
        let inputs = system.states.iter().copied().chain(given);
        let inputs: Vec<Signal> = inputs.chain(parameters.iter().copied()).collect();
        Some(SensitiveLaws {
            tape: Tape::new(&outputs, &inputs).ok()?,
            system,
            by_state,
            by_parameter,
            exogenous,
            parameters: parameters.len(),
        })
    }

    /// States at their starts, whose own sensitivities are `scale`.
    pub fn start(&self, z: &[f64], scale: &dyn Fn(usize) -> f64) -> SensitiveState {
        let (n, width) = (z.len(), self.width());
        let mut s = vec![0.0; n * width];
        for i in 0..n {
            s[i * width + self.parameters + i] = scale(i);
        }
        SensitiveState { z: z.to_vec(), s }
    }

    /// Parameters and starts.
    pub fn width(&self) -> usize {
        self.parameters + self.system.states.len()
    }

    /// Values of the laws and of their derivatives, as the tape has them. `exogenous`: all signals of the system.
    pub fn outputs(
        &self,
        z: &[f64],
        exogenous: &dyn Fn(usize) -> f64,
        parameters: &[f64],
    ) -> Vec<f64> {
        let mut inputs = z.to_vec();
        inputs.extend(self.exogenous.iter().map(|place| exogenous(*place)));
        inputs.extend(parameters);
        let mut out = vec![0.0; self.tape.outputs()];
        self.tape.eval(&inputs, 1, &mut out, &mut Vec::new());
        out
    }

    /// Law and parameter of each slope among these outputs.
    pub fn parameter_slopes<'b>(
        &'b self,
        outputs: &'b [f64],
    ) -> impl Iterator<Item = ((usize, usize), f64)> + 'b {
        let from = self.system.laws.len() + self.by_state.len();
        let slopes = self.by_parameter.iter().copied();
        slopes.zip(outputs[from..].iter().copied())
    }

    /// A bound of the fastest rate at which states change by themselves, 1/s.
    pub fn fastest(&self, outputs: &[f64]) -> f64 {
        let laws = self.system.laws.len();
        let mut rows = vec![0.0; laws];
        for ((law, state), slope) in self.by_state.iter().zip(&outputs[laws..]) {
            // The state of a law of order d changes as the d-th root of its own slope says.
            let order = self.system.laws[*law].state - state.min(&self.system.laws[*law].state) + 1;
            let rate = slope.abs().powf(1.0 / order as f64);
            rows[*law] = f64::max(rows[*law], rate);
        }
        rows.into_iter().fold(0.0, f64::max)
    }

    /// A step by the classical method of Runge and Kutta; the sensitivities are exactly those of the discrete run. `exogenous` gives the value of a signal at
    /// a part of the step. `None` where it leaves what can be computed.
    pub fn step(
        &self,
        from: &SensitiveState,
        h: f64,
        exogenous: &dyn Fn(usize, f64) -> f64,
        parameters: &[f64],
    ) -> Option<SensitiveState> {
        let mut end = from.clone();
        let mut rate = SensitiveState {
            z: vec![0.0; from.z.len()],
            s: vec![0.0; from.s.len()],
        };
        for (part, weight) in [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
            let mut at = from.clone();
            at.add(part * h, &rate);
            rate = self.rates(&at, &|place| exogenous(place, part), parameters);
            end.add(weight * h / 6.0, &rate);
        }
        let finite = end.z.iter().chain(&end.s).all(|x| x.is_finite());
        finite.then_some(end)
    }

    fn rates(
        &self,
        at: &SensitiveState,
        exogenous: &dyn Fn(usize) -> f64,
        parameters: &[f64],
    ) -> SensitiveState {
        let (n, width, laws) = (at.z.len(), self.width(), self.system.laws.len());
        let out = self.outputs(&at.z, exogenous, parameters);
        let mut rate = SensitiveState {
            z: vec![0.0; n],
            s: vec![0.0; n * width],
        };
        for i in 0..n {
            if let Some(next) = self.system.derivative_state(i) {
                rate.z[i] = at.z[next];
                let row = &at.s[next * width..(next + 1) * width];
                rate.s[i * width..(i + 1) * width].copy_from_slice(row);
            }
        }
        for (law, value) in self.system.laws.iter().zip(&out) {
            rate.z[law.state] = *value;
        }
        let (by_state, by_parameter) = out[laws..].split_at(self.by_state.len());
        for ((law, k), slope) in self.by_state.iter().zip(by_state) {
            let i = self.system.laws[*law].state;
            let row = &at.s[k * width..(k + 1) * width];
            let own = &mut rate.s[i * width..(i + 1) * width];
            own.iter_mut().zip(row).for_each(|(x, y)| *x += slope * y);
        }
        for ((law, k), slope) in self.by_parameter.iter().zip(by_parameter) {
            rate.s[self.system.laws[*law].state * width + k] += slope;
        }
        rate
    }
}

impl SensitiveState {
    fn add(&mut self, by: f64, rate: &SensitiveState) {
        self.z
            .iter_mut()
            .zip(&rate.z)
            .for_each(|(x, r)| *x += by * r);
        self.s
            .iter_mut()
            .zip(&rate.s)
            .for_each(|(x, r)| *x += by * r);
    }
}
