//! Options of a simulation and its result.

use crate::simulate::fault::Fault;
use crate::simulate::integrate::trajectory::Path;
use crate::simulate::thresholds::{EXPLICIT, SCORES};
use sidc_data::Window;
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::term::Signal;

/// How to run.
#[derive(Clone, Debug)]
pub struct Options {
    /// Initial values that replace measured ones.
    pub start: Vec<(Signal, f64)>,
    /// The part of the record to simulate.
    pub window: Window,
    pub method: Method,
    /// Fixed steps of at most this size in seconds (classical Runge–Kutta) instead of error control.
    pub step: Option<f64>,
    /// Local error of an explicit step, of the state and its typical size.
    pub tolerance: f64,
    /// Error, in standard deviations of the measured signal, up to which a run follows it.
    pub bound: f64,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            start: Vec::new(),
            window: (None, None),
            method: Method::Auto,
            step: None,
            tolerance: EXPLICIT.tolerance,
            bound: SCORES.bound,
        }
    }
}

/// How the steps are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Explicit, and implicit from where the system turns out to be stiff.
    #[default]
    Auto,
    Explicit,
    Stiff,
}

/// All methods by name; the first is the default.
pub const METHODS: [(&str, Method); 3] = [
    ("auto", Method::Auto),
    ("explicit", Method::Explicit),
    ("stiff", Method::Stiff),
];

/// One trajectory, simulated.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// The trajectory's name.
    pub name: String,
    /// Instants of the R rows simulated.
    pub time: Vec<f64>,
    /// States, then unknowns (highest derivatives), then outputs; R values each, NaN after a leg ended.
    pub simulated: Vec<(Signal, Vec<f64>)>,
    /// Inputs as they were applied.
    pub inputs: Vec<(Signal, Vec<f64>)>,
    /// Measurements of simulated signals; NaN where missing.
    pub measured: Vec<(Signal, Vec<f64>)>,
    /// Uninterrupted stretches of the record, each with its own start.
    pub legs: Vec<Leg>,
    /// One for each signal that is simulated and measured.
    pub scores: Vec<Score>,
    pub work: Work,
    pub notes: Vec<Diagnostic>,
}

impl Run {
    /// The first fault of any leg.
    pub fn fault(&self) -> Option<&Fault> {
        self.legs.iter().find_map(|l| l.fault.as_ref())
    }

    /// Copies the rows of a path into the columns; `inputs` are the indices of the inputs that are kept.
    pub(super) fn fill(&mut self, begin: usize, path: &Path, inputs: &[usize]) {
        let simulated = self.simulated.iter_mut().enumerate();
        let simulated = simulated.map(|(place, column)| (column, &path.rows, place));
        let inputs = self.inputs.iter_mut().zip(inputs);
        let inputs = inputs.map(|(column, place)| (column, &path.inputs, *place));
        for ((_, column), rows, place) in simulated.chain(inputs) {
            let cells = column.iter_mut().skip(begin);
            cells.zip(rows.column(place)).for_each(|(c, v)| *c = *v);
        }
        self.work.evaluations += path.evaluations;
        if self.work.stiff_from.is_none() {
            self.work.stiff_from = path.stiff_from;
        }
    }

    /// Drops all rows from `end` on.
    pub(super) fn cut(&mut self, end: usize) {
        self.time.truncate(end);
        let columns = self.simulated.iter_mut().chain(&mut self.inputs);
        columns.for_each(|(_, values)| values.truncate(end));
    }

    pub fn column(&self, s: Signal) -> Option<&[f64]> {
        let found = self.simulated.iter().find(|(name, _)| *name == s);
        found.map(|(_, values)| values.as_slice())
    }
}

/// One uninterrupted simulation.
#[derive(Clone, Debug, Default)]
pub struct Leg {
    /// Rows simulated; fewer than the leg has if there is a fault.
    pub rows: std::ops::Range<usize>,
    /// First rows that the initial state was fitted to; they are not scored.
    pub settled: usize,
    pub start: Vec<Start>,
    pub fault: Option<Fault>,
}

/// The state at the first row of a leg, and what it was estimated from.
pub(crate) struct LegStart {
    pub state: Vec<Start>,
    /// First rows that it was fitted to.
    pub settled: usize,
    /// Fitted samples before it, in discrete time; empty if they are the readings.
    pub past: Vec<(Signal, Vec<f64>)>,
}

impl LegStart {
    pub fn as_read(state: Vec<Start>) -> LegStart {
        LegStart {
            state,
            settled: 0,
            past: Vec::new(),
        }
    }
}

/// Initial value of one component of the state.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    pub signal: Signal,
    pub value: f64,
    pub origin: Origin,
    /// Standard error; `None` if it was read or given.
    pub error: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    Measured,
    /// Given by the user.
    Given,
    /// A derivative estimated from clean readings.
    Differentiated,
    Smoothed,
    /// A state that nothing measures: its mean where the equations were found.
    Hidden,
    /// Smoothed, then fitted to the first readings by least squares.
    Fitted,
}

/// How well a simulated signal follows its measurement, over the rows after each start.
#[derive(Clone, Debug, PartialEq)]
pub struct Score {
    pub signal: Signal,
    /// Rows compared.
    pub rows: usize,
    /// Mean squared and mean absolute error.
    pub mse: f64,
    pub mae: f64,
    /// 10 log₁₀ of the errors' energy over the signal's.
    pub error_to_signal: f64,
    /// 100 (1 − ‖error‖/‖signal − its mean‖), per cent.
    pub fit: f64,
    /// 1 − ‖error‖²/‖signal − its mean‖².
    pub r_squared: f64,
    /// Seconds from the start until the run departs; `None` if it never does.
    pub follows: Option<f64>,
    /// The bound, in the signal's unit.
    pub bound: f64,
}

/// The cost of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Work {
    /// Points at which the equations were evaluated.
    pub evaluations: u64,
    /// When the stiff method took over.
    pub stiff_from: Option<f64>,
}
