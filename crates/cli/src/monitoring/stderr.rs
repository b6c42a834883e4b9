//! Standard error while the progress line may be on it.
//!
//! In: texts. Out: the same, with the line taken back before them. Errors of writing are ignored: progress that cannot be shown
//! is no reason to stop.

use std::io::{IsTerminal, Write};

/// To the start of the line, then delete to its end.
pub const CLEAR_LINE: &str = "\r\x1b[K";

/// Prints a text in place of the progress line, for callers who do not hold it.
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
