//! Free runs of what was found, along other data.

use sidc_data as data;
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::source::Sources;
use sidc_lang::term::{Signal, SignalNames};
use sidc_progress::{Activity, Observer, Unwatched};
use sidc_system::discovery::{Discovery as FoundSystem, RunParameters};
use sidc_system::simulate::{self, Options, Run, Source};

use crate::data::Data;
use crate::discovery::Discovery;
use crate::error::{Error, ErrorKind};

/// The equations run along every record.
#[derive(Clone, Debug, Default)]
pub struct Simulation {
    pub runs: Vec<SimulatedRun>,
}

/// One record, simulated from its first row under its measured inputs.
#[derive(Clone, Debug, Default)]
pub struct SimulatedRun {
    pub name: String,
    /// Instants of the rows simulated, length R.
    pub time: Vec<f64>,
    /// States, highest derivatives, outputs: name and R values each, NaN where the run had ended.
    pub signals: Vec<(String, Vec<f64>)>,
    /// One for each signal that is simulated and measured.
    pub scores: Vec<Score>,
    /// What ended the run early, and where; `None` if it went through.
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
    /// Values of a signal by its name.
    pub fn signal(&self, name: &str) -> Option<&[f64]> {
        let found = self.signals.iter().find(|(n, _)| n == name);
        found.map(|(_, values)| values.as_slice())
    }
}

impl Discovery {
    /// Runs the equations along every record: from its first row, under its inputs, and compares with what was measured. Data are
    /// read as the model read its own.
    ///
    /// # Errors
    /// [`ErrorKind::Data`]: arrays that lack what a run needs; equations that cannot be run.
    pub fn simulate(&self, data: &Data) -> Result<Simulation, Error> {
        self.simulate_watched(data, &mut Unwatched)
    }

    /// The same while an observer hears the time reached. If it ends the work, the rows simulated by then are returned, and no
    /// further record is begun.
    ///
    /// # Errors
    /// As [`Discovery::simulate`].
    pub fn simulate_watched(
        &self,
        data: &Data,
        observer: &mut dyn Observer,
    ) -> Result<Simulation, Error> {
        let discovery = &self.opened.discovery;
        let model = simulate::reads(discovery, &self.opened.model, &[]);
        let mut sources = Sources::default();
        // The model was read back from the document, so its places lead into an empty text.
        sources.add("result", "");
        let (dataset, found) = data::bind(&model, &data.tables, &data.params, &mut sources);
        if found.iter().any(Diagnostic::is_error) {
            return Err(Error::of(ErrorKind::Data, &found, &sources));
        }
        let dataset = discovery.without_sensor_delays(&dataset).unwrap_or(dataset);
        let by_run = RunParameters::of(discovery, &model);
        let valued = by_run.as_ref().map(|p| p.with_values(&dataset));
        let source = Source {
            discovery: by_run.as_ref().map_or(discovery, |p| &p.discovery),
            model: by_run.as_ref().map_or(&model, |p| &p.model),
            dataset: valued.as_ref().unwrap_or(&dataset),
        };
        let mut ended = false;
        let mut runs = Vec::new();
        for record in 0..dataset.trajectories.len() {
            let mut observer = |activity: Activity| {
                let answer = observer.hear(activity);
                ended |= answer.is_break();
                answer
            };
            let run = simulate::simulate(&source, record, &Options::default(), &mut observer);
            let run = run.map_err(|d| Error::of(ErrorKind::Data, &[d], &sources))?;
            runs.push(named(discovery, run));
            if ended {
                break;
            }
        }
        Ok(Simulation { runs })
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
    let signals = run.simulated.into_iter();
    SimulatedRun {
        name: run.name,
        time: run.time,
        signals: signals
            .map(|(s, v): (Signal, Vec<f64>)| (names.name(s), v))
            .collect(),
        scores: run.scores.iter().map(score).collect(),
        fault,
    }
}
