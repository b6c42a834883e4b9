//! Standard output.

use std::io::Write;

use crate::failure::Failure;
use sidc_lang::source::printable;

/// Prints readable text with control characters escaped, since names in files may contain some.
pub fn print_readable(text: &str) -> Result<(), Failure> {
    print(printable(text))
}

/// Prints all at once; a closed pipe is not a failure.
pub fn print(content: impl AsRef<[u8]>) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(content.as_ref()).and_then(|()| out.flush()) {
        Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        other => other.map_err(|e| Failure::new(format!("error[unwritable-file]: stdout: {e}"))),
    }
}
