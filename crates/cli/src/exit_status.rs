//! Exit statuses, as docs/command-line.md promises them; 2, wrong usage, is clap's own.

pub const PASS: u8 = 0;
/// The model, the data or a file is at fault.
pub const INPUT: u8 = 1;
/// A doubt, a failure, an interrupt or a limit: equations are still printed.
pub const DOUBT: u8 = 3;
/// Ctrl-C a second time: nothing is printed. 128 + SIGINT, as shells report it.
pub const KILLED: u8 = 130;
