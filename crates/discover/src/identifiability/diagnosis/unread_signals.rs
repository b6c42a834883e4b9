//! What to look for where the signals that an equation uses explain too little.
//!
//! In: a model, the signals that its samples have, the columns of the data that it does not read. Out: advice, and lines to try.

use std::borrow::Cow;

use crate::identifiability::thresholds::LISTED;
use sidc_data::Samples;
use sidc_lang::model::{Equation, Model, VarKind};
use sidc_lang::parse::is_name;
use sidc_lang::term::{Signal, SignalNames, VarId};
use sidc_lang::words::listed;

/// Rows with the measured target, and the headers of columns of the data that the model does not read.
pub type ReadAndUnread<'a> = (&'a Samples, &'a [String]);

/// What to look for where the signals that are used explain too little, and the lines to try.
pub(super) fn what_to_look_for(
    model: &Model,
    target: Signal,
    (read, unread): ReadAndUnread,
) -> (String, Option<Vec<String>>) {
    let stated = model.equations.iter().find(|e| e.target == target);
    let unused = unused_inputs(model, read);
    if !unused.is_empty() {
        let advice = format!("add {}, which no equation uses", listed(&unused));
        return (advice, stated.map(|e| vec![e.with(&unused)]));
    }
    if !unread.is_empty() {
        let (shown, more) = unread.split_at(unread.len().min(LISTED.unread_columns));
        let mut names: Vec<Cow<str>> = shown.iter().map(Cow::from).collect();
        if !more.is_empty() {
            names.push(format!("{} more", more.len()).into());
        }
        let advice = format!(
            "look at what the data have and the model does not read: {}",
            listed(&names)
        );
        return (advice, stated.and_then(|e| as_inputs(e, shown)));
    }
    let look = "look for an input or a state that is not measured";
    if target.der > 1 {
        return (
            format!("{look}, such as a motor that lags or friction that sticks"),
            None,
        );
    }
    let var = model.name(Signal::new(target.var));
    let advice = format!(
        "{look}; a hidden state acts like a higher order: compare with {var} of order {}",
        target.der + 1
    );
    (advice, None)
}

/// The lines that read columns as inputs of an equation, if their headers are names.
fn as_inputs(equation: &Equation, headers: &[String]) -> Option<Vec<String>> {
    let [header] = headers else { return None };
    let lines = vec![format!("input {header}"), equation.with(headers)];
    is_name(header).then_some(lines)
}

/// Inputs that no equation mentions: the samples have no column of them.
fn unused_inputs(model: &Model, read: &Samples) -> Vec<String> {
    let is_read = |id: u16| read.columns.iter().any(|c| c.signal.var == VarId(id));
    let inputs = (0u16..).zip(&model.vars);
    let unused = inputs.filter(|(id, v)| v.kind == VarKind::Input && !is_read(*id));
    unused.map(|(_, v)| v.name.clone()).collect()
}
