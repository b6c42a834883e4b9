//! A result run along records: the options that every such command has, and the reading of both.
//!
//! In: files, options. Out: the result, and data bound to what a simulation of it reads. Runs nothing.

use std::path::{Path, PathBuf};
use std::time::Duration;

use super::limits::{self, Limits};
use super::narrate::{Narrator, Talk};
use super::{Failure, hint, inputs, values};
use sidc_data as data;
use sidc_data::Dataset;
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::model::Model;
use sidc_lang::source::{FileId, Sources};
use sidc_lang::term::{Signal, SignalNames};
use sidc_system::discovery::Discovery;
use sidc_system::result;
use sidc_system::result::{FileEntry, Opened};
use sidc_system::simulate;

/// A result and records, and how they are read.
#[derive(clap::Args)]
pub struct Against {
    /// Result of `sidc identify … -o R.json`, and one or more data files; each trajectory is a run of its own
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Constant parameters: one value a trajectory, or one for all
    #[arg(long = "param", value_name = "m=0.3,0.5", value_parser = values::parameter)]
    params: Vec<(String, Vec<f64>)>,
    /// End the runs after this time, with what there is: 30, 30s, 5m, 1h
    #[arg(long, value_name = "TIME", value_parser = limits::time)]
    pub time_limit: Option<Duration>,
    /// Most memory for all tables: 500MB, 2GB (10^9 bytes), 2GiB (2^30)
    #[arg(long, value_name = "SIZE", value_parser = limits::memory, default_value = limits::MEMORY)]
    memory_limit: u64,
    #[command(flatten)]
    pub talk: Talk,
}

/// A result and records that are read as its own were.
pub struct Bound {
    /// Of the result's file, without folders.
    pub name: String,
    pub opened: Opened,
    pub model: Model,
    pub dataset: Dataset,
    pub files: Vec<FileEntry>,
    pub given: Vec<(Signal, f64)>,
}

impl Against {
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Reads the result and binds the data to what a simulation of it reads; components of the state in `start` need no column.
    ///
    /// # Errors
    /// What is wrong with the files, or with `start`. `command` is for the advice.
    pub fn open(
        &self,
        command: &str,
        start: &[Vec<(String, f64)>],
        (limits, narrator): (&Limits, &Narrator),
    ) -> Result<Bound, Failure> {
        let (result, data) = sort(&self.files, command)?;
        let name = inputs::short_name(result);
        let opened = result::open(&name, &inputs::result(result)?)
            .map_err(|d| Failure::new(inputs::render(&[d], &Sources::default())))?;
        let given = given(&opened.discovery, start)?;
        let model = simulate::reads(&opened.discovery, &opened.model, &given);
        let mut sources = Sources::default();
        // Places in a model that nobody wrote are not shown; they are those of the first text.
        sources.add(name.as_str(), "");
        narrator.done("result read");
        let read = (self.memory_limit, &mut sources);
        let (tables, files) = self.talk.tables(data, read, (limits, narrator))?;
        let (dataset, mut said) = data::bind(&model, &tables, &self.params, &mut sources);
        // A library is nobody's concern here.
        said.retain(|d| d.code != "constant-column");
        said.iter_mut().for_each(|d| to_user_of_result(d, &name));
        let whole = !said.iter().any(Diagnostic::is_error);
        inputs::report((whole.then_some(()), said), &sources, self.talk.notes())?;
        narrator.done("data bound");
        Ok(Bound {
            name,
            opened,
            model,
            dataset,
            files,
            given,
        })
    }
}

/// The result among the files, and the rest.
fn sort<'a>(files: &'a [PathBuf], command: &str) -> Result<(&'a Path, &'a [PathBuf]), Failure> {
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

/// Names of `--start` as signals of the state.
fn given(d: &Discovery, start: &[Vec<(String, f64)>]) -> Result<Vec<(Signal, f64)>, Failure> {
    let state = sidc_system::discovery::Form::new(d).state;
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

/// What binding says is about a model that the user may not have; here it is about the result.
fn to_user_of_result(d: &mut Diagnostic, name: &str) {
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
