//! What drives the cart: one force for each sample, held until the next.
//!
//! Open-loop forces are drawn before the run; the experiment's controllers look at the state.

use super::cart_pendulum::{Plant, State};
use super::controller;
use crate::random::{Random, decimals};
use clap::ValueEnum;
use std::f64::consts::TAU;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    /// Balance upright, multi-level square force, swing-up, free decay
    Experiment,
    /// Levels uniform in ±8 N, each held 0.1 to 0.6 s
    RandomSquare,
    /// Levels uniform in ±6 N, each held 0.05 to 0.5 s, reversed where the cart would leave its track
    Track,
    /// Gaussian, one draw a sample, scaled so that the largest is ±5 N
    Gaussian,
    /// A sine of ±4 N, 0.3 Hz to 1.5 Hz
    Sine,
    /// A sine of ±4 N whose frequency rises from 0.1 Hz to between 2 Hz and 4 Hz
    Chirp,
    /// Swing-up from the pendant position, then balance
    SwingUp,
    /// None: the pendulum swings freely
    Zero,
}

/// Ends of the phases of the experiment, as shares of the record: balancing, square force, swing-up; the rest decays freely.
const BALANCE: f64 = 0.15;
const SQUARE: f64 = 0.55;
const SWING_UP: f64 = 0.65;
/// A level of the square force is reversed if it pushes outward a cart that in 1 s would be further out than this, m.
const TRACK: f64 = 0.6;

/// Largest force of a sine, N.
const SINE: f64 = 4.0;
/// Frequency at which a chirp begins, Hz.
const FROM: f64 = 0.1;

/// A sine of random phase; `turns` is the number of its periods up to a time.
fn sine(rows: usize, rate: f64, random: &mut Random, turns: impl Fn(f64) -> f64) -> Vec<f64> {
    let phase = random.unit();
    let at = |k: usize| SINE * (TAU * (turns(k as f64 / rate) + phase)).sin();
    (0..rows).map(|k| decimals(at(k), 4)).collect()
}

/// Force of every sample of a run.
pub struct Force {
    kind: Kind,
    /// Drawn forces; those of the experiment are the levels of its square phase, before any reversal.
    drawn: Vec<f64>,
    /// Sign of the present level; it may change only with the level.
    sign: f64,
}

impl Force {
    pub fn draw(kind: Kind, rows: usize, rate: f64, random: &mut Random) -> Self {
        let samples = |seconds: f64| ((seconds * rate).round() as usize).max(1);
        let drawn = match kind {
            Kind::Zero | Kind::SwingUp => vec![0.0; rows],
            Kind::Sine => {
                let frequency = random.uniform(0.3, 1.5);
                sine(rows, rate, random, |t| frequency * t)
            }
            Kind::Chirp => {
                let rise = (random.uniform(2.0, 4.0) - FROM) * rate / rows.max(1) as f64;
                sine(rows, rate, random, |t| (FROM + 0.5 * rise * t) * t)
            }
            Kind::RandomSquare => random.square(rows, (samples(0.1), samples(0.6)), 8.0),
            Kind::Experiment | Kind::Track => {
                random.square(rows, (samples(0.05), samples(0.5)), 6.0)
            }
            Kind::Gaussian => {
                let draws: Vec<f64> = (0..rows).map(|_| random.normal()).collect();
                let largest = draws.iter().fold(f64::MIN_POSITIVE, |m, z| m.max(z.abs()));
                draws
                    .iter()
                    .map(|z| decimals(5.0 * z / largest, 4))
                    .collect()
            }
        };
        Force {
            kind,
            drawn,
            sign: 1.0,
        }
    }

    /// Replaces the force of the first sample.
    pub fn start_with(&mut self, first: f64) {
        if let Some(f) = self.drawn.first_mut() {
            *f = first;
        }
    }

    /// Force of sample `k` in state `x`.
    pub fn at(&mut self, k: usize, plant: &Plant, x: &State) -> f64 {
        let drawn = self.drawn.get(k).copied().unwrap_or(0.0);
        match self.kind {
            Kind::Experiment => {}
            Kind::Track => return self.on_track(k, drawn, x),
            Kind::SwingUp => return controller::swing_up(plant, x),
            _ => return drawn,
        }
        let share = k as f64 / self.drawn.len() as f64;
        if share < BALANCE {
            controller::stabilise(plant, x)
        } else if share < SQUARE {
            self.on_track(k, drawn, x)
        } else if share < SWING_UP {
            controller::swing_up(plant, x)
        } else {
            0.0
        }
    }

    /// The level of sample `k`, reversed if it is new and would drive the cart off its track.
    fn on_track(&mut self, k: usize, drawn: f64, x: &State) -> f64 {
        if k == 0 || self.drawn.get(k - 1) != Some(&drawn) {
            let ahead = x[0] + x[1];
            let outward = ahead.abs() > TRACK && drawn * ahead > 0.0;
            self.sign = if outward { -1.0 } else { 1.0 };
        }
        self.sign * drawn
    }
}
