//! Which signals were measured and which were estimated, as text.

use sidc::pipeline::{self, Measured, Program};
use sidc_lang::number::significant;
use sidc_lang::term::SignalNames;
use sidc_lang::words::beginning;

use crate::thresholds::LISTS;

/// The name of the only trajectory, or the number of trajectories.
pub fn trajectories(measured: &Measured) -> String {
    match measured.dataset.trajectories.as_slice() {
        [one] => one.name.clone(),
        many => format!("{} trajectories", many.len()),
    }
}

/// A line for the measured signals, and a line for each estimated one with its method and error.
pub fn describe(program: &Program, measured: &Measured) -> String {
    let entries = pipeline::signal_entries(program, measured);
    let columns = measured.dataset.trajectories.first().map(|t| &t.columns);
    let columns: Vec<String> = columns
        .into_iter()
        .flatten()
        .filter(|(signal, _)| !program.model.is_constant(signal.var))
        .map(|(signal, _)| program.model.name(*signal))
        .collect();
    let mut text = format!("measured: {}\n", columns.join(", "));
    let unread = &measured.dataset.unread;
    if !unread.is_empty() {
        text.push_str(&format!("not read: {}\n", beginning(unread, LISTS.unread)));
    }
    for e in &entries {
        if let Some(error) = e.error {
            text.push_str(&format!(
                "estimated: {} by {}, error about {} of its size\n",
                e.signal,
                e.origin,
                significant(error, 2)
            ));
        }
    }
    text
}

/// `1 table`, `2 tables`
pub fn counted(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}
