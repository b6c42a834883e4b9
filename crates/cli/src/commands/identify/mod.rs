//! `sidc identify MODEL DATA…`: the equations of a model, found in data.
//!
//! `arguments` → `search` (each model with its rows and equations) → `model_comparison`, if there are several models → `answer`.

mod answer;
mod arguments;
mod model_comparison;
mod next_step;
mod search;

use crate::failure::Failure;
use crate::inputs::files::InputFiles;
use crate::inputs::tables;
use crate::monitoring::monitor::Monitor;
use crate::option_values::time_ranges::HeldOut;
use crate::outputs::signals::counted;
use crate::outputs::{diagnostics, files};
use answer::Answer;
pub use arguments::Args;
use search::{Candidate, Search};
use sidc::{Budget, pipeline};
use sidc_lang::source::Sources;

pub fn run(args: &Args) -> Result<u8, Failure> {
    let mut monitor = Monitor::start(&args.verbosity, args.time_limit);
    monitor.proving = Budget::of(args.prove_sparsest);
    let inputs = InputFiles::sort(&args.files)?;
    args.check_effects(inputs.models.len())?;
    let held_out = args.holdout.iter().filter_map(HeldOut::file);
    files::check_writable(args.output.as_deref(), args.files.iter().chain(held_out))?;
    let mut sources = Sources::default();
    let paths = args.data_paths(&inputs.data);
    let options = args.options(&paths, inputs.models.len())?;
    let models = (inputs.models.as_slice(), &options);
    let models = search::compile(args, models, &mut sources, monitor.notes)?;
    let compiled = counted(models.len(), "model", "models");
    monitor.stages.done(&format!("{compiled} compiled"));
    if inputs.data.is_empty() {
        return Err(Failure::new(
            "error[no-data]: no data file\n  = help: sidc identify MODEL.sid DATA.csv",
        ));
    }
    let read = tables::read(&paths, args.memory_limit, &mut sources, &monitor)?;
    let duplicates = tables::duplicates(&read.entries);
    diagnostics::report((Some(()), duplicates), &sources, monitor.notes)?;
    let mut search = Search {
        data: pipeline::from_tables(read.tables, args.params.clone()),
        options,
        verify: args.verify,
        sources,
        monitor,
    };
    search.monitor.listen();
    let mut candidates: Vec<Candidate> = Vec::new();
    for mut model in models {
        model.source.files.extend(read.entries.iter().cloned());
        candidates.push(search.measure(model, args.method)?);
        search.monitor.stages.done("data bound, signals prepared");
    }
    let (candidate, found, others) = match candidates.as_slice() {
        [alone] => (alone, search.identify(alone)?, Vec::new()),
        several => model_comparison::best(several, &search, args.until)?,
    };
    let answer = Answer {
        args,
        search: &search,
        candidate,
        found: &found,
        others: &others,
    };
    answer.print()
}
