//! Progress and interruption: the caller hears of every step and may stop the work; equations that were cut short are doubted.
//!
//! In: steps of the work. Out: go on, or stop and why. Never reads a clock or a signal of the system; the caller does.

use std::ops::ControlFlow;

use sidc_progress::{Stage, Stop};
use sidc_solve::Monitor;
use sidc_system::discovery::{Discovery, Reason, ReasonCode, Status};

/// A stage of one equation, given by its place in the model, from 0.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    pub equation: usize,
    pub stage: Stage,
}

/// Called before each stage and after every iteration. `Break` ends the work with what was found so far.
pub type Watch<'a> = &'a mut dyn FnMut(Step) -> ControlFlow<Stop>;

/// The doubt of an equation that was cut short.
pub(crate) fn doubt(stop: Stop) -> Reason {
    reason(
        stop,
        "before the search was through; this is the best there was",
    )
}

/// The doubt of an equation that was not verified in time.
pub fn unverified(stop: Stop) -> Reason {
    reason(stop, "before the equation was verified")
}

/// The failure of an equation that was not reached.
pub(crate) fn failure(stop: Stop) -> Reason {
    reason(stop, "before there was an answer")
}

fn reason(stop: Stop, before: &str) -> Reason {
    match stop {
        Stop::Interrupted => Reason::new(ReasonCode::Interrupted, format!("interrupted {before}")),
        Stop::TimeLimit(limit) => {
            let limit = limit.as_secs_f64();
            let text = format!("stopped by the time limit of {limit} s {before}");
            Reason::new(ReasonCode::TimeLimit, text)
        }
    }
}

/// Doubts every found equation from place `first` on: its evidence was not computed because of the stop.
pub fn unweighed(d: &mut Discovery, first: usize, stop: Stop) {
    for e in d.equations.iter_mut().skip(first) {
        if e.status != Status::Known && !e.was_stopped() {
            e.status = Status::Doubt;
            e.reasons.push(reason(
                stop,
                "before the evidence was weighed; what the data tell apart is not known",
            ));
        }
    }
}

/// A watch that remembers a stop, so that the caller is not called again.
pub(crate) struct Watcher<'a> {
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

    /// From here on, steps belong to the equation at this place.
    pub fn turn_to(&mut self, equation: usize) {
        self.equation = equation;
    }

    /// Reports a stage; `Some` if the work is to stop.
    pub fn at(&mut self, stage: Stage) -> Option<Stop> {
        if self.stop.is_none() {
            let equation = self.equation;
            self.stop = (self.watch)(Step { equation, stage }).break_value();
        }
        self.stop
    }

    /// Runs a solver under this watch.
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
