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
        }
    }

    /// Whether no disturbance has a memory.
    pub fn is_white(&self) -> bool {
        self.stationary().next().is_none()
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

    /// The share of each state that lasts over an interval of length `h`, besides what the laws do to it: 1 but for disturbances.
    pub(crate) fn decay(&self, h: f64) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.laws.iter().filter_map(move |d| match d {
            Disturbance::White { .. } => None,
            Disturbance::FirstOrder { memory, state, .. } => Some((*state, (-h / memory).exp())),
        })
    }

    /// Deviations of the states that are disturbances, before anything is read.
    pub(crate) fn stationary(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.laws.iter().filter_map(|d| match d {
            Disturbance::White { .. } => None,
            Disturbance::FirstOrder {
                deviation, state, ..
            } => Some((*state, *deviation)),
        })
    }

    /// Adds to P, the covariance of the states (n × n by rows), what disturbances do over an interval of length `h` with transition T. White
    /// noise is integrated by Simpson's rule, the transition to the middle taken halfway: exact for two integrations.
    pub(crate) fn add_covariance(&self, transition: &[f64], h: f64, covariance: &mut [f64]) {
        for d in &self.laws {
            match *d {
                Disturbance::White { intensity, moves } => {
                    let n = covariance.len().isqrt();
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
                Disturbance::FirstOrder {
                    deviation,
                    memory,
                    state,
                } => {
                    let n = covariance.len().isqrt();
                    let fresh = -(-2.0 * h / memory).exp_m1();
                    covariance[state * n + state] += deviation.powi(2) * fresh;
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
        let noise = ProcessNoise { laws: vec![white] };
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
        };
        let (state, kept) = noise.decay(0.2).next().unwrap();
        assert_eq!(state, 1);
        let mut covariance = vec![0.0, 0.0, 0.0, (kept * 2.0).powi(2)];
        noise.add_covariance(&[1.0, 0.2, 0.0, 1.0], 0.2, &mut covariance);
        assert!((covariance[3] - 4.0).abs() < 1e-12);
    }
}
