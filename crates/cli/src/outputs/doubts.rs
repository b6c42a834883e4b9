//! The warning that a result is doubted, for commands that put it to use.
//!
//! In: a discovery. Out: one warning on standard error, or none.

use sidc_emit as emit;
use sidc_system::discovery::{Discovery, Notice};

/// The warning; `None` for a result that passes.
pub fn doubted(d: &Discovery) -> Option<Notice> {
    emit::doubted(d).map(|text| Notice::new("doubted-result", text))
}

/// Writes it to standard error.
pub fn warn(d: &Discovery) {
    if let Some(w) = doubted(d) {
        eprintln!("warning[{}]: {}", w.code, w.text);
    }
}
