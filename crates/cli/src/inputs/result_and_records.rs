//! A result and the records to run it along: the options of such commands, and how both are read.
//!
//! In: files, options. Out: the result, and data bound to what a simulation of it reads. Runs nothing.

use std::path::{Path, PathBuf};
use std::time::Duration;

use super::{tables, texts};
use crate::failure::Failure;
use crate::monitoring::monitor::Monitor;
use crate::monitoring::verbosity::Verbosity;
use crate::option_values::names::hint;
use crate::option_values::{assignments, quantities};
use crate::outputs::diagnostics;
use crate::outputs::paths::short_name;
use sidc_data as data;
use sidc_data::Dataset;
use sidc_emit::report::MAX_MODELS;
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::model::Model;
use sidc_lang::source::{FileId, Sources};
use sidc_lang::term::{Signal, SignalNames};
use sidc_system::discovery::{Discovery, Form};
use sidc_system::result::{FileEntry, Opened};
use sidc_system::simulate;

/// A result and records, and how they are read.
#[derive(clap::Args)]
pub struct ResultAndRecordsArgs {
    /// Result of `sidc identify … -o R.json`, and one or more data files; each trajectory is a run of its own
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// Constant parameters: one value a trajectory, or one for all
    #[arg(long = "param", value_name = "m=0.3,0.5", value_parser = assignments::parameter)]
    params: Vec<(String, Vec<f64>)>,
    /// End the runs after this time, with what there is: 30, 30s, 5m, 1h
    #[arg(long, value_name = "TIME", value_parser = quantities::time)]
    time_limit: Option<Duration>,
    /// Most memory for all tables: 500MB, 2GB (10^9 bytes), 2GiB (2^30)
    #[arg(long, value_name = "SIZE", value_parser = quantities::memory, default_value = quantities::MEMORY)]
    memory_limit: u64,
    #[command(flatten)]
    verbosity: Verbosity,
}

/// A result, and records bound to it.
pub struct ResultAndRecords {
    /// Name of the result's file, without folders.
    pub name: String,
    pub opened: Opened,
    pub model: Model,
    pub dataset: Dataset,
    pub files: Vec<FileEntry>,
    /// Components of the initial state that the user gave.
    pub start: Vec<(Signal, f64)>,
}

impl ResultAndRecordsArgs {
    pub fn monitor(&self) -> Monitor {
        Monitor::start(&self.verbosity, self.time_limit)
    }

    /// Reads the result and binds the data to what a simulation of it reads. State components in `start` need no column. Messages name `command`.
    ///
    /// # Errors
    /// Faults of the files or of `start`.
    pub fn open(
        &self,
        command: &str,
        start: &[Vec<(String, f64)>],
        monitor: &Monitor,
    ) -> Result<ResultAndRecords, Failure> {
        let (result, data) = split(&self.files, command)?;
        self.bind(result, data, start, monitor)
    }

    /// Reads each of the results, which come first among the files, and binds it to the same data.
    ///
    /// # Errors
    /// Faults of the files, or more results than a page can distinguish.
    pub fn open_each(
        &self,
        command: &str,
        monitor: &Monitor,
    ) -> Result<Vec<ResultAndRecords>, Failure> {
        let is_result = |f: &&PathBuf| f.extension().is_some_and(|e| e == "json");
        let results = self.files.iter().take_while(is_result).count().max(1);
        let last = self.files.get(results - 1..).unwrap_or(&[]);
        let (_, data) = split(last, command)?;
        if results > MAX_MODELS {
            return Err(Failure::new(format!(
                "error[several-results]: {results} results; {MAX_MODELS} can be told apart on one page"
            )));
        }
        let each = self.files.iter().take(results);
        each.map(|result| self.bind(result, data, &[], monitor))
            .collect()
    }

    fn bind(
        &self,
        result: &Path,
        data: &[PathBuf],
        start: &[Vec<(String, f64)>],
        monitor: &Monitor,
    ) -> Result<ResultAndRecords, Failure> {
        let name = short_name(result);
        let opened = texts::result(result)?;
        let start = start_signals(&opened.discovery, start)?;
        let model = simulate::reads(&opened.discovery, &opened.model, &start);
        let mut sources = Sources::default();
        // The model comes from the result, so its positions refer to an empty text.
        sources.add(name.as_str(), "");
        monitor.stages.done("result read");
        let data = tables::read(data, self.memory_limit, &mut sources, monitor)?;
        let (dataset, mut found) = data::bind(&model, &data.tables, &self.params, &mut sources);
        // Constant columns matter only for a library of terms, and a result has none.
        found.retain(|d| d.code != "constant-column");
        found.iter_mut().for_each(|d| for_user_of_result(d, &name));
        let complete = !found.iter().any(Diagnostic::is_error);
        diagnostics::report((complete.then_some(()), found), &sources, monitor.notes)?;
        monitor.stages.done("data bound");
        let as_read = opened.discovery.without_sensor_delays(&dataset);
        Ok(ResultAndRecords {
            name,
            opened,
            model,
            dataset: as_read.unwrap_or(dataset),
            files: data.entries,
            start,
        })
    }
}

/// Splits the files into the result, which comes first, and the data files.
fn split<'a>(files: &'a [PathBuf], command: &str) -> Result<(&'a Path, &'a [PathBuf]), Failure> {
    let Some((result, data)) = files.split_first() else {
        return Err(Failure::new("error[no-data]: no files"));
    };
    if data.is_empty() {
        return Err(Failure::new(format!(
            "error[no-data]: no data file\n  = help: sidc {command} R.json DATA.csv"
        )));
    }
    Ok((result, data))
}

/// The names in `--start` as signals of the state.
fn start_signals(
    d: &Discovery,
    start: &[Vec<(String, f64)>],
) -> Result<Vec<(Signal, f64)>, Failure> {
    let state = Form::new(d).state;
    let signal = |(name, value): &(String, f64)| {
        let found = state.iter().find(|s| d.name(**s) == *name);
        found.map(|s| (*s, *value)).ok_or_else(|| {
            let names: Vec<String> = state.iter().map(|s| d.name(*s)).collect();
            let hint = hint(name, names.iter().map(String::as_str));
            Failure::new(format!(
                "error[unknown-start]: --start {name}: the state has no component of this name{hint}\n  = state: {}",
                names.join(", ")
            ))
        })
    };
    start.iter().flatten().map(signal).collect()
}

/// Rewords diagnostics about a model, which the user may not have, so that they are about the result.
fn for_user_of_result(d: &mut Diagnostic, name: &str) {
    d.labels.retain(|l| l.span.file != FileId(0));
    let advice = d.help.as_deref().unwrap_or_default();
    if d.is_error() && advice.starts_with("data {") {
        d.help = Some(format!(
            "{name} reads its columns as its model did: name the column so, or identify again with {advice}"
        ));
    }
    if d.code == "input-between" || d.code == "slope-disagrees" {
        d.help = None;
    }
}
