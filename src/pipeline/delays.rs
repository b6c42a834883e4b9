//! Whether records are long enough for the delays of a model.
//!
//! In: a model, a dataset. Out: diagnostics at the declarations. Estimates no delay.

use sidc_data::{Dataset, contiguous_ranges};
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::model::{Delay, Model, Var, VarKind};
use sidc_lang::number::significant;

use super::thresholds::DELAYS;

/// Errors for delays that are too long for every record.
pub(super) fn check(model: &Model, dataset: &Dataset) -> Vec<Diagnostic> {
    let spans = dataset.trajectories.iter().flat_map(|t| {
        let span = |rows: std::ops::Range<usize>| {
            let part = t.time.get(rows)?;
            Some(part.last()? - part.first()?)
        };
        contiguous_ranges(&t.time).into_iter().filter_map(span)
    });
    let longest = spans.fold(0.0, f64::max);
    let too_long = model.delays().filter_map(|(id, delay)| {
        let size = match delay {
            Delay::Known(seconds) => seconds,
            Delay::Within { from, to } => from.abs().max(to.abs()),
        };
        let var = model.var(id).filter(|_| size > DELAYS.longest * longest)?;
        Some(too_long((var, &model.time_unit()), size, longest))
    });
    too_long.collect()
}

fn too_long((var, unit): (&Var, &str), size: f64, longest: f64) -> Diagnostic {
    let name = &var.name;
    let message = format!(
        "{name} is delayed by up to {} {unit}, and the longest record without a gap has room for {} {unit}",
        significant(size, 4),
        significant(DELAYS.longest * longest, 4)
    );
    let d = Diagnostic::error("delay-too-long", message);
    let d = match var.span {
        Some(span) => d.at(span, "declared here"),
        None => d,
    };
    d.help("delays are in the unit of time: declare a shorter one, or record longer")
}

/// The error for a range of delays that will not be searched; `None` if the model has none.
pub(super) fn search_unavailable(model: &Model, why: &str) -> Option<Diagnostic> {
    let (id, delay) = model
        .delays()
        .find(|(_, delay)| matches!(delay, Delay::Within { .. }))?;
    let Delay::Within { from, to } = delay else {
        return None;
    };
    let var = model.var(id)?;
    let name = &var.name;
    let keyword = match var.kind {
        VarKind::State => "state",
        _ => "input",
    };
    let message = format!(
        "the delay of {name} is sought together with the trajectory, and here that is not estimated: {why}"
    );
    let d = Diagnostic::error("delay-not-sought", message);
    let d = match var.span {
        Some(span) => d.at(span, "declared here"),
        None => d,
    };
    let middle = significant(0.5 * (from + to).max(0.0), 3);
    Some(d.help(format!(
        "leave --method, --samples and --path out, or state the delay: `{keyword} {name} : delay {middle}`"
    )))
}
