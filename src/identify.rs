//! Model + data → discovery: the stages of the pipeline, one after another.

use sidc_lang::diagnostic::Severity;
use sidc_progress::{Observer, Unwatched};
use sidc_system::discovery::Notice;
use sidc_system::result::{self, Beside, Settings};

use crate::data::Data;
use crate::discovery::Discovery;
use crate::error::{Error, ErrorKind};
use crate::model::Model;
use crate::options::Options;
use crate::pipeline::{self, Measured, NoiseFault, Program};

impl Model {
    /// Finds the equations. Noisy records are estimated together with their trajectory, clean ones by regression with a proof;
    /// [`Options::method`] decides otherwise.
    ///
    /// An equation with a doubt is an answer too: see [`Discovery::passes`].
    ///
    /// # Errors
    /// [`ErrorKind::Data`]: arrays that the model cannot read, all faults at once. [`ErrorKind::Options`]: a name that the
    /// model does not have.
    pub fn identify(&self, data: &Data, options: &Options) -> Result<Discovery, Error> {
        self.identify_watched(data, options, &mut Unwatched)
    }

    /// The same while an observer hears what is done and may end it. The equations found by then stand, with a doubt; the others
    /// are listed as failed.
    ///
    /// # Errors
    /// As [`Model::identify`].
    pub fn identify_watched(
        &self,
        data: &Data,
        options: &Options,
        observer: &mut dyn Observer,
    ) -> Result<Discovery, Error> {
        let program = &self.with_noise(&options.noise)?;
        let mut sources = self.sources.clone();
        let asked = (&options.rows, &options.search);
        let (measured, found) = pipeline::measure(
            program,
            &data.tables,
            &data.params,
            asked,
            &mut sources,
            observer,
        );
        let Some(measured) = measured else {
            return Err(Error::of(ErrorKind::Data, &found, &sources));
        };
        let discovery = pipeline::identify(program, &measured, &options.search, observer);
        let mut discovery =
            discovery.map_err(|found| Error::of(ErrorKind::Data, &found, &sources))?;
        if options.verify {
            pipeline::verify(program, &measured, &mut discovery, observer);
        }
        let validation = pipeline::validate(program, &measured, &mut discovery, observer);
        let said = self.findings().iter().chain(&found);
        let warnings = said.filter(|d| d.severity == Severity::Warning);
        let document = result::document(
            &discovery,
            Beside {
                settings: self.settings(program, &measured, data, options),
                signals: pipeline::signal_entries(program, &measured),
                warnings: warnings.map(|d| Notice::new(d.code, &d.message)).collect(),
                validation,
                candidates: Vec::new(),
            },
        );
        Discovery::from_document(document)
    }

    /// What the options say of the sensors holds over the model.
    fn with_noise(&self, noise: &[(String, f64)]) -> Result<Program, Error> {
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

    fn settings(
        &self,
        program: &Program,
        measured: &Measured,
        data: &Data,
        options: &Options,
    ) -> Settings {
        let (search, rows) = (&options.search, &options.rows);
        let records = &measured.dataset.trajectories;
        let run = |place: &usize| data.tables.get(*place).map(|t| t.name.clone());
        let stretches = rows.held.stretches.iter().map(ToString::to_string);
        let runs = rows.held.files.iter().filter_map(run);
        Settings {
            model: self.name.clone(),
            data: records.iter().map(|t| t.name.clone()).collect(),
            method: search.method.chosen().into(),
            solver: search.solver.name().into(),
            samples: search.samples,
            seed: search.seed,
            window: (rows.window != (None, None)).then_some(rows.window),
            holdout: stretches.chain(runs).collect(),
            params: data.params.clone(),
            robust: search.robust,
            files: Vec::new(),
            source: self.text.clone(),
            reading: pipeline::reading(program, measured),
        }
    }
}
