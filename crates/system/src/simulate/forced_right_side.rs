//! The right side ẋ = f(t, x) with its inputs, and the guard that limits an integration.

use crate::simulate::compiled::compiled_system::{CompiledSystem, Workspace};
use crate::simulate::fault::FaultKind;
use crate::simulate::inputs::interpolation::InputSegment;
use crate::simulate::thresholds::EXPLICIT;
use crate::switching::thresholds::SWITCHING;
use sidc_lang::term::Signal;
use sidc_progress::{Activity, Observer};

/// Evaluations between two reports to the observer.
const CALLS_PER_CHECK: u64 = 2048;

/// The right side ẋ = f(t, x) along a stretch on which every input is one segment.
pub(super) struct ForcedRightSide<'a> {
    pub system: &'a CompiledSystem,
    pub work: Workspace,
    segments: Vec<InputSegment>,
    /// Inputs that vary along the stretch.
    moving: Vec<usize>,
    /// Sizes of the guards of all switches; empty where none is.
    guard_sizes: Vec<f64>,
    /// Margins of all switches, and their rates, where the present step begins.
    pub(super) margins: Vec<f64>,
    pub(super) margin_rates: Vec<f64>,
    /// Events since time last moved.
    events_at_once: usize,
}

impl<'a> ForcedRightSide<'a> {
    /// `params` in the order of the form.
    pub fn new(system: &'a CompiledSystem, params: &[f64]) -> ForcedRightSide<'a> {
        let mut work = system.work();
        work.is_pinned = true;
        let given: Vec<f64> = vec![0.0; system.form.inputs.len()];
        system.give(&mut work, &[&given, params].concat());
        ForcedRightSide {
            system,
            work,
            segments: Vec::new(),
            moving: Vec::new(),
            guard_sizes: Vec::new(),
            margins: Vec::new(),
            margin_rates: Vec::new(),
            events_at_once: 0,
        }
    }

    /// Sets the segments of the inputs from here on.
    pub fn set_inputs(&mut self, segments: impl Iterator<Item = InputSegment>) {
        self.segments.clear();
        self.segments.extend(segments);
        self.moving.clear();
        for (i, segment) in self.segments.iter().enumerate() {
            self.system.give_one(&mut self.work, i, segment.value);
            self.work.input_slopes[i] = segment.slope;
            if segment.moves() {
                self.moving.push(i);
            }
        }
    }

    /// The present segments, in the order of the form.
    pub fn inputs(&self) -> &[InputSegment] {
        &self.segments
    }

    #[inline]
    pub fn rates(&mut self, t: f64, x: &[f64], out: &mut [f64]) -> Result<(), FaultKind> {
        self.at(t);
        self.system.rates(&mut self.work, t, x, out)
    }

    /// ∂ẋ/∂x, n × n by rows.
    pub fn jacobian(&mut self, t: f64, x: &[f64], out: &mut [f64]) -> Result<(), FaultKind> {
        self.at(t);
        self.system.jacobian(&mut self.work, t, x, out)
    }

    /// Unknowns and outputs at a point.
    pub fn unknowns(&mut self, t: f64, x: &[f64]) -> Result<(&[f64], Vec<f64>), FaultKind> {
        self.at(t);
        self.system.solve(&mut self.work, t, x)?;
        let outputs = self.system.outputs(&mut self.work);
        Ok((&self.work.q, outputs))
    }

    /// Whether a law switches along the way.
    pub fn has_switches(&self) -> bool {
        self.system.has_switches()
    }

    /// Sets the side of every switch after the inputs or the state jumped, or after `events`. Where the inputs, or a jump of the states,
    /// make the condition of another jump true, the states jump there too. `sizes`: typical sizes of the states; `jumped`: switches whose
    /// jump is done: they jump again only after another.
    pub fn settle(
        &mut self,
        (t, x): (f64, &mut [f64]),
        sizes: &[f64],
        (mut events, mut jumped): (Vec<usize>, Vec<usize>),
    ) -> Result<(), FaultKind> {
        if !self.has_switches() {
            return Ok(());
        }
        self.at(t);
        let (system, work) = (self.system, &mut self.work);
        if self.guard_sizes.is_empty() {
            self.guard_sizes = system.guard_sizes(work, x, sizes);
        }
        let sizes = &self.guard_sizes;
        for _ in 0..SWITCHING.at_once {
            system.open_contacts(work, (t, &*x), sizes);
            let before = work.modes.clone();
            let contacts = system.settle(work, (t, &mut *x), sizes, &events)?;
            events = system.left_sides(work, &before, &contacts);
            events.retain(|k| !jumped.contains(k));
            if events.is_empty() {
                return self.begin_step(t, x);
            }
            events.iter().for_each(|k| work.modes.0[*k] = before.0[*k]);
            jumped = system.reset(work, (t, &mut *x), sizes, &mut events)?;
        }
        Err(FaultKind::JumpsAccumulate)
    }

    /// Passes an event: lets the states jump, and settles the sides at `x`. If no side changes although the step from there to `end` crosses
    /// a guard right at its start, the switches take the side beyond the guard.
    pub fn pass_event(
        &mut self,
        (t, x): (f64, &mut [f64]),
        sizes: &[f64],
        (part, switches, end): (f64, &[usize], &[f64]),
    ) -> Result<(), FaultKind> {
        let before = self.work.modes.clone();
        let sides = self.work.sides.clone();
        if part > SWITCHING.located {
            self.events_at_once = 0;
        }
        self.events_at_once += 1;
        self.at(t);
        let (system, work) = (self.system, &mut self.work);
        let mut events = switches.to_vec();
        let jumped = system.reset(work, (t, &mut *x), &self.guard_sizes, &mut events)?;
        let jumps = !jumped.is_empty();
        if self.events_at_once > SWITCHING.at_once {
            return Err(match jumps {
                true => FaultKind::JumpsAccumulate,
                false => FaultKind::StepTooSmall,
            });
        }
        self.settle((t, x), sizes, (events, jumped))?;
        if part == 0.0 && !jumps && self.work.modes == before {
            self.system.cross(&mut self.work, (switches, &sides), end);
            self.begin_step(t, x)?;
        }
        Ok(())
    }

    /// Notes the margins at the start of a step.
    pub fn begin_step(&mut self, t: f64, x: &[f64]) -> Result<(), FaultKind> {
        let mut margins = std::mem::take(&mut self.margins);
        let found = self.margins(t, x, &mut margins);
        self.margins = margins;
        let mut rates = std::mem::take(&mut self.margin_rates);
        self.system.margin_rates(&self.work, &mut rates);
        self.margin_rates = rates;
        found
    }

    /// Margins of all switches at a point.
    pub fn margins(&mut self, t: f64, x: &[f64], out: &mut Vec<f64>) -> Result<(), FaultKind> {
        self.at(t);
        for i in &self.moving {
            self.work.input_slopes[*i] = self.segments[*i].slope_at(t);
        }
        self.system.margins(&mut self.work, t, x, out)
    }

    /// The rates of the margins where they were last evaluated.
    pub fn margin_rates(&self, out: &mut Vec<f64>) {
        self.system.margin_rates(&self.work, out);
    }

    #[inline]
    fn at(&mut self, t: f64) {
        for i in &self.moving {
            let value = self.segments[*i].at(t);
            self.system.give_one(&mut self.work, *i, value);
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
