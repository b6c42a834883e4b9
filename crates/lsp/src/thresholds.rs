//! Limits of what an editor is shown.
//!
//! Out: one family, and its table for the documentation.

// The server reads the numbers; only the test of the documentation reads their tables.
#![allow(dead_code)]

use sidc_thresholds::{Table, family};

family! {
    /// How much an editor may send, and how much of a long list it is shown.
    pub(crate) EDITOR: EditorLimits {
        /// Largest text that is analysed, as of a model that `sidc` reads.
        text: usize = 1 << 20, unit "bytes", source "set by hand: far beyond any model written by hand";
        /// Names of a range `x1..xN` that are completed and found.
        range: usize = 1_000, unit "names", source "set by hand";
        /// Terms of a library that are listed.
        terms: usize = 12, unit "terms", source "set by hand: more fill the screen";
        /// Terms of a library that are offered where one is named.
        offered: usize = 500, unit "terms", source "set by hand: a list that an editor filters as one types";
        /// Times that a text with errors is compiled without the statements that have them, for the sizes of its libraries.
        attempts: usize = 3, unit "times", source "set by hand: a declaration, the lets that use it, the equations that use those";
        /// Messages that wait to be answered before the editor has to wait.
        waiting: usize = 1_000, unit "messages", source "set by hand: more than an editor sends while one text is understood";
        /// Findings that are sent for one text, the gravest first.
        findings: usize = 200, unit "findings", source "set by hand";
    }
}

/// Every family of this crate, for the documentation.
pub fn tables() -> Vec<Table> {
    vec![EditorLimits::table()]
}
