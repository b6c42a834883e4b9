//! What a simulation reads of a record, expressed as a model.
//!
//! In: a discovery, the model that declares its variables, the initial values that are given. Out: that model, reduced
//! to the signals that are read, for the code that binds data to models.

use crate::discovery::{Discovery, Form};
use sidc_lang::model::{Equation, Model, RightSide};
use sidc_lang::source::{FileId, Span};
use sidc_lang::term::{Expr, Signal};

/// A model that mentions what a simulation reads and no more: inputs, parameters, and the states whose initial value
/// is not `given`.
pub fn reads(d: &Discovery, model: &Model, given: &[(Signal, f64)]) -> Model {
    let form = Form::new(d);
    let nowhere = Span::new(FileId(0), 0, 0);
    let is_given = |s: &Signal| given.iter().any(|(g, _)| g == s);
    let read = |s: &&Signal| !is_given(s) && !d.is_hidden(**s);
    let states = form.state.iter().filter(read);
    let others = [&form.inputs, &form.params].into_iter().flatten();
    // Lags of states reach back before the start.
    let lags = form.history.iter().map(|s| Signal::new(s.var));
    let plain = states.chain(others).map(|s| Signal { shift: 0, ..*s });
    let wanted = plain.chain(lags).map(|target| Equation {
        target,
        target_span: nowhere,
        span: nowhere,
        written: String::new(),
        right: RightSide::Known(Expr::zero()),
    });
    Model {
        equations: wanted.collect(),
        ..model.clone()
    }
}
