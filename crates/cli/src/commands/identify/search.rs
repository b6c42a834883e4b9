//! From models to equations: compiles, measures, identifies.
//!
//! In: models, and the data, options and monitor that they share. Out: equations with evidence, run on the held-out data. Compares and prints no results.

use std::path::PathBuf;

use super::arguments::Args;
use crate::failure::Failure;
use crate::inputs::texts;
use crate::monitoring::monitor::Monitor;
use crate::monitoring::stderr;
use crate::monitoring::verbosity::Notes;
use crate::option_values::assignments;
use crate::option_values::names::hint;
use crate::outputs::diagnostics;
use crate::outputs::paths::short_name;
use crate::thresholds::PROGRESS;
use sidc::pipeline::{self, Judgement, Measured, ModelSource, Program};
use sidc::{Data, Method, Options, Validation, Verdict};
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::source::Sources;
use sidc_system::discovery::{Discovery, Notice};

/// A compiled model.
pub struct CompiledModel {
    pub source: ModelSource,
    program: Program,
    warnings: Vec<Notice>,
}

/// A model with its data.
pub struct Candidate {
    pub source: ModelSource,
    pub program: Program,
    pub measured: Measured,
    /// Warnings that are kept with the result.
    pub warnings: Vec<Notice>,
}

/// The equations of a candidate.
pub struct Identified {
    pub discovery: Discovery,
    /// Free runs on the held-out data; `None` if nothing was held out.
    pub validation: Option<Validation>,
    pub verdict: Verdict,
}

/// What all models share.
pub struct Search {
    pub data: Data,
    pub options: Options,
    /// Whether equations are verified.
    pub verify: bool,
    pub sources: Sources,
    pub monitor: Monitor,
}

/// Compiles every model.
///
/// # Errors
/// The faults of all models at once.
pub fn compile(
    args: &Args,
    (paths, options): (&[PathBuf], &Options),
    sources: &mut Sources,
    notes: Notes,
) -> Result<Vec<CompiledModel>, Failure> {
    let mut failed = Failure::default();
    let mut models = Vec::new();
    for path in paths {
        let model = texts::model(path, sources).and_then(|(file, files)| {
            let compiled = pipeline::compile(file, sources, args.memory_limit);
            let warnings = pipeline::warnings(&compiled.1);
            let mut program = diagnostics::report(compiled, sources, notes)?;
            assignments::set_noise(&mut program, &args.noise)?;
            quantities_asked(&program, options)?;
            let source = ModelSource {
                name: short_name(path),
                text: program.text.to_string(),
                files,
            };
            Ok(CompiledModel {
                source,
                program,
                warnings,
            })
        });
        match model {
            Ok(model) => models.push(model),
            Err(more) => failed.add(more),
        }
    }
    failed.or(models)
}

/// Rejects limits of errors for signals that no equation predicts.
fn quantities_asked(program: &Program, options: &Options) -> Result<(), Failure> {
    pipeline::check_limits(program, options).map_err(|(name, known)| {
        let hint = hint(&name, known.iter().map(String::as_str));
        Failure::new(format!(
            "error[unknown-good]: --good {name}: no equation predicts a signal of this name{hint}\n  = predicted: {}",
            known.join(", ")
        ))
    })
}

impl Search {
    /// Reads the signals of a model on common rows.
    ///
    /// # Errors
    /// What the data lack.
    pub fn measure(&mut self, model: CompiledModel, method: Method) -> Result<Candidate, Failure> {
        let CompiledModel {
            source,
            program,
            mut warnings,
        } = model;
        let mut observer = self.monitor.observer(&program.model);
        let (data, options, sources) = (&self.data, &self.options, &mut self.sources);
        let (measured, mut found) =
            pipeline::measure(&program, data, options, sources, &mut observer);
        drop(observer);
        if method == Method::Weak {
            // The weak form uses no estimated derivatives, so warnings about them do not apply.
            let of_derivatives = ["noisy-derivative", "input-changes-often"];
            found.retain(|d| !of_derivatives.contains(&d.code));
        }
        warnings.extend(pipeline::warnings(&found));
        let notes = self.monitor.notes;
        let measured = diagnostics::report((measured, found), &self.sources, notes)?;
        Ok(Candidate {
            source,
            program,
            measured,
            warnings,
        })
    }

    /// Finds the equations of a candidate and runs them on the held-out data.
    ///
    /// # Errors
    /// Terms without a value on the data, constraints that the data contradict.
    pub fn identify(&self, candidate: &Candidate) -> Result<Identified, Failure> {
        let (program, measured) = (&candidate.program, &candidate.measured);
        let stages = &self.monitor.stages;
        let mut observer = self.monitor.observer(&program.model);
        let found = pipeline::identify(program, measured, &self.options, &mut observer);
        stages.close();
        stages.done("evidence weighed");
        let mut discovery = found.map_err(|d| diagnostics::failure(&d, &self.sources))?;
        if let Some(notice) = discovery.other_way() {
            let warning = Diagnostic::warning("other-way", notice.text);
            let said = (Some(()), vec![warning]);
            diagnostics::report(said, &self.sources, self.monitor.notes)?;
        }
        if self.verify {
            if self.monitor.notes != Notes::None {
                announce(pipeline::verification_work(program, measured, &discovery));
            }
            pipeline::verify(program, measured, &mut discovery, &mut observer);
            stages.close();
        }
        let options = &self.options;
        let Judgement {
            validation,
            verdict,
        } = pipeline::judge(program, measured, &mut discovery, options, &mut observer);
        stages.done("predicted and run");
        Ok(Identified {
            discovery,
            validation,
            verdict,
        })
    }
}

/// Announces how long a verification will take if it is long.
fn announce(products: u128) {
    if products > PROGRESS.announced_products {
        let seconds = products as f64 / PROGRESS.products_per_second;
        stderr::replace_line(&format!(
            "verifying: {:.1e} products in 106 bits, some {seconds:.0} s; Ctrl-C or --time-limit ends it\n",
            products as f64
        ));
    }
}
