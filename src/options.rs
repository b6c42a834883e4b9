//! How to look for equations.

use sidc_data::{HoldOut, HoldOutRange, Window};
use sidc_discover::{METHODS, Method};
use sidc_lang::sensor_noise::SensorNoise;
use sidc_solve::solver;
use sidc_system::predict::{ErrorLimit, PredictionRequest};

use crate::error::{Error, ErrorKind};
use crate::pipeline::BUDGET;

/// How to look for equations; the default suits most data. Each setter returns the options with one thing changed.
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
    /// Standard deviation of a signal's measurement, in the model's units; holds over what the model declares.
    pub fn noise(mut self, signal: &str, deviation: f64) -> Options {
        self.noise
            .push((signal.into(), SensorNoise::constant(deviation)));
        self
    }

    /// The same for noise that grows with the signal: of standard deviation √(floor² + (share · value)²).
    pub fn growing_noise(mut self, signal: &str, floor: f64, share: f64) -> Options {
        self.noise
            .push((signal.into(), SensorNoise { floor, share }));
        self
    }

    /// Finds no equations from this part of every record, and runs them there. May be called several times.
    pub fn hold_out(mut self, stretch: HoldOutRange) -> Options {
        self.held_out.stretches.push(stretch);
        self
    }

    /// Finds no equations from the record at this place, counted from 0, and runs them there.
    pub fn hold_out_run(mut self, place: usize) -> Options {
        self.held_out.files.push(place);
        self
    }

    /// Uses only rows with from ≤ t ≤ to; an absent end is open.
    pub fn window(mut self, from: Option<f64>, to: Option<f64>) -> Options {
        self.window = (from, to);
        self
    }

    /// How far ahead predictions are compared with the data, in seconds, in discrete time in samples. Default: what suits the data.
    pub fn horizon(mut self, ahead: f64) -> Options {
        self.prediction.horizon = Some(ahead);
        self
    }

    /// The error, as a part of each signal's spread, that predictions on data not used are to stay within in 90 % of the starts: see
    /// [`Prediction::good`](crate::Prediction). If nothing is held out, the last quarter of every record is.
    pub fn good(mut self, part: f64) -> Options {
        self.prediction.good.push(ErrorLimit::Share(part));
        self
    }

    /// The same for one signal, in its unit.
    pub fn good_signal(mut self, signal: &str, error: f64) -> Options {
        let limit = ErrorLimit::Signal(signal.into(), error);
        self.prediction.good.push(limit);
        self
    }

    /// What is held out: as asked, or the last quarter where predictions are to be good and nothing was asked.
    pub(crate) fn holds_out(&self) -> HoldOut {
        let mut held_out = self.held_out.clone();
        if held_out.is_empty() && !self.prediction.good.is_empty() {
            held_out.stretches.push(HoldOutRange::Last(BUDGET.held_out));
        }
        held_out
    }

    /// What equations are found from; [`Method::Auto`] leaves that to the program.
    pub fn method(mut self, method: Method) -> Options {
        self.search.method = method;
        self
    }

    /// The same by the name that `sidc identify --method` takes.
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

    /// Uses so many random rows, drawn by `seed`; the others test the answer.
    pub fn samples(mut self, rows: usize, seed: u64) -> Options {
        self.search.samples = Some(rows);
        self.seed(seed)
    }

    /// Seed of every random choice. Default: 0.
    pub fn seed(mut self, seed: u64) -> Options {
        self.search.seed = seed;
        self
    }

    /// Most bytes that Φ of one equation may take. Default: 4 GB.
    pub fn memory(mut self, bytes: u64) -> Options {
        self.search.memory = bytes;
        self
    }

    /// Gives readings more than five standard deviations from the trajectory no weight.
    pub fn robust(mut self) -> Options {
        self.search.robust = true;
        self
    }

    /// Adds to each equation the answers for larger tolerances, from the first term on.
    pub fn path(mut self) -> Options {
        self.search.path = true;
        self
    }

    /// Looks for the sparsest equation that fits within ε and proves that it is, where an equation is found from rows alone. The
    /// observer hears [`Stage::Proving`](crate::Stage) meanwhile; ending it then ends this alone, and the bound is what is known.
    pub fn prove_sparsest(mut self) -> Options {
        self.search.sparsest = true;
        self
    }

    /// Checks every equation and its proof once more, by separate code in 106 bits.
    pub fn verify(mut self) -> Options {
        self.verify = true;
        self
    }
}
