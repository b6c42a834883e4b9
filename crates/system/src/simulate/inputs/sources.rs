//! Sources of everything that equations mention and do not define: inputs, their derivatives, states without an
//! equation, parameters.
//!
//! In: a record and a form. Out: a source for each input, a number for each parameter, and notes on what was assumed.

use std::cell::RefCell;

use crate::discovery::{Discovery, Form};
use crate::simulate::diagnostics as refuse;
use crate::simulate::initial_state::candidates;
use crate::simulate::inputs::interpolation::{InputSource, SampledInput};
use sidc_data::{Dataset, Trajectory};
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::model::{Between, Model, VarKind};
use sidc_lang::term::Signal;

/// The inputs of a system along one record.
pub(crate) struct Inputs {
    /// In the order of the form.
    pub inputs: Vec<InputSource>,
    /// In the order of the form.
    pub params: Vec<f64>,
    /// Samples, not delayed, of variables that lags refer to.
    lagged: Vec<(Signal, InputSource)>,
}

impl Inputs {
    /// The samples that lags of this variable refer to.
    pub fn lagged(&self, s: Signal) -> InputSource {
        let found = self.lagged.iter().find(|(of, _)| *of == s);
        found.map_or(InputSource::Rest, |(_, drive)| drive.clone())
    }
}

/// # Errors
/// A signal that is neither measured nor derivable.
pub(crate) fn input_sources(
    d: &Discovery,
    model: &Model,
    record: &Dataset,
    form: &Form,
    notes: &mut Vec<Diagnostic>,
) -> Result<Inputs, Diagnostic> {
    let Some(t) = record.trajectories.first() else {
        return Err(refuse::no_rows());
    };
    let find = Find {
        d,
        model,
        record,
        trajectory: t,
        driven: RefCell::default(),
    };
    let inputs = form.inputs.iter();
    let inputs: Result<Vec<InputSource>, Diagnostic> =
        inputs.map(|s| find.drive(*s, notes)).collect();
    let inputs = inputs?;
    if !find.driven.borrow().is_empty() {
        notes.push(refuse::driven(d, &find.driven.borrow()));
    }
    let mut params = Vec::new();
    for s in &form.params {
        let value = t.column(*s).and_then(|c| c.iter().find(|v| v.is_finite()));
        params.push(*value.ok_or_else(|| refuse::no_drive(d, *s))?);
    }
    let mut lagged = Vec::new();
    for s in form.history.iter().map(|s| Signal::new(s.var)) {
        if !form.state.contains(&s) && !lagged.iter().any(|(of, _)| *of == s) {
            lagged.push((s, find.drive(s, notes)?));
        }
    }
    notes.dedup();
    Ok(Inputs {
        inputs,
        params,
        lagged,
    })
}

struct Find<'a> {
    d: &'a Discovery,
    model: &'a Model,
    record: &'a Dataset,
    trajectory: &'a Trajectory,
    /// States without an equation, whose measurements act as inputs.
    driven: RefCell<Vec<Signal>>,
}

impl Find<'_> {
    fn drive(
        &self,
        signal: Signal,
        notes: &mut Vec<Diagnostic>,
    ) -> Result<InputSource, Diagnostic> {
        let s = Signal { shift: 0, ..signal };
        let input = self.d.variable_of(s.var).map(|v| v.kind) == Some(VarKind::Input);
        if let Some(samples) = self.trajectory.column(s) {
            if !input {
                self.driven.borrow_mut().push(s);
            }
            let course = self.course(s, samples, notes);
            return course.map(InputSource::SampledInput);
        }
        let base = Signal::new(s.var);
        let below = self.trajectory.column(base);
        match below {
            Some(samples) if input => {
                // A note on the input itself was or will be given with that input.
                let course = self.course(base, samples, &mut Vec::new())?;
                let held = self.record.between(s.var) == Some(Between::Hold);
                notes.push(refuse::input_slope(self.d, s, held));
                Ok(match (held, s.der) {
                    (false, 1) => InputSource::Slope(course),
                    _ => InputSource::Rest,
                })
            }
            _ => {
                let estimated = candidates::series(self.model, self.record, s);
                let (samples, _) = estimated.ok_or_else(|| refuse::no_drive(self.d, s))?;
                self.driven.borrow_mut().push(s);
                let course = self.course(s, &samples, &mut Vec::new());
                course.map(InputSource::SampledInput)
            }
        }
    }

    fn course(
        &self,
        s: Signal,
        samples: &[f64],
        notes: &mut Vec<Diagnostic>,
    ) -> Result<SampledInput, Diagnostic> {
        let between = match self.record.between_samples(s) {
            Between::Linear if self.d.runs_along_cubics(s.var) => Between::Cubic,
            between => between,
        };
        let late = self.d.input_delay(s.var);
        let time = &self.trajectory.time;
        let course = SampledInput::new(time, samples, between, late);
        let course = course.ok_or_else(|| refuse::no_drive(self.d, s))?;
        if course.missing > 0 {
            let held = between == Between::Hold || self.d.discrete;
            notes.push(refuse::missing(self.d, s, course.missing, held));
        }
        if late != 0.0 {
            notes.push(refuse::late(self.d, s, late));
        }
        Ok(course)
    }
}

/// Typical size of a signal: its largest reading, or the largest difference quotient of the signal below it.
pub(crate) fn size((d, t): (&Discovery, &Trajectory), s: Signal) -> f64 {
    if let Some((mean, deviation)) = d.hidden_course(s) {
        let size = mean.abs().max(deviation);
        return if size > 0.0 { size } else { 1.0 };
    }
    let largest = |v: &[f64]| {
        let finite = v.iter().filter(|v| v.is_finite());
        finite.fold(0.0, |m: f64, v| m.max(v.abs()))
    };
    let mut below = (0..=s.der).rev().map(|der| Signal { der, ..s });
    let found = below.find_map(|b| Some((b, t.column(b)?)));
    let Some((below, values)) = found else {
        return 1.0;
    };
    let mut values = values.to_vec();
    for _ in below.der..s.der {
        let slopes = values.windows(2).zip(t.time.windows(2));
        values = slopes.map(|(v, t)| (v[1] - v[0]) / (t[1] - t[0])).collect();
    }
    match largest(&values) {
        size if size > 0.0 => size,
        _ => 1.0,
    }
}
