//! Standard output.

use std::io::Write;

use crate::failure::Failure;
use sidc_lang::source::printable;

/// Prints a text for people, with control characters escaped: names in files may hold some.
pub fn print_readable(text: &str) -> Result<(), Failure> {
    print(printable(text))
}

/// Prints in one piece; a closed pipe is no failure.
pub fn print(content: impl AsRef<[u8]>) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(content.as_ref()).and_then(|()| out.flush()) {
        Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        other => other.map_err(|e| Failure::new(format!("error[unwritable-file]: stdout: {e}"))),
    }
}
