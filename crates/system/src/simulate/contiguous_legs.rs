//! Legs: the uninterrupted stretches of a record, and the scores of outputs along them.
//!
//! In: times, a finished run. Out: ranges of rows, warnings.

use std::ops::Range;

use crate::discovery::{Discovery, Form};
use crate::simulate::diagnostics;
use crate::simulate::run::Run;
use sidc_lang::diagnostic::Diagnostic;

/// Rows between gaps. A system without inputs runs through gaps.
pub(crate) fn legs(time: &[f64], discrete: bool, driven: bool) -> Vec<Range<usize>> {
    if discrete {
        let mut from = 0;
        let holes = (1..time.len()).filter(|k| time[*k] - time[k - 1] != 1.0);
        let ends = holes.chain([time.len()]);
        return ends
            .map(|to| std::mem::replace(&mut from, to)..to)
            .collect();
    }
    if !driven {
        return std::iter::once(0..time.len()).collect();
    }
    sidc_data::contiguous_ranges(time)
}

/// Warnings for outputs that are not finite at simulated rows. Nothing depends on outputs, so they do not end a run.
pub(crate) fn undefined_outputs(d: &Discovery, form: &Form, run: &Run) -> Vec<Diagnostic> {
    let outputs = form.outputs.iter();
    let rows = || run.legs.iter().flat_map(|l| l.rows.clone());
    let found = outputs.filter_map(|(s, _)| {
        let values = run.column(*s)?;
        let absent = |k: &usize| values.get(*k).is_some_and(|v| !v.is_finite());
        let first = run.time.get(rows().find(absent)?)?;
        let count = rows().filter(absent).count();
        Some(diagnostics::undefined_output(d, *s, *first, count))
    });
    found.collect()
}
