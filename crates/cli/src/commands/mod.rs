//! The commands, one file or folder each: arguments, help, work and output. No command imports another.

pub mod check;
pub mod completions;
pub mod export;
pub mod fmt;
pub mod identify;
pub mod linearize;
pub mod list;
pub mod lsp;
pub mod man;
pub mod new;
pub mod report;
pub mod simulate;
pub mod smooth;
