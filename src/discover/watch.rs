//! Who is told what a discovery is at and may end it early, and what is then said of the equations it had no time for.
//!
//! In: steps of the work. Out: go on, or stop and why. It knows no clocks and no signals of the system; the caller does.

use std::ops::ControlFlow;
use std::time::Duration;

use super::{Discovery, Equation, Reason, Status};
use crate::solve::{Monitor, Progress};

/// What is done for one equation.
#[derive(Clone, Copy, Debug)]
pub enum Stage {
    /// Its library is evaluated on the data.
    Evaluating,
    /// The solver looks for the terms.
    Solving(Progress),
    /// The criterion chooses among the terms proposed.
    Choosing,
    /// So many sets of terms were fitted with their trajectory.
    Refitting(usize),
    /// It is checked once more: so many columns of so many.
    Verifying(usize, usize),
    /// What the data say of the answer is weighed.
    Weighing,
}

/// A stage of the equation with this place in the model, from 0.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    pub equation: usize,
    pub stage: Stage,
}

/// Why work ends early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The user asked for it.
    Interrupted,
    /// The run took as long as it may.
    TimeLimit(Duration),
}

/// Told before each stage and after every iteration; `Break` ends the work, with what there is.
pub type Watch<'a> = &'a mut dyn FnMut(Step) -> ControlFlow<Stop>;

impl Stop {
    fn code(self) -> &'static str {
        match self {
            Stop::Interrupted => "interrupted",
            Stop::TimeLimit(_) => "time-limit",
        }
    }

    fn cause(self) -> String {
        match self {
            Stop::Interrupted => "interrupted".into(),
            Stop::TimeLimit(limit) => {
                format!("stopped by the time limit of {} s", limit.as_secs_f64())
            }
        }
    }

    /// The doubt of an equation that was cut short.
    pub(super) fn doubt(self) -> Reason {
        let text = format!(
            "{} before the search was through; this is the best there was",
            self.cause()
        );
        Reason::new(self.code(), text)
    }

    /// The doubt of an equation that was to be checked once more.
    pub fn unverified(self) -> Reason {
        let text = format!("{} before the equation was verified", self.cause());
        Reason::new(self.code(), text)
    }

    /// The doubt of an equation whose evidence there was no time for.
    fn unweighed(self) -> Reason {
        let text = format!(
            "{} before the evidence was weighed; what the data tell apart is not known",
            self.cause()
        );
        Reason::new(self.code(), text)
    }

    /// The failure of an equation that was not come to.
    pub(super) fn failure(self) -> Reason {
        let text = format!("{} before there was an answer", self.cause());
        Reason::new(self.code(), text)
    }
}

/// Doubts every equation from `first` on that was found, and whose evidence nobody weighed because of the stop.
pub fn unweighed(d: &mut Discovery, first: usize, stop: Stop) {
    for e in d.equations.iter_mut().skip(first) {
        if e.status != Status::Known && !e.was_stopped() {
            e.status = Status::Doubt;
            e.reasons.push(stop.unweighed());
        }
    }
}

impl Equation {
    /// Whether the work on it was ended early: whoever says stop does not want to wait.
    pub fn was_stopped(&self) -> bool {
        self.reasons.iter().any(is_stop)
    }
}

impl Discovery {
    /// Whether the work on any equation was.
    pub fn was_stopped(&self) -> bool {
        let failed = self.failed.iter().flat_map(|f| &f.reasons);
        failed
            .chain(self.equations.iter().flat_map(|e| &e.reasons))
            .any(is_stop)
    }
}

fn is_stop(reason: &Reason) -> bool {
    ["interrupted", "time-limit"].contains(&reason.code.as_str())
}

/// A watch on one discovery, that remembers the answer: whoever said stop is not asked again.
pub(super) struct Watcher<'a> {
    watch: Watch<'a>,
    equation: usize,
    stop: Option<Stop>,
}

impl<'a> Watcher<'a> {
    pub fn new(watch: Watch<'a>) -> Self {
        Watcher {
            watch,
            equation: 0,
            stop: None,
        }
    }

    /// From here on the work is for the equation with this place.
    pub fn turn_to(&mut self, equation: usize) {
        self.equation = equation;
    }

    /// Tells of a stage; `Some` if the work is to stop.
    pub fn at(&mut self, stage: Stage) -> Option<Stop> {
        if self.stop.is_none() {
            let equation = self.equation;
            self.stop = (self.watch)(Step { equation, stage }).break_value();
        }
        self.stop
    }

    /// Runs a solver, or whatever takes a monitor, under this watch.
    pub fn solving<T>(&mut self, run: impl FnOnce(Monitor) -> T) -> T {
        run(&mut |progress| match self.at(Stage::Solving(progress)) {
            Some(_) => ControlFlow::Break(()),
            None => ControlFlow::Continue(()),
        })
    }

    pub fn stop(&self) -> Option<Stop> {
        self.stop
    }
}
