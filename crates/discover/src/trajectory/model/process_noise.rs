//! Process noise: what moves the states besides the laws.
//!
//! In: a system, the disturbance of each law, an interval. Out: the covariance of what disturbances add to the states over it. Estimates
//! nothing.

use super::system::System;

/// The disturbances of all laws: target = law + disturbance.
#[derive(Clone, Debug, PartialEq)]
pub struct ProcessNoise {
    /// One of each law.
    pub laws: Vec<Disturbance>,
    /// Inputs that are read with noise.
    pub(crate) inputs: Vec<NoisyInput>,
}

/// An input that is held from sample to sample and read with noise: a state that no law moves. It varies about its mean as a first-order
/// autoregression. Noisy readings taken as exact would make its coefficients too small (regression calibration; Carroll et al. 2006, chapter 4).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NoisyInput {
    pub state: usize,
    pub mean: f64,
    pub deviation: f64,
    /// Seconds.
    pub memory: f64,
}

/// The disturbance of one law, by how it remembers its past.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Disturbance {
    /// White noise of this intensity, target · √s, and the state whose rate the law is.
    White { intensity: f64, moves: usize },
    /// First-order: deviation in units of the target, memory in seconds, and the state that it is. Held between samples.
    FirstOrder {
        deviation: f64,
        memory: f64,
        state: usize,
    },
}

impl ProcessNoise {
    /// White disturbances of all laws.
    pub(crate) fn white(system: &System, intensity: impl Fn(usize) -> f64) -> ProcessNoise {
        let laws = system.laws.iter().enumerate();
        let white = laws.map(|(l, law)| Disturbance::White {
            intensity: intensity(l),
            moves: law.state,
        });
        ProcessNoise {
            laws: white.collect(),
            inputs: Vec::new(),
        }
    }

    /// Whether no disturbance has a memory.
    pub fn is_white(&self) -> bool {
        let white = |d: &Disturbance| matches!(d, Disturbance::White { .. });
        self.laws.iter().all(white)
    }

    /// The numbers that describe the disturbances: an intensity each, or a deviation and a memory.
    pub(crate) fn values(&self) -> Vec<f64> {
        let of = |d: &Disturbance| match d {
            Disturbance::White { intensity, .. } => vec![*intensity],
            Disturbance::FirstOrder {
                deviation, memory, ..
            } => vec![*deviation, *memory],
        };
        self.laws.iter().flat_map(of).collect()
    }

    /// Sets these numbers, in the same order.
    pub(crate) fn set_values(&mut self, values: &mut impl Iterator<Item = f64>) {
        for d in &mut self.laws {
            let own = match d {
                Disturbance::White { intensity, .. } => vec![intensity],
                Disturbance::FirstOrder {
                    deviation, memory, ..
                } => vec![deviation, memory],
            };
            own.into_iter().zip(&mut *values).for_each(|(x, v)| *x = v);
        }
    }

    /// The states that no law moves.
    fn autoregressions(&self) -> impl Iterator<Item = NoisyInput> + '_ {
        let laws = self.laws.iter().filter_map(|d| match *d {
            Disturbance::White { .. } => None,
            Disturbance::FirstOrder {
                deviation,
                memory,
                state,
            } => Some(NoisyInput {
                state,
                mean: 0.0,
                deviation,
                memory,
            }),
        });
        laws.chain(self.inputs.iter().copied())
    }

    /// The states that no law moves, with the share of their distance from their mean that lasts over an interval of length `h`, and the mean.
    pub(crate) fn decay(&self, h: f64) -> impl Iterator<Item = (usize, f64, f64)> + '_ {
        let all = self.autoregressions();
        all.map(move |a| (a.state, (-h / a.memory).exp(), a.mean))
    }

    /// The same states with mean and deviation before anything is read.
    pub(crate) fn stationary(&self) -> impl Iterator<Item = (usize, f64, f64)> + '_ {
        self.autoregressions()
            .map(|a| (a.state, a.mean, a.deviation))
    }

    /// Adds to P, the covariance of the states (n × n by rows), what disturbances do over an interval of length `h` with transition T. White
    /// noise is integrated by Simpson's rule, the transition to the middle taken halfway: exact for two integrations.
    pub(crate) fn add_covariance(&self, transition: &[f64], h: f64, covariance: &mut [f64]) {
        let n = covariance.len().isqrt();
        for a in self.autoregressions() {
            let fresh = -(-2.0 * h / a.memory).exp_m1();
            covariance[a.state * n + a.state] += a.deviation.powi(2) * fresh;
        }
        for d in &self.laws {
            match *d {
                Disturbance::FirstOrder { .. } => {}
                Disturbance::White { intensity, moves } => {
                    let weight = h / 6.0 * intensity.powi(2);
                    let start = |i: usize| transition[i * n + moves];
                    let end = |i: usize| if i == moves { 1.0 } else { 0.0 };
                    let middle = |i: usize| 0.5 * (start(i) + end(i));
                    for i in 0..n {
                        for j in 0..n {
                            covariance[i * n + j] += weight
                                * (start(i) * start(j)
                                    + 4.0 * middle(i) * middle(j)
                                    + end(i) * end(j));
                        }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mass_pushed_by_white_noise_spreads_as_known() {
        let white = Disturbance::White {
            intensity: 0.7,
            moves: 1,
        };
        let noise = ProcessNoise {
            laws: vec![white],
            inputs: Vec::new(),
        };
        let h = 0.3_f64;
        let mut q = vec![0.0; 4];
        noise.add_covariance(&[1.0, h, 0.0, 1.0], h, &mut q);
        let known = [h.powi(3) / 3.0, h * h / 2.0, h * h / 2.0, h].map(|x| 0.49 * x);
        for (a, b) in q.iter().zip(known) {
            assert!((a - b).abs() < 1e-12);
        }
    }

    #[test]
    fn a_disturbance_with_memory_stays_as_large_as_it_is() {
        let noise = ProcessNoise {
            laws: vec![Disturbance::FirstOrder {
                deviation: 2.0,
                memory: 0.5,
                state: 1,
            }],
            inputs: Vec::new(),
        };
        let (state, kept, mean) = noise.decay(0.2).next().unwrap();
        assert_eq!((state, mean), (1, 0.0));
        let mut covariance = vec![0.0, 0.0, 0.0, (kept * 2.0).powi(2)];
        noise.add_covariance(&[1.0, 0.2, 0.0, 1.0], 0.2, &mut covariance);
        assert!((covariance[3] - 4.0).abs() < 1e-12);
    }
}
