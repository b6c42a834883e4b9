//! The warning that a result is in doubt, for commands that use results.
//!
//! In: a discovery. Out: at most one warning on standard error.

use sidc_emit as emit;
use sidc_system::discovery::{Discovery, Notice};

/// The warning; `None` for a result that passes.
pub fn doubted(d: &Discovery) -> Option<Notice> {
    emit::doubted(d).map(|text| Notice::new("doubted-result", text))
}

/// Writes the warning to standard error.
pub fn warn(d: &Discovery) {
    if let Some(w) = doubted(d) {
        eprintln!("warning[{}]: {}", w.code, w.text);
    }
}
