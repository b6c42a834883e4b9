//! Where everything comes from that equations mention and do not give: inputs, their derivatives, states without an equation,
//! parameters.
//!
//! In: the record, the form. Out: a drive for each input, a number for each parameter, notes on what was assumed.

use std::cell::RefCell;

use super::course::{Course, Drive};
use super::refusals as refuse;
use super::start;
use crate::data::{Dataset, Trajectory};
use crate::discover::{Discovery, Form};
use crate::lang::diagnostic::Diagnostic;
use crate::lang::model::{Between, Model, VarKind};
use crate::term::{Signal, SignalNames};

/// What drives a system along one record.
pub(super) struct Drives {
    /// In the order of the form.
    pub inputs: Vec<Drive>,
    /// In the order of the form.
    pub params: Vec<f64>,
    /// Undelayed samples of variables that lags refer to.
    lagged: Vec<(Signal, Drive)>,
}

impl Drives {
    /// Samples for a lag of this variable.
    pub fn lagged(&self, s: Signal) -> Drive {
        let found = self.lagged.iter().find(|(of, _)| *of == s);
        found.map_or(Drive::Rest, |(_, drive)| drive.clone())
    }
}

/// # Errors
/// A signal that is neither measured nor to be had from what is.
pub(super) fn drives(
    d: &Discovery,
    model: &Model,
    record: &Dataset,
    form: &Form,
    notes: &mut Vec<Diagnostic>,
) -> Result<Drives, Diagnostic> {
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
    let inputs: Result<Vec<Drive>, Diagnostic> = inputs.map(|s| find.drive(*s, notes)).collect();
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
    Ok(Drives {
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
    /// States without an equation.
    driven: RefCell<Vec<Signal>>,
}

impl Find<'_> {
    fn drive(&self, signal: Signal, notes: &mut Vec<Diagnostic>) -> Result<Drive, Diagnostic> {
        let s = Signal { shift: 0, ..signal };
        let input = self.d.variable_of(s.var).map(|v| v.kind) == Some(VarKind::Input);
        if let Some(samples) = self.trajectory.column(s) {
            if !input {
                self.driven.borrow_mut().push(s);
            }
            let course = self.course(s, samples, input, notes);
            return course.map(Drive::Course);
        }
        let base = Signal::new(s.var);
        let below = self.trajectory.column(base);
        match below {
            Some(samples) if input => {
                // The base's own note stands where the base is an input too.
                let course = self.course(base, samples, true, &mut Vec::new())?;
                let held = self.record.between(s.var) == Some(Between::Hold);
                notes.push(refuse::input_slope(self.d, s, held));
                Ok(match (held, s.der) {
                    (false, 1) => Drive::Slope(course),
                    _ => Drive::Rest,
                })
            }
            _ => {
                let estimated = start::series(self.model, self.record, s);
                let (samples, _) = estimated.ok_or_else(|| refuse::no_drive(self.d, s))?;
                self.driven.borrow_mut().push(s);
                let course = self.course(s, &samples, false, &mut Vec::new());
                course.map(Drive::Course)
            }
        }
    }

    fn course(
        &self,
        s: Signal,
        samples: &[f64],
        input: bool,
        notes: &mut Vec<Diagnostic>,
    ) -> Result<Course, Diagnostic> {
        let between = match self.record.between(s.var) {
            Some(between) if input && s.der == 0 => between,
            _ => Between::Linear,
        };
        let late = self.late(s);
        let time = &self.trajectory.time;
        let course = Course::new(time, samples, between, late);
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

    /// Seconds by which an input was found to act later than its record says.
    fn late(&self, s: Signal) -> f64 {
        if self.d.discrete {
            return 0.0;
        }
        let name = self.d.variable(s.var);
        let evidence = self.d.equations.iter().filter_map(|e| e.evidence.as_ref());
        let together = evidence.filter_map(|e| e.together.as_ref());
        let mut delays = together.flat_map(|t| &t.delays);
        let found = delays.find(|delay| delay.input == name);
        found.map_or(0.0, |delay| delay.seconds).clamp(-1e9, 1e9)
    }
}

/// The typical size of a signal along a record: its largest reading, or what the readings below it change by.
pub(super) fn size(t: &Trajectory, s: Signal) -> f64 {
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
