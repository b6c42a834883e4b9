//! Exit statuses, as documented in docs/command-line.md. Status 2, wrong usage, comes from clap.

pub const PASS: u8 = 0;
/// The model, the data or a file is at fault.
pub const INPUT: u8 = 1;
/// A doubt, a failure, an interrupt or a limit: equations are still printed.
pub const DOUBT: u8 = 3;
/// A second Ctrl-C: nothing is printed. 128 + SIGINT, as in shells.
pub const KILLED: u8 = 130;
