//! What a simulation is asked and what it answers.

use super::fault::Fault;
use super::march::Path;
use crate::data::Window;
use crate::lang::diagnostic::Diagnostic;
use crate::term::Signal;

/// How to run.
#[derive(Clone, Debug)]
pub struct Options {
    /// Values that hold over what was measured at the start.
    pub start: Vec<(Signal, f64)>,
    /// The part of the record to simulate; it starts at the first row within.
    pub window: Window,
    pub method: Method,
    /// Fixed steps of at most so many seconds (classical Runge–Kutta) instead of error control.
    pub step: Option<f64>,
    /// Error, in standard deviations of the measured signal, up to which a simulation counts as following it.
    pub bound: f64,
}

/// Error up to which a simulation follows, if nobody says otherwise: a quarter of the signal's standard deviation.
pub const BOUND: f64 = 0.25;

impl Default for Options {
    fn default() -> Self {
        Options {
            start: Vec::new(),
            window: (None, None),
            method: Method::Auto,
            step: None,
            bound: BOUND,
        }
    }
}

/// How the steps are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Explicit until that needs too many steps.
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
    /// Instants of the rows simulated. Length R.
    pub time: Vec<f64>,
    /// States, then unknowns (highest derivatives), then outputs. Each of length R; NaN where a leg had ended.
    pub simulated: Vec<(Signal, Vec<f64>)>,
    /// What drove the system, as it was applied.
    pub inputs: Vec<(Signal, Vec<f64>)>,
    /// Measurements of simulated signals; NaN where missing.
    pub measured: Vec<(Signal, Vec<f64>)>,
    /// Stretches between gaps of the record, each with a start of its own.
    pub legs: Vec<Leg>,
    /// One for each signal that is simulated and measured.
    pub scores: Vec<Score>,
    pub work: Work,
    pub notes: Vec<Diagnostic>,
}

impl Run {
    /// The first thing that ended a leg early.
    pub fn fault(&self) -> Option<&Fault> {
        self.legs.iter().find_map(|l| l.fault.as_ref())
    }

    /// Puts a path's rows into the columns; `inputs` are the places of those that are kept.
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

    /// Leaves out what lies after the last row simulated.
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
    /// Rows of the run; those simulated are fewer if there is a fault.
    pub rows: std::ops::Range<usize>,
    /// Rows at the beginning that the start was estimated from: they are no test.
    pub settled: usize,
    pub start: Vec<Start>,
    pub fault: Option<Fault>,
}

/// Where one component of the state starts.
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
    /// By the user.
    Given,
    /// A derivative, estimated from clean readings.
    Differentiated,
    Smoothed,
    /// Smoothed, then moved so that the equations follow the first readings.
    Fitted,
}

/// How a simulated signal compares with its measurement, over the rows after each start.
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
    /// Seconds from the start until the error first exceeds the bound; `None` if it never does.
    pub follows: Option<f64>,
    /// That bound, in the signal's unit.
    pub bound: f64,
}

/// What it took.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Work {
    /// Points at which the equations were evaluated.
    pub evaluations: u64,
    /// From when on the stiff method was needed.
    pub stiff_from: Option<f64>,
}
