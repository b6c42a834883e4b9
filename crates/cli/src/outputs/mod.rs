//! Outputs: files, standard output, diagnostics, and the parts of an answer that several commands print.

pub mod csv;
pub mod diagnostics;
pub mod doubts;
pub mod files;
pub mod paths;
pub mod signals;
pub mod stdout;
