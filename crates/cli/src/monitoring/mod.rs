//! How long work is watched: the progress line, the times of its stages, limits, Ctrl-C.

pub mod interrupts;
pub mod limits;
pub mod monitor;
pub mod progress_line;
pub mod stage_times;
pub mod stderr;
pub mod verbosity;
