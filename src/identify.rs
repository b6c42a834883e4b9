//! Model + data → discovery: the stages of the pipeline, one after another.

use sidc_lang::sensor_noise::SensorNoise;
use sidc_progress::{Observer, Unwatched};
use sidc_system::result::{self, DocumentContext, FileEntry};

use crate::data::Data;
use crate::discovery::Discovery;
use crate::error::{Error, ErrorKind};
use crate::model::Model;
use crate::options::Options;
use crate::pipeline::{self, ModelSource, NoiseFault, Program};
use crate::reduced::Reduced;

impl Model {
    /// Finds the equations. Unless [`Options::method`] says otherwise, equations of noisy records are estimated together with the trajectory, and those of
    /// clean records by regression, with a certificate.
    ///
    /// An equation with doubts is returned too: see [`Discovery::passes`].
    ///
    /// # Errors
    /// [`ErrorKind::Data`]: arrays that the model cannot read, all faults at once. [`ErrorKind::Options`]: a name that is not in the model.
    pub fn identify(&self, data: &Data, options: &Options) -> Result<Discovery, Error> {
        self.identify_watched(data, options, &mut Unwatched)
    }

    /// Like [`Model::identify`], with an observer that may end the work. The equations found by then are kept, with a doubt; the others are listed as failed.
    ///
    /// # Errors
    /// As [`Model::identify`].
    pub fn identify_watched(
        &self,
        data: &Data,
        options: &Options,
        observer: &mut dyn Observer,
    ) -> Result<Discovery, Error> {
        self.searched(data, options, None, observer)
    }

    /// Like [`Model::identify_watched`]. If `reduced` rows are given, the coefficients are those of all rows.
    pub(crate) fn searched(
        &self,
        data: &Data,
        options: &Options,
        reduced: Option<&Reduced>,
        observer: &mut dyn Observer,
    ) -> Result<Discovery, Error> {
        let program = &self.with_noise(&options.noise)?;
        pipeline::check_limits(program, options).map_err(|(name, known)| {
            let text = format!(
                "a good error for {name}: no equation predicts a signal of this name\n  = predicted: {}",
                known.join(", ")
            );
            Error::new(ErrorKind::Options, "unknown-good", text)
        })?;
        if data.tables.is_empty() {
            let text =
                "there are no data\n  = help: add a table: `Data::new().file(…)` or `.run(…)`";
            return Err(Error::new(ErrorKind::Data, "no-data", text));
        }
        let records = data.tables.len();
        if let Some(place) = options.held_out.files.iter().find(|p| **p >= records) {
            let text = format!(
                "record {place} is to be held out, and the data have {records}\n  = help: records are counted from 0"
            );
            return Err(Error::new(ErrorKind::Options, "unknown-record", text));
        }
        let mut sources = self.sources.clone();
        let (measured, found) = pipeline::measure(program, data, options, &mut sources, observer);
        let Some(measured) = measured else {
            return Err(Error::of(ErrorKind::Data, &found, &sources));
        };
        let mut discovery = pipeline::identify(program, &measured, options, observer)
            .map_err(|found| Error::of(ErrorKind::Data, &found, &sources))?;
        if let Some(reduced) = reduced {
            let factors = reduced.factors();
            pipeline::refit_all_rows(
                program,
                &measured,
                factors,
                options,
                &mut discovery,
                observer,
            );
        } else if options.verify {
            pipeline::verify(program, &measured, &mut discovery, observer);
        }
        let judgement = pipeline::judge(program, &measured, &mut discovery, options, observer);
        let source = ModelSource {
            name: self.name.clone(),
            text: self.text().to_string(),
            files: self.files(data),
        };
        let document = result::document(
            &discovery,
            DocumentContext {
                settings: pipeline::settings(&source, program, &measured, data, options),
                signals: pipeline::signal_entries(program, &measured),
                warnings: pipeline::warnings(self.findings().iter().chain(&found)),
                validation: judgement.validation,
                verdict: Some(judgement.verdict),
                candidates: Vec::new(),
            },
        );
        Discovery::from_document(document)
    }

    /// The files of the model and of the data; empty if the data do not come from files.
    fn files(&self, data: &Data) -> Vec<FileEntry> {
        match data.files() {
            [] => Vec::new(),
            read => {
                let own = self.sources.iter();
                let own = own.map(|s| pipeline::file_entry(&s.name, s.text.as_bytes()));
                own.chain(read.iter().cloned()).collect()
            }
        }
    }

    /// The program, with noise given in the options in place of the noise that the model declares.
    pub(crate) fn with_noise(&self, noise: &[(String, SensorNoise)]) -> Result<Program, Error> {
        let mut program = self.program.clone();
        pipeline::set_noise(&mut program, noise).map_err(|fault| {
            let (code, text) = match fault {
                NoiseFault::Twice(name) => ("given-twice", format!("the noise of {name} is given twice")),
                NoiseFault::Unknown { name, measured } => (
                    "unknown-noise",
                    format!(
                        "noise of {name}: the model measures no signal of this name\n  = measured: {}",
                        measured.join(", ")
                    ),
                ),
            };
            Error::new(ErrorKind::Options, code, text)
        })?;
        Ok(program)
    }
}
