//! Free runs of the equations found, along other data.

use sidc_lang::term::{Signal, SignalNames};
use sidc_progress::{Activity, Observer, Unwatched};
use sidc_system::discovery::{Discovery as FoundSystem, Form};
use sidc_system::simulate::{self, Options, Run};

use crate::data::Data;
use crate::discovery::Discovery;
use crate::error::{Error, ErrorKind};

/// Runs of the equations along every record.
#[derive(Clone, Debug, Default)]
pub struct Simulation {
    pub runs: Vec<SimulatedRun>,
}

/// One record, simulated from its first row under its measured inputs.
#[derive(Clone, Debug, Default)]
pub struct SimulatedRun {
    /// Of the record.
    pub name: String,
    /// Times of the rows simulated, in the unit of time, length R.
    pub time: Vec<f64>,
    /// States, highest derivatives, outputs: name and R values each, in their units, NaN after the run ended.
    pub signals: Vec<(String, Vec<f64>)>,
    /// Readings of simulated signals: name and R values each, NaN if missing.
    pub measured: Vec<(String, Vec<f64>)>,
    /// One for each signal that is both simulated and measured.
    pub scores: Vec<Score>,
    /// What ended the run early, and where; `None` if it ran to the end.
    pub fault: Option<String>,
}

/// How a simulated signal compares with its measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Score {
    pub signal: String,
    /// Rows compared.
    pub rows: usize,
    /// Mean squared error, in the signal's unit squared.
    pub mse: f64,
    /// 100 (1 − ‖error‖/‖signal − its mean‖), per cent.
    pub fit: f64,
    /// 1 − ‖error‖²/‖signal − its mean‖².
    pub r_squared: f64,
}

impl SimulatedRun {
    /// The values of a signal, by name.
    pub fn signal(&self, name: &str) -> Option<&[f64]> {
        let found = self.signals.iter().find(|(n, _)| n == name);
        found.map(|(_, values)| values.as_slice())
    }
}

impl Discovery {
    /// Runs the equations along every record, from its first row and under its inputs, and compares them with the measurements. Data are read as the model
    /// read its own.
    ///
    /// # Errors
    /// [`ErrorKind::Data`]: arrays missing that a run needs; equations that cannot be run.
    pub fn simulate(&self, data: &Data) -> Result<Simulation, Error> {
        self.simulate_from(&[], data, &mut Unwatched)
    }

    /// Like [`Discovery::simulate`], with an observer that hears the simulated time. If it ends the work, the rows simulated by then are returned, and no
    /// further record is started.
    ///
    /// # Errors
    /// As [`Discovery::simulate`].
    pub fn simulate_watched(
        &self,
        data: &Data,
        observer: &mut dyn Observer,
    ) -> Result<Simulation, Error> {
        self.simulate_from(&[], data, observer)
    }

    /// Like [`Discovery::simulate_watched`], from named initial values. A state component with an initial value needs no array; if all have one, times and
    /// inputs are enough.
    ///
    /// # Errors
    /// As [`Discovery::simulate`]; [`ErrorKind::Options`]: a name that is not in the state.
    pub fn simulate_from(
        &self,
        start: &[(&str, f64)],
        data: &Data,
        observer: &mut dyn Observer,
    ) -> Result<Simulation, Error> {
        let discovery = &self.opened.discovery;
        let options = Options {
            start: self.state_signals(start)?,
            ..Options::default()
        };
        let records = self.records(data, &options.start)?;
        let mut ended = false;
        let mut runs = Vec::new();
        for record in 0..records.dataset.trajectories.len() {
            let mut observer = |activity: Activity| {
                let answer = observer.hear(activity);
                ended |= answer.is_break();
                answer
            };
            let run = simulate::simulate(&records.source(), record, &options, &mut observer);
            let run = run.map_err(|d| Error::of(ErrorKind::Data, &[d], &records.sources))?;
            runs.push(named(discovery, run));
            if ended {
                break;
            }
        }
        Ok(Simulation { runs })
    }

    /// The given state components by their signals.
    fn state_signals(&self, start: &[(&str, f64)]) -> Result<Vec<(Signal, f64)>, Error> {
        let discovery = &self.opened.discovery;
        let state = Form::new(discovery).state;
        let signal = |(name, value): &(&str, f64)| {
            let found = state.iter().find(|s| discovery.name(**s) == *name);
            found.map(|s| (*s, *value)).ok_or_else(|| {
                let names: Vec<String> = state.iter().map(|s| discovery.name(*s)).collect();
                let text = format!(
                    "a start for {name}: the state has no component of this name\n  = state: {}",
                    names.join(", ")
                );
                Error::new(ErrorKind::Options, "unknown-start", text)
            })
        };
        start.iter().map(signal).collect()
    }
}

/// A run with the names of its signals.
fn named(names: &FoundSystem, run: Run) -> SimulatedRun {
    let score = |s: &simulate::Score| Score {
        signal: names.name(s.signal),
        rows: s.rows,
        mse: s.mse,
        fit: s.fit,
        r_squared: s.r_squared,
    };
    let fault = run.fault().map(|fault| {
        let (time, text) = (fault.time, fault.text(names));
        format!("at t = {time}: {text}")
    });
    let columns = |all: Vec<(Signal, Vec<f64>)>| {
        let named = all.into_iter().map(|(s, values)| (names.name(s), values));
        named.collect()
    };
    SimulatedRun {
        name: run.name,
        time: run.time,
        signals: columns(run.simulated),
        measured: columns(run.measured),
        scores: run.scores.iter().map(score).collect(),
        fault,
    }
}
