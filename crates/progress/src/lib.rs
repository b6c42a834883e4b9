//! Observation of long work, and its early end.
//!
//! The work tells an [`Observer`] what is being done, often and cheaply. The observer may draw a progress line, and may ask for an early end. This crate uses
//! no clocks, signals of the operating system or terminals; observers may.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

use std::ops::ControlFlow;
use std::time::Duration;

/// What is being done.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Activity<'a> {
    /// A signal is assembled from the data, and its derivatives are estimated.
    Preparing { signal: &'a str },
    /// Work on the equation with this index in the model starts or continues.
    Equation { place: usize, stage: Stage },
    /// As [`Activity::Equation`] for the current equation, from a part that does not know which one that is: a solver, the check of a proof.
    Stage(Stage),
    /// The equations are run along a record, up to this time so far, in the model's unit.
    Running { time: f64 },
    /// The last activity continues. Sent often enough that a stop takes effect soon.
    Working,
}

/// The stage of work on one equation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stage {
    /// Its library is evaluated on the data.
    Evaluating,
    /// The solver looks for the terms.
    Solving(SolverProgress),
    /// The criterion chooses among the terms proposed.
    Choosing,
    /// Trajectories are fitted together with sets of terms; the number of sets so far.
    Refitting(usize),
    /// It is verified: columns done, and columns in total.
    Verifying(usize, usize),
    /// Fits with this number of terms are searched for or excluded; `nodes` of the search are done.
    Proving { terms: usize, nodes: usize },
    /// Its identifiability and uncertainty are computed.
    Weighing,
}

impl Stage {
    /// The stage in words for users, without figures.
    pub fn words(self) -> &'static str {
        match self {
            Stage::Evaluating => "evaluating the library",
            Stage::Solving(_) => "solving",
            Stage::Choosing => "choosing the terms",
            Stage::Refitting(_) => "trajectory and terms together",
            Stage::Verifying(..) => "verifying",
            Stage::Proving { .. } => "proving the fewest terms",
            Stage::Weighing => "weighing the evidence",
        }
    }
}

/// How far a solver is; zero stands for an unknown number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolverProgress {
    /// Rounds of a growing working set, from 1; 0 if all columns are used from the start.
    pub round: usize,
    pub iteration: usize,
    /// Relative duality gap on the working set.
    pub gap: f64,
    /// ‖Φa − y‖₂/‖y‖
    pub residual: f64,
    /// Largest excess over |φ_jᵀλ| ≤ ‖φ_j‖ among all columns when they were last priced; 0 before.
    pub violation: f64,
}

impl SolverProgress {
    /// A solver calls this after every iteration.
    pub fn tell(self, observer: &mut dyn Observer) -> ControlFlow<Stop> {
        observer.hear(Activity::Stage(Stage::Solving(self)))
    }
}

/// Why work ends early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The user interrupted it.
    Interrupted,
    /// The time limit was reached.
    TimeLimit(Duration),
}

/// Hears what is being done, and may end it.
///
/// A closure is an observer:
///
/// ```
/// use std::ops::ControlFlow;
/// use sidc_progress::{Activity, Observer, Stop};
///
/// let mut signals = 0;
/// let mut observer = |activity: Activity| {
///     signals += usize::from(matches!(activity, Activity::Preparing { .. }));
///     ControlFlow::<Stop>::Continue(())
/// };
/// assert!(observer.hear(Activity::Preparing { signal: "dx" }).is_continue());
/// assert_eq!(signals, 1);
/// ```
pub trait Observer {
    /// `Break` asks the work to end with what it has so far.
    fn hear(&mut self, activity: Activity) -> ControlFlow<Stop>;

    /// Whether to continue; for work without news.
    fn go_on(&mut self) -> bool {
        self.hear(Activity::Working).is_continue()
    }
}

impl<F> Observer for F
where
    F: FnMut(Activity) -> ControlFlow<Stop>,
{
    fn hear(&mut self, activity: Activity) -> ControlFlow<Stop> {
        self(activity)
    }
}

/// Ignores all activities and never ends the work.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unwatched;

impl Observer for Unwatched {
    fn hear(&mut self, _: Activity) -> ControlFlow<Stop> {
        ControlFlow::Continue(())
    }
}

/// Passes activities of the current equation to an observer, and remembers a stop, so that the observer is not asked again.
pub struct EquationObserver<'a> {
    observer: &'a mut dyn Observer,
    place: usize,
    stage: Stage,
    stop: Option<Stop>,
}

impl<'a> EquationObserver<'a> {
    pub fn new(observer: &'a mut dyn Observer) -> Self {
        EquationObserver {
            observer,
            place: 0,
            stage: Stage::Evaluating,
            stop: None,
        }
    }

    /// From now on, stages belong to the equation with this index.
    pub fn set_equation(&mut self, place: usize) {
        self.place = place;
    }

    /// Reports a stage; `Some` if the work must stop.
    pub fn at(&mut self, stage: Stage) -> Option<Stop> {
        self.hear(Activity::Stage(stage)).break_value()
    }

    /// For work that belongs to this stage but does not report it.
    pub fn during(&mut self, stage: Stage) -> &mut Self {
        self.stage = stage;
        self
    }

    /// For work that may be stopped while the rest continues: its stop is not remembered.
    pub fn aside(&mut self) -> impl Observer {
        let place = self.place;
        let (observer, stop) = (&mut *self.observer, self.stop);
        let mut stage = self.stage;
        move |activity: Activity| {
            if let Activity::Stage(now) = activity {
                stage = now;
            }
            match stop {
                Some(stop) => ControlFlow::Break(stop),
                None => observer.hear(Activity::Equation { place, stage }),
            }
        }
    }

    pub fn stop(&self) -> Option<Stop> {
        self.stop
    }
}

impl Observer for EquationObserver<'_> {
    fn hear(&mut self, activity: Activity) -> ControlFlow<Stop> {
        if let Activity::Stage(stage) = activity {
            self.stage = stage;
        }
        if self.stop.is_none() {
            let (place, stage) = (self.place, self.stage);
            let said = self.observer.hear(Activity::Equation { place, stage });
            self.stop = said.break_value();
        }
        self.stop
            .map_or(ControlFlow::Continue(()), ControlFlow::Break)
    }
}
