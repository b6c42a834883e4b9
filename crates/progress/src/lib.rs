//! How long work is watched, and ended early.
//!
//! Whoever works tells an [`Observer`] what is being done, often and cheaply. The observer may draw a progress line, and may ask
//! for an early end. This crate knows no clocks, no signals of the operating system and no terminals; observers do.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

use std::ops::ControlFlow;
use std::time::Duration;

/// What is being done.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Activity<'a> {
    /// A signal is put together from the data, its derivatives estimated.
    Preparing { signal: &'a str },
    /// Work on the equation at this place in the model begins or goes on; counted from 0.
    Equation { place: usize, stage: Stage },
    /// The same for the equation at hand, from a part that does not know which one that is: a solver, the check of a proof.
    Stage(Stage),
    /// Equations run along a record and have reached this time, in units of the model.
    Running { time: f64 },
    /// What was said last goes on. Said so often that an early end takes effect soon.
    Working,
}

/// What is done for one equation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stage {
    /// Its library is evaluated on the data.
    Evaluating,
    /// The solver looks for the terms.
    Solving(SolverProgress),
    /// The criterion chooses among the terms proposed.
    Choosing,
    /// How many sets of terms were fitted with their trajectory.
    Refitting(usize),
    /// It is verified: columns done, and columns in all.
    Verifying(usize, usize),
    /// Fits of so many terms are looked for or excluded; nodes of the search that are done.
    Proving { terms: usize, nodes: usize },
    /// Its identifiability and uncertainty are computed.
    Weighing,
}

impl Stage {
    /// What is done, in words for people; without figures.
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

/// How far a solver is; a figure of zero is one that it does not know.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolverProgress {
    /// Rounds of a growing working set, from 1; 0 where every column is looked at from the start.
    pub round: usize,
    pub iteration: usize,
    /// Relative duality gap on the columns looked at.
    pub gap: f64,
    /// ‖Φa − y‖₂/‖y‖
    pub residual: f64,
    /// How far the worst of all columns exceeds |φ_jᵀλ| ≤ ‖φ_j‖, when they were last priced; 0 before.
    pub violation: f64,
}

impl SolverProgress {
    /// Told by a solver after every iteration.
    pub fn tell(self, observer: &mut dyn Observer) -> ControlFlow<Stop> {
        observer.hear(Activity::Stage(Stage::Solving(self)))
    }
}

/// Why work ends early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The user asked for it.
    Interrupted,
    /// The time limit was reached.
    TimeLimit(Duration),
}

/// Is told what is being done, and may end it.
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
    /// `Break` asks the work to end with what there is.
    fn hear(&mut self, activity: Activity) -> ControlFlow<Stop>;

    /// Whether work that has nothing new to tell may go on.
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

/// Hears nothing and ends nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unwatched;

impl Observer for Unwatched {
    fn hear(&mut self, _: Activity) -> ControlFlow<Stop> {
        ControlFlow::Continue(())
    }
}

/// Tells an observer of the equation at hand, and remembers a stop, so that it is not asked again.
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

    /// From here on, stages belong to the equation at this place.
    pub fn turn_to(&mut self, place: usize) {
        self.place = place;
    }

    /// Reports a stage; `Some` if the work is to stop.
    pub fn at(&mut self, stage: Stage) -> Option<Stop> {
        self.hear(Activity::Stage(stage)).break_value()
    }

    /// For work that belongs to this stage and does not say so itself.
    pub fn during(&mut self, stage: Stage) -> &mut Self {
        self.stage = stage;
        self
    }

    /// For work that may be ended while the rest goes on: an end that it is asked for is not remembered.
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
