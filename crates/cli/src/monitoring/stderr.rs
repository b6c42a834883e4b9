//! Standard error while the progress line may be shown.
//!
//! In: texts. Out: the same texts, after erasing the line. Write errors are ignored: failing to show progress is no reason to stop.

use std::io::{IsTerminal, Write};

/// Moves to the start of the line and deletes to its end.
pub const CLEAR_LINE: &str = "\r\x1b[K";

/// Prints a text in place of the progress line, for callers without access to it.
pub fn replace_line(text: &str) {
    let clear = if std::io::stderr().is_terminal() {
        CLEAR_LINE
    } else {
        ""
    };
    print(&format!("{clear}{text}"));
}

pub fn print(text: &str) {
    let mut out = std::io::stderr().lock();
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
}
