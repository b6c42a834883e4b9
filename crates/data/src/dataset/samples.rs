//! The rows that equations are found from: all signals at common instants, trajectories one after another.

use sidc_lang::sensor_noise::SensorNoise;
use sidc_lang::term::Signal;

/// A table of M rows; every column is finite.
#[derive(Clone, Debug, Default)]
pub struct Samples {
    /// Trajectory each row came from. Length M.
    pub trajectory: Vec<u32>,
    /// Instant of each row, seconds. Length M.
    pub time: Vec<f64>,
    /// Sorted by signal.
    pub columns: Vec<Column>,
}

/// One signal at all rows.
#[derive(Clone, Debug)]
pub struct Column {
    pub signal: Signal,
    /// Length M.
    pub values: Vec<f64>,
    pub origin: Origin,
}

/// Where the values of a column come from.
#[derive(Clone, Debug)]
pub enum Origin {
    /// `noise` is that of the sensor, if declared.
    Measured { noise: Option<SensorNoise> },
    /// Estimated from other signals; `error` is the standard error of each value (length M), `method` a few words.
    Estimated {
        error: Vec<f64>,
        method: String,
        /// Rows over which errors are alike, because their windows share samples.
        correlation: f64,
    },
}

impl Samples {
    pub fn len(&self) -> usize {
        self.time.len()
    }

    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    pub fn column(&self, s: Signal) -> Option<&Column> {
        self.columns
            .binary_search_by_key(&s, |c| c.signal)
            .ok()
            .map(|i| &self.columns[i])
    }

    /// Declares the noise of a measured signal: the standard deviation of its sensor, in units of the model. Estimated signals
    /// keep the errors of their estimates.
    ///
    /// ```
    /// use sidc::pipeline::Program;
    ///
    /// let program = Program::compile("fall.sid", "state v\ndv ~ <1, v>\n")?;
    /// let (v, dv) = ([0.0, 1.0, 2.0], [-9.8, -9.7, -9.6]);
    /// let mut samples = program.samples(&[0.0, 0.1, 0.2], &[("v", &v), ("dv", &dv)])?;
    /// samples.declare_noise(program.model.equations[0].target, 0.05);
    /// # Ok::<(), String>(())
    /// ```
    pub fn declare_noise(&mut self, signal: Signal, sigma: f64) {
        let named = self.columns.iter_mut().filter(|c| c.signal == signal);
        for column in named {
            if let Origin::Measured { noise } = &mut column.origin {
                *noise = Some(SensorNoise::constant(sigma));
            }
        }
    }

    /// The table with only the given rows, in the given order.
    pub fn select(&self, rows: &[usize]) -> Samples {
        let pick = |v: &[f64]| rows.iter().map(|&r| v[r]).collect::<Vec<_>>();
        Samples {
            trajectory: rows.iter().map(|&r| self.trajectory[r]).collect(),
            time: pick(&self.time),
            columns: self
                .columns
                .iter()
                .map(|c| Column {
                    signal: c.signal,
                    values: pick(&c.values),
                    origin: match &c.origin {
                        Origin::Measured { noise } => Origin::Measured { noise: *noise },
                        Origin::Estimated {
                            error,
                            method,
                            correlation,
                        } => Origin::Estimated {
                            error: pick(error),
                            method: method.clone(),
                            correlation: *correlation,
                        },
                    },
                })
                .collect(),
        }
    }
}
