//! What a simulation needs of a record, said as a model, so that the one binder reads it.
//!
//! In: a discovery, a model that declares its variables, the components of the start that are given. Out: that model with
//! nothing mentioned but what is read.

use crate::discover::{Discovery, Form};
use crate::lang::model::{Equation, Model, RightSide};
use crate::lang::source::{FileId, Span};
use crate::term::{Expr, Signal};

/// A model that binds what a simulation reads and no more: the discovery's inputs and parameters, and the states that start it,
/// but those whose start is `given`.
pub fn reads(d: &Discovery, model: &Model, given: &[(Signal, f64)]) -> Model {
    let form = Form::new(d);
    let nowhere = Span::new(FileId(0), 0, 0);
    let is_given = |s: &Signal| given.iter().any(|(g, _)| g == s);
    let states = form.state.iter().filter(|s| !is_given(s));
    let others = [&form.inputs, &form.params].into_iter().flatten();
    // Lags of states reach before any start.
    let lags = form.history.iter().map(|s| Signal::new(s.var));
    let plain = states.chain(others).map(|s| Signal { shift: 0, ..*s });
    let wanted = plain.chain(lags).map(|target| Equation {
        target,
        target_span: nowhere,
        span: nowhere,
        right: RightSide::Known(Expr::zero()),
    });
    Model {
        equations: wanted.collect(),
        ..model.clone()
    }
}
