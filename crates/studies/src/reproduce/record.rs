//! Records of motion: what ideal sensors of the cart-pendulum read, for each kind of force.

use sidc_testing::integrate::grid;
use sidc_testing::plants::cart_pendulum::{Plant, State};
use sidc_testing::plants::force::{Force, Kind};
use sidc_testing::plants::run::{columns, run};
use sidc_testing::random::Random;

/// Samples per second.
pub const RATE: f64 = 100.0;

/// Signals by name, at common times.
#[derive(Clone)]
pub struct Record {
    pub time: Vec<f64>,
    pub columns: Vec<(&'static str, Vec<f64>)>,
}

impl Record {
    pub fn len(&self) -> usize {
        self.time.len()
    }

    pub fn column(&self, name: &str) -> &[f64] {
        let found = self.columns.iter().find(|(n, _)| *n == name);
        found.map_or(&[], |(_, values)| values)
    }

    /// Only the rows given.
    pub fn pick(&self, rows: &[usize]) -> Record {
        let of = |values: &[f64]| rows.iter().map(|r| values[*r]).collect::<Vec<f64>>();
        Record {
            time: of(&self.time),
            columns: self.columns.iter().map(|(n, v)| (*n, of(v))).collect(),
        }
    }
}

/// How an experiment is run.
#[derive(Clone, Copy, Debug)]
pub struct Experiment {
    pub kind: Kind,
    /// Initial angle, rad; the motion starts at rest.
    pub angle: f64,
    pub rows: usize,
    /// Force of the first sample in place of the drawn one, N.
    pub first: Option<f64>,
    /// Factor of the drawn forces.
    pub scale: f64,
}

impl Experiment {
    pub fn new(kind: Kind, rows: usize) -> Experiment {
        Experiment {
            kind,
            angle: 0.0,
            rows,
            first: None,
            scale: 1.0,
        }
    }

    /// A record of the thesis' plant.
    pub fn record(&self, seed: u64) -> Record {
        let plant = Plant::default();
        let mut random = Random::new(seed);
        let mut force = Force::draw(self.kind, self.rows, RATE, &mut random);
        if let Some(first) = self.first {
            force.start_with(first);
        }
        let start: State = [0.0, 0.0, self.angle, 0.0];
        let times = grid(self.rows + 1, 1.0 / RATE);
        let held = |k: usize, x: &State| self.scale * force.at(k, &plant, x);
        let rows = run(&plant, start, &times, held);
        Record {
            time: rows.iter().map(|r| r.time).collect(),
            columns: columns(&rows),
        }
    }
}
