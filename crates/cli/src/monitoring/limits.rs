//! When a run must stop: at its time limit or on Ctrl-C.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::interrupts;
use sidc::Stop;

/// The start of a run, and how long it may take.
#[derive(Clone, Copy)]
pub struct Clock {
    pub start: Instant,
    pub limit: Option<Duration>,
}

/// The time limit and Ctrl-C.
pub struct Limits {
    clock: Clock,
    interrupted: Arc<AtomicBool>,
}

impl Limits {
    /// Starts the clock.
    pub fn start(limit: Option<Duration>) -> Self {
        Limits {
            clock: Clock {
                start: Instant::now(),
                limit,
            },
            interrupted: Arc::default(),
        }
    }

    /// From now on the first Ctrl-C asks the work to stop, and the second ends the process.
    pub fn listen(&self) {
        interrupts::raise(&self.interrupted);
    }

    pub fn clock(&self) -> Clock {
        self.clock
    }

    /// `Break` with the reason once the work must stop.
    pub fn check(&self) -> ControlFlow<Stop> {
        if self.interrupted.load(Ordering::Relaxed) {
            return ControlFlow::Break(Stop::Interrupted);
        }
        match self.clock.limit {
            Some(limit) if self.clock.start.elapsed() >= limit => {
                ControlFlow::Break(Stop::TimeLimit(limit))
            }
            _ => ControlFlow::Continue(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_that_has_passed_stops_and_none_never_does() {
        let none = Limits::start(None);
        assert!(none.check().is_continue());
        let passed = Duration::from_nanos(1);
        let limits = Limits::start(Some(passed));
        std::thread::sleep(Duration::from_millis(1));
        assert_eq!(limits.check(), ControlFlow::Break(Stop::TimeLimit(passed)));
        // Ctrl-C takes precedence.
        limits.interrupted.store(true, Ordering::Relaxed);
        assert_eq!(limits.check(), ControlFlow::Break(Stop::Interrupted));
    }
}
