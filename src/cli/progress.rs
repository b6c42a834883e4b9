//! A line on stderr while a solver works, only on a terminal and only after a second.

use std::io::{IsTerminal, Write};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use crate::solve::Progress;

/// Work shorter than this needs no line.
const PATIENCE: Duration = Duration::from_secs(1);

pub struct Line {
    start: Instant,
    terminal: bool,
    shown: bool,
}

impl Line {
    pub fn new() -> Self {
        Line {
            start: Instant::now(),
            terminal: std::io::stderr().is_terminal(),
            shown: false,
        }
    }

    pub fn show(&mut self, p: Progress) -> ControlFlow<()> {
        if self.terminal && self.start.elapsed() > PATIENCE {
            eprint!(
                "\r\x1b[Ksolving: iteration {}, gap {:.1e}, {:.0} s",
                p.iteration,
                p.gap,
                self.start.elapsed().as_secs_f64()
            );
            // A progress line that cannot be shown is no reason to stop.
            let _ = std::io::stderr().flush();
            self.shown = true;
        }
        ControlFlow::Continue(())
    }
}

impl Drop for Line {
    fn drop(&mut self) {
        if self.shown {
            eprint!("\r\x1b[K");
        }
    }
}
