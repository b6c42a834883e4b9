//! A case of the study: a model, its true laws, motions as perfect sensors would read them, and the noise of the sensors.
//!
//! In: a level of noise and a seed. Out: tables as text. Knows nothing of the equations found in them.

use sidc_testing::random::Random;
use sidc_testing::table::Table;

/// A target and its terms, spelled as sidc prints them, each with its coefficient.
pub type Law = (&'static str, Vec<(&'static str, f64)>);

pub struct Case {
    pub name: &'static str,
    pub model: String,
    pub laws: Vec<Law>,
    pub motion: Motion,
    pub sensors: Vec<Sensor>,
}

/// The motion that perfect sensors would read.
pub enum Motion {
    /// The same in all draws.
    Fixed(Vec<Table>),
    /// A different one in each draw.
    Drawn(fn(&mut Random) -> Vec<Table>),
}

/// Noise of a column.
pub struct Sensor {
    pub column: &'static str,
    /// Standard deviation at level 1.
    pub size: f64,
    /// Correlation between the errors of consecutive samples: 0 for white noise.
    pub memory: f64,
}

impl Sensor {
    pub fn white(column: &'static str, size: f64) -> Sensor {
        Sensor {
            column,
            size,
            memory: 0.0,
        }
    }
}

impl Case {
    /// A seed for the generator that no other draw of any case has (FNV-1a).
    fn seed(&self, level: f64, seed: u64) -> u64 {
        let level = level.to_bits().to_le_bytes();
        let draw = seed.to_le_bytes();
        let all = self.name.bytes().chain(level).chain(draw);
        all.fold(0xCBF2_9CE4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3)
        })
    }

    /// The tables with noise of this level.
    pub fn noisy(&self, level: f64, seed: u64) -> Vec<String> {
        let mut random = Random::new(self.seed(level, seed));
        let drawn;
        let tables = match &self.motion {
            Motion::Fixed(tables) => tables,
            Motion::Drawn(motion) => {
                drawn = motion(&mut random);
                &drawn
            }
        };
        let add_noise = |clean: &Table| {
            let mut table = Table {
                comments: Vec::new(),
                rows: clean.rows.clone(),
                names: clean.names.clone(),
                ..*clean
            };
            for sensor in &self.sensors {
                let at = table.names.iter().position(|n| *n == sensor.column);
                let fresh = (1.0 - sensor.memory.powi(2)).sqrt();
                let mut error = random.normal();
                for row in &mut table.rows {
                    if let Some(x) = at.and_then(|at| row.get_mut(at)) {
                        *x += level * sensor.size * error;
                    }
                    error = sensor.memory * error + fresh * random.normal();
                }
            }
            table.csv()
        };
        tables.iter().map(add_noise).collect()
    }
}

/// Standard deviation of a column over all tables.
pub fn deviation(tables: &[Table], column: usize) -> f64 {
    let all = || {
        tables
            .iter()
            .flat_map(|t| t.rows.iter().filter_map(|r| r.get(column)))
    };
    let count = all().count().max(1) as f64;
    let mean = all().sum::<f64>() / count;
    (all().map(|x| (x - mean).powi(2)).sum::<f64>() / count).sqrt()
}
