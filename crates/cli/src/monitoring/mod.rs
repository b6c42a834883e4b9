//! Monitoring of long work: the progress line, times of stages, limits, Ctrl-C.

pub mod interrupts;
pub mod limits;
pub mod monitor;
pub mod progress_line;
pub mod stage_times;
pub mod stderr;
pub mod verbosity;
