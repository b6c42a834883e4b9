//! How to search for equations.

use sidc_data::{HoldOut, HoldOutRange, Window};
use sidc_discover::{METHODS, Method};
use sidc_lang::sensor_noise::SensorNoise;
use sidc_solve::solver;
use sidc_system::predict::{ErrorLimit, PredictionRequest};

use crate::error::{Error, ErrorKind};
use crate::pipeline::BUDGET;

/// How to search for equations; the default suits most data. Each setter returns the options with one change.
///
/// ```
/// use sidc::{Method, Options, HoldOutRange};
///
/// let options = Options::default()
///     .noise("theta", 0.01)
///     .hold_out(HoldOutRange::Last(0.25))
///     .method(Method::Regression)
///     .solver("clarabel")?;
/// assert!(Options::default().solver("magic").is_err());
/// # Ok::<(), sidc::Error>(())
/// ```
#[derive(Clone, Default)]
pub struct Options {
    pub(crate) noise: Vec<(String, SensorNoise)>,
    pub(crate) window: Window,
    pub(crate) held_out: HoldOut,
    pub(crate) search: sidc_discover::Options,
    pub(crate) verify: bool,
    pub(crate) prediction: PredictionRequest,
}

impl Options {
    /// Standard deviation of a signal's measurement, in the model's unit. It overrides what the model declares.
    pub fn noise(mut self, signal: &str, deviation: f64) -> Options {
        self.noise
            .push((signal.into(), SensorNoise::constant(deviation)));
        self
    }

    /// Like [`Options::noise`], for noise that grows with the signal: its standard deviation is √(floor² + (share · value)²), with `floor` in
    /// the signal's unit.
    pub fn growing_noise(mut self, signal: &str, floor: f64, share: f64) -> Options {
        self.noise
            .push((signal.into(), SensorNoise { floor, share }));
        self
    }

    /// Holds out this part of every record: equations are not found from it, but run on it. May be called several times.
    pub fn hold_out(mut self, stretch: HoldOutRange) -> Options {
        self.held_out.stretches.push(stretch);
        self
    }

    /// Holds out the record at this place, counted from 0. Identifying data without it is [`ErrorKind::Options`].
    pub fn hold_out_run(mut self, place: usize) -> Options {
        self.held_out.files.push(place);
        self
    }

    /// Uses only rows with from ≤ t ≤ to, in the unit of time; `None` means no bound.
    pub fn window(mut self, from: Option<f64>, to: Option<f64>) -> Options {
        self.window = (from, to);
        self
    }

    /// How far ahead predictions are compared with the data, in the unit of time; in discrete time in samples. By default the data decide.
    pub fn horizon(mut self, ahead: f64) -> Options {
        self.prediction.horizon = Some(ahead);
        self
    }

    /// The error, as a fraction of each signal's spread, within which 90 % of the predictions on unused data must stay: see
    /// [`Prediction::good`](crate::Prediction). If nothing is held out, the last quarter of every record is.
    pub fn good(mut self, part: f64) -> Options {
        self.prediction.good.push(ErrorLimit::Share(part));
        self
    }

    /// Like [`Options::good`], for one signal in its unit.
    pub fn good_signal(mut self, signal: &str, error: f64) -> Options {
        let limit = ErrorLimit::Signal(signal.into(), error);
        self.prediction.good.push(limit);
        self
    }

    /// What is held out: as requested, or the last quarter of every record if only limits of prediction errors were set.
    pub(crate) fn holds_out(&self) -> HoldOut {
        let mut held_out = self.held_out.clone();
        if held_out.is_empty() && !self.prediction.good.is_empty() {
            held_out.stretches.push(HoldOutRange::Last(BUDGET.held_out));
        }
        held_out
    }

    /// How equations are found; [`Method::Auto`] leaves that to the program.
    pub fn method(mut self, method: Method) -> Options {
        self.search.method = method;
        self
    }

    /// Like [`Options::method`], with a name that `sidc identify --method` takes.
    ///
    /// # Errors
    /// [`ErrorKind::Options`]: no method of this name.
    pub fn method_named(self, name: &str) -> Result<Options, Error> {
        let found = METHODS.iter().find(|(known, _)| *known == name);
        let (_, method) = found.ok_or_else(|| {
            let known: Vec<&str> = METHODS.iter().map(|(known, _)| *known).collect();
            let text = format!("no method is called {name}; there are {}", known.join(", "));
            Error::new(ErrorKind::Options, "unknown-method", text)
        })?;
        Ok(self.method(*method))
    }

    /// The sparse solver by the name that `sidc list` prints.
    ///
    /// # Errors
    /// [`ErrorKind::Options`]: no solver of this name.
    pub fn solver(mut self, name: &str) -> Result<Options, Error> {
        self.search.solver = solver(name).ok_or_else(|| {
            let known: Vec<&str> = sidc_solve::SOLVERS.iter().map(|s| s.name()).collect();
            let text = format!("no solver is called {name}; there are {}", known.join(", "));
            Error::new(ErrorKind::Options, "unknown-solver", text)
        })?;
        Ok(self)
    }

    /// Uses this many random rows, drawn with `seed`; the others test the result.
    pub fn samples(mut self, rows: usize, seed: u64) -> Options {
        self.search.samples = Some(rows);
        self.seed(seed)
    }

    /// Seed of every random choice. Default: 0.
    pub fn seed(mut self, seed: u64) -> Options {
        self.search.seed = seed;
        self
    }

    /// Largest number of bytes that Φ of one equation may take. Default: 4 GB.
    pub fn memory(mut self, bytes: u64) -> Options {
        self.search.memory = bytes;
        self
    }

    /// Rejects readings more than five standard deviations from the trajectory.
    pub fn robust(mut self) -> Options {
        self.search.robust = true;
        self
    }

    /// Adds the solution path to each equation: the answers for larger tolerances, from the first term on.
    pub fn path(mut self) -> Options {
        self.search.path = true;
        self
    }

    /// Searches for the sparsest equation that fits within ε and proves it sparsest, for equations found by regression. The observer hears
    /// [`Stage::Proving`](crate::Stage) meanwhile; a stop then ends only this search, and the bound reached is kept.
    pub fn prove_sparsest(mut self) -> Options {
        self.search.sparsest = true;
        self
    }

    /// Checks every equation and its certificate again, by independent code in 106-bit arithmetic.
    pub fn verify(mut self) -> Options {
        self.verify = true;
        self
    }
}
