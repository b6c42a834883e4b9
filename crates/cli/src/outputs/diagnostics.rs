//! Diagnostics on standard error.
//!
//! In: diagnostics, the sources that they refer to. Out: their text, in colour on a terminal.

use std::io::IsTerminal;

use crate::failure::Failure;
use crate::monitoring::verbosity::Notes;
use sidc_lang as lang;
use sidc_lang::diagnostic::{Diagnostic, Severity};
use sidc_lang::source::Sources;

/// Diagnostics as text, in colour on a terminal.
pub fn render(diagnostics: &[Diagnostic], sources: &Sources) -> String {
    let colour = std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
    lang::render(diagnostics, sources, colour)
}

/// Diagnostics as a failure.
pub fn failure(diagnostics: &[Diagnostic], sources: &Sources) -> Failure {
    Failure::new(render(diagnostics, sources))
}

/// Prints the diagnostics of a stage.
///
/// # Errors
/// The diagnostics, if the stage has no result.
pub fn report<T>(
    staged: (Option<T>, Vec<Diagnostic>),
    sources: &Sources,
    notes: Notes,
) -> Result<T, Failure> {
    let (result, mut diagnostics) = staged;
    let is_note = |d: &Diagnostic| d.severity == Severity::Note;
    if notes != Notes::Full {
        if notes == Notes::Lines {
            for d in diagnostics.iter().filter(|d| is_note(d)) {
                let line = Diagnostic::note(d.code, &d.message);
                eprintln!("{}", render(&[line], sources).trim_end());
            }
        }
        diagnostics.retain(|d| !is_note(d));
    }
    // Errors come last, next to the prompt, because they must be fixed.
    diagnostics.sort_by_key(|d| std::cmp::Reverse(d.severity));
    let text = render(&diagnostics, sources);
    match result {
        Some(result) => {
            eprint!("{text}");
            Ok(result)
        }
        None => Err(Failure::new(text)),
    }
}
