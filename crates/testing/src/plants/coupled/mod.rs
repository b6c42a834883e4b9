//! Random coupled mechanical systems: each law contains the accelerations of the others.
//!
//! In: a family, how far it swings, a seed. Out: names of signals, rows of a driven motion, and the law of every coordinate in the terms
//! that the program prints. `polynomial` is the algebra, `lagrange` derives laws from energies, `families` draws the mechanisms. Uses
//! nothing of the compiler.

mod families;
mod lagrange;
mod polynomial;
#[cfg(test)]
mod tests;

pub use families::{FAMILIES, Family};
pub use polynomial::{Factor, Monomial, Point};

use crate::integrate::{grid, integrate};
use crate::random::Random;
use lagrange::Laws;
use polynomial::{COORDINATES, INPUTS};

/// Samples that an input is held for: fewest, most.
const HOLD: (usize, usize) = (2, 12);
/// Forces tried, each larger or smaller than the one before by [`RATIO`].
const TRIES: usize = 40;
const RATIO: f64 = 1.4;
const NAMES: [&str; INPUTS] = ["F", "G"];

/// How far the angles go in a record, rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Swing {
    /// Every angle exceeds 2.5
    Large,
    /// No angle reaches 0.6
    Small,
}

/// A system with its laws.
#[derive(Clone, Debug)]
pub struct Coupled {
    pub family: Family,
    laws: Laws,
    inputs: usize,
    seed: u64,
}

/// q̈_i = Σ coefficient · term.
#[derive(Clone, Debug)]
pub struct Law {
    pub coordinate: usize,
    pub terms: Vec<(Monomial, f64)>,
}

type State = [f64; 2 * COORDINATES];

impl Coupled {
    pub fn draw(family: Family, seed: u64) -> Coupled {
        let mut random = Random::new(70_000 + 1000 * family as u64 + seed);
        let mechanism = family.mechanism(&mut random);
        Coupled {
            family,
            inputs: mechanism.inputs.len(),
            laws: mechanism.laws(family.coordinates().len()),
            seed,
        }
    }

    pub fn coordinates(&self) -> usize {
        self.family.coordinates().len()
    }

    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// Whether a coordinate is an angle, not a position on a track.
    pub fn is_angle(&self, coordinate: usize) -> bool {
        let name = self.family.coordinates().get(coordinate);
        name.is_some_and(|n| n.starts_with("th"))
    }

    /// A factor as the language writes it.
    pub fn name(&self, factor: Factor) -> String {
        let name = |i: usize| self.family.coordinates().get(i).copied().unwrap_or("");
        match factor {
            Factor::Acceleration(i) => format!("dd{}", name(i)),
            Factor::Speed(i) => format!("d{}", name(i)),
            Factor::Position(i) => name(i).to_string(),
            Factor::Sin(i) => format!("sin({})", name(i)),
            Factor::Cos(i) => format!("cos({})", name(i)),
            Factor::Input(i) => NAMES[i].to_string(),
        }
    }

    /// A term as the language writes it, `dth1^2*sin(th1)`.
    pub fn term(&self, monomial: &[Factor]) -> String {
        let powers = monomial.chunk_by(|a, b| a == b).map(|run| match run.len() {
            1 => self.name(run[0]),
            n => format!("{}^{n}", self.name(run[0])),
        });
        match monomial {
            [] => "1".to_string(),
            _ => powers.collect::<Vec<_>>().join("*"),
        }
    }

    /// One law for each coordinate.
    pub fn laws(&self) -> Vec<Law> {
        let law = |coordinate| Law {
            coordinate,
            terms: self.laws.explicit(coordinate),
        };
        (0..self.coordinates()).map(law).collect()
    }

    /// The declarations of a model.
    pub fn declared(&self) -> String {
        format!(
            "state {} : order 2\ninput {} : hold\n",
            self.family.coordinates().join(", "),
            NAMES[..self.inputs].join(", ")
        )
    }

    /// `rows` samples `step` seconds apart under random forces, scaled until the swing is as large or as small as asked.
    pub fn record(&self, swing: Swing, rows: usize, step: f64) -> Vec<(f64, Point)> {
        let mut amplitude = match swing {
            Swing::Large => 2.0,
            Swing::Small => 0.5,
        };
        let mut record = self.run(amplitude, rows, step);
        for _ in 0..TRIES {
            let angles = (0..self.coordinates()).filter(|i| self.is_angle(*i));
            let reaches = angles.map(|i| reach(&record, i));
            let done = match swing {
                Swing::Large => reaches.fold(f64::INFINITY, f64::min) > 2.5,
                Swing::Small => reaches.fold(0.0, f64::max) < 0.6,
            };
            if done {
                break;
            }
            amplitude *= match swing {
                Swing::Large => RATIO,
                Swing::Small => 1.0 / RATIO,
            };
            record = self.run(amplitude, rows, step);
        }
        record
    }

    /// From rest, under levels of force within ±`amplitude`.
    fn run(&self, amplitude: f64, rows: usize, step: f64) -> Vec<(f64, Point)> {
        let mut random = Random::new(90_000 + self.seed);
        let forces: Vec<Vec<f64>> = (0..self.inputs)
            .map(|_| random.square(rows, HOLD, 1.0))
            .collect();
        let times = grid(rows, step);
        let mut state: State = [0.0; 2 * COORDINATES];
        let mut record = Vec::with_capacity(rows);
        for (k, time) in times.iter().enumerate() {
            let mut inputs = [0.0; INPUTS];
            inputs
                .iter_mut()
                .zip(&forces)
                .for_each(|(u, force)| *u = amplitude * force[k]);
            record.push((*time, self.point(&state, inputs)));
            let rate = |_: f64, s: &State| {
                let at = self.point(s, inputs);
                [at.speeds, at.accelerations]
                    .concat()
                    .try_into()
                    .unwrap_or(*s)
            };
            state = integrate(&rate, 0.0, step, state);
        }
        record
    }

    /// All signals of a state under an input.
    fn point(&self, state: &State, inputs: [f64; INPUTS]) -> Point {
        let mut at = Point {
            inputs,
            ..Point::default()
        };
        let (positions, speeds) = state.split_at(COORDINATES);
        at.positions.copy_from_slice(positions);
        at.speeds.copy_from_slice(speeds);
        at.accelerations = self.laws.accelerations(&at);
        at
    }
}

/// The largest magnitude of a position.
fn reach(record: &[(f64, Point)], coordinate: usize) -> f64 {
    let places = record.iter().map(|(_, p)| p.positions[coordinate].abs());
    places.fold(0.0, f64::max)
}
