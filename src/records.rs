//! Records that equations run along, read as the model read its own data.

use sidc_data as data;
use sidc_data::Dataset;
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::model::Model;
use sidc_lang::source::Sources;
use sidc_lang::term::Signal;
use sidc_system::discovery::{Discovery as FoundSystem, RunParameters};
use sidc_system::simulate::{self, Source};

use crate::data::Data;
use crate::discovery::Discovery;
use crate::error::{Error, ErrorKind};

/// Equations and the records that they run along.
pub(crate) struct Records<'a> {
    found: &'a FoundSystem,
    pub model: Model,
    pub dataset: Dataset,
    /// Coefficients that differ between runs, as parameters of the runs, and the records with their values.
    by_run: Option<(RunParameters, Dataset)>,
    pub sources: Sources,
}

impl Records<'_> {
    pub fn source(&self) -> Source<'_> {
        match &self.by_run {
            None => Source {
                discovery: self.found,
                model: &self.model,
                dataset: &self.dataset,
            },
            Some((by_run, valued)) => Source {
                discovery: &by_run.discovery,
                model: &by_run.model,
                dataset: valued,
            },
        }
    }
}

impl Discovery {
    /// Binds data to what a run reads. State components in `start` need no array.
    ///
    /// # Errors
    /// [`ErrorKind::Data`]: everything that is missing.
    pub(crate) fn records(
        &self,
        data: &Data,
        start: &[(Signal, f64)],
    ) -> Result<Records<'_>, Error> {
        let found = &self.opened.discovery;
        let model = simulate::reads(found, &self.opened.model, start);
        let mut sources = Sources::default();
        // The model comes from the document, so its positions refer to an empty text.
        sources.add("result", "");
        let (dataset, faults) = data::bind(&model, &data.tables, &data.params, &mut sources);
        if faults.iter().any(Diagnostic::is_error) {
            return Err(Error::of(ErrorKind::Data, &faults, &sources));
        }
        let dataset = found.without_sensor_delays(&dataset).unwrap_or(dataset);
        let by_run = RunParameters::of(found, &model).map(|by_run| {
            let valued = by_run.with_values(&dataset);
            (by_run, valued)
        });
        Ok(Records {
            found,
            model,
            dataset,
            by_run,
            sources,
        })
    }
}
