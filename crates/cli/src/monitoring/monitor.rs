//! Progress line, stage times and limits of a command in one place.
//!
//! In: how much output the user wants, and what is being done. Out: lines on standard error, and whether to go on.

use std::ops::ControlFlow;
use std::time::Duration;

use super::limits::Limits;
use super::progress_line::{ProgressLine, Work};
use super::stage_times::StageTimes;
use super::verbosity::{Notes, Verbosity};
use sidc::{Activity, Budget, Observer, Stage, Stop};
use sidc_lang::model::Model;
use sidc_lang::term::SignalNames;

/// Watches one command.
pub struct Monitor {
    pub notes: Notes,
    pub stages: StageTimes,
    /// Time budget for the proofs of all equations.
    pub proving: Budget,
    shows_progress: bool,
    limits: Limits,
}

impl Monitor {
    /// Starts the clock.
    pub fn start(verbosity: &Verbosity, time_limit: Option<Duration>) -> Self {
        Monitor {
            notes: verbosity.notes(),
            stages: StageTimes::start(verbosity.verbose),
            proving: Budget::of(None),
            shows_progress: !verbosity.quiet,
            limits: Limits::start(time_limit),
        }
    }

    /// For commands without verbosity options: all notes, a progress line, no limit.
    pub fn plain() -> Self {
        Monitor {
            notes: Notes::Full,
            stages: StageTimes::start(false),
            proving: Budget::of(None),
            shows_progress: true,
            limits: Limits::start(None),
        }
    }

    /// From now on the first Ctrl-C asks the work to stop, and the second ends the process.
    pub fn listen(&self) {
        self.limits.listen();
    }

    /// True once the work must stop.
    pub fn must_stop(&self) -> bool {
        self.limits.check().is_break()
    }

    pub fn progress_line(&self) -> ProgressLine {
        ProgressLine::start(self.shows_progress, self.limits.clock())
    }

    /// An observer of the work on a model, with a progress line of its own.
    pub fn observer<'a>(&'a self, model: &'a Model) -> ModelObserver<'a> {
        ModelObserver {
            monitor: self,
            line: self.progress_line(),
            model,
        }
    }

    /// Shows the time reached by a free run along a record.
    pub fn free_run(&self, line: &ProgressLine, record: &str) -> impl Observer {
        move |activity: Activity| {
            if let Activity::Running { time } = activity {
                line.show(Work::Running {
                    record: record.into(),
                    time,
                });
            }
            self.limits.check()
        }
    }

    /// Checks the limits, and shows nothing.
    pub fn silent_observer(&self) -> impl Observer {
        |_: Activity| self.limits.check()
    }
}

/// Shows the work on the equations of a model, and stops it at the limits.
pub struct ModelObserver<'a> {
    monitor: &'a Monitor,
    line: ProgressLine,
    model: &'a Model,
}

impl Observer for ModelObserver<'_> {
    fn hear(&mut self, activity: Activity) -> ControlFlow<Stop> {
        match activity {
            Activity::Preparing { signal } => self.line.show(Work::Preparing {
                signal: signal.into(),
            }),
            Activity::Equation { place, stage } => {
                let equation = self.model.equations.get(place);
                let target = equation.map_or_else(String::new, |e| self.model.name(e.target));
                self.monitor.stages.equation(stage, &target);
                self.line.show(Work::Equation {
                    place,
                    equations: self.model.equations.len(),
                    target,
                    stage,
                });
                let proves = matches!(stage, Stage::Proving { .. });
                // Each equation gets its share of the time, plus what earlier ones left over.
                let part = (place + 1) as f64 / self.model.equations.len().max(1) as f64;
                if let Some(stop) = self.monitor.proving.spent(proves, part) {
                    return ControlFlow::Break(stop);
                }
            }
            Activity::Running { time } => self.line.show(Work::Running {
                record: "the data".into(),
                time,
            }),
            _ => {}
        }
        self.monitor.limits.check()
    }
}
