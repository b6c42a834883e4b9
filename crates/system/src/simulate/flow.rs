//! The right side ẋ = f(t, x) with its inputs, and the guard that limits an integration.

use crate::simulate::compiled::plant::{Plant, Workspace};
use crate::simulate::fault::FaultKind;
use crate::simulate::inputs::interpolation::InputSegment;
use crate::simulate::thresholds::EXPLICIT;
use sidc_lang::term::Signal;
use sidc_progress::{Activity, Observer};

/// Evaluations between two reports to the observer.
const CALLS_PER_CHECK: u64 = 2048;

/// The right side ẋ = f(t, x) along a stretch on which every input is a straight segment.
pub(super) struct Flow<'a> {
    pub plant: &'a Plant,
    pub work: Workspace,
    lines: Vec<InputSegment>,
    /// Inputs that vary along the stretch.
    moving: Vec<usize>,
}

impl<'a> Flow<'a> {
    /// `params` in the order of the form.
    pub fn new(plant: &'a Plant, params: &[f64]) -> Flow<'a> {
        let mut work = plant.work();
        let given: Vec<f64> = vec![0.0; plant.form.inputs.len()];
        plant.give(&mut work, &[&given, params].concat());
        Flow {
            plant,
            work,
            lines: Vec::new(),
            moving: Vec::new(),
        }
    }

    /// Sets the segments of the inputs from here on.
    pub fn drive(&mut self, lines: impl Iterator<Item = InputSegment>) {
        self.lines.clear();
        self.lines.extend(lines);
        self.moving.clear();
        for (i, line) in self.lines.iter().enumerate() {
            self.plant.give_one(&mut self.work, i, line.value);
            if line.slope != 0.0 {
                self.moving.push(i);
            }
        }
    }

    /// The present segments, in the order of the form.
    pub fn lines(&self) -> &[InputSegment] {
        &self.lines
    }

    #[inline]
    pub fn rates(&mut self, t: f64, x: &[f64], out: &mut [f64]) -> Result<(), FaultKind> {
        self.at(t);
        self.plant.rates(&mut self.work, t, x, out)
    }

    /// ∂ẋ/∂x, n × n by rows.
    pub fn jacobian(&mut self, t: f64, x: &[f64], out: &mut [f64]) -> Result<(), FaultKind> {
        self.at(t);
        self.plant.jacobian(&mut self.work, t, x, out)
    }

    /// Unknowns and outputs at a point.
    pub fn unknowns(&mut self, t: f64, x: &[f64]) -> Result<(&[f64], Vec<f64>), FaultKind> {
        self.at(t);
        self.plant.solve(&mut self.work, t, x)?;
        let outputs = self.plant.outputs(&mut self.work);
        Ok((&self.work.q, outputs))
    }

    #[inline]
    fn at(&mut self, t: f64) {
        for i in &self.moving {
            let value = self.lines[*i].at(t);
            self.plant.give_one(&mut self.work, *i, value);
        }
    }
}

/// Why integration ended, and when.
pub(super) type Ended = (FaultKind, f64);

/// Watches over a run: bounds of the state, evaluations, and the caller, who may stop it.
pub(super) struct Guard<'a> {
    /// Typical sizes of the state; tolerances are relative to them.
    pub sizes: Vec<f64>,
    /// Absolute values beyond which the state has diverged.
    pub bounds: Vec<f64>,
    pub names: Vec<Signal>,
    /// Evaluations that the run may take.
    pub budget: u64,
    /// Local error of an explicit step, of the state and its typical size.
    pub tolerance: f64,
    last_check: u64,
    observer: &'a mut dyn Observer,
}

impl<'a> Guard<'a> {
    pub fn new(
        sizes: Vec<f64>,
        bounds: Vec<f64>,
        names: Vec<Signal>,
        budget: u64,
        observer: &'a mut dyn Observer,
    ) -> Guard<'a> {
        Guard {
            sizes,
            bounds,
            names,
            budget,
            tolerance: EXPLICIT.tolerance,
            last_check: 0,
            observer,
        }
    }

    /// Called after a step: an error if the state has diverged, the budget is spent or the caller stops.
    pub fn check(&mut self, t: f64, x: &[f64], calls: u64) -> Result<(), Ended> {
        for ((x, bound), name) in x.iter().zip(&self.bounds).zip(&self.names) {
            if x.is_nan() || x.abs() > *bound {
                let signal = *name;
                let bound = *bound;
                return Err((FaultKind::Diverged { signal, bound }, t));
            }
        }
        if calls > self.budget {
            return Err((FaultKind::TooMuchWork, t));
        }
        if calls >= self.last_check + CALLS_PER_CHECK || calls < self.last_check {
            self.last_check = calls;
            if self.observer.hear(Activity::Running { time: t }).is_break() {
                return Err((FaultKind::Stopped, t));
            }
        }
        Ok(())
    }
}
