//! Crate `sidc` and its language server for the workers of a page: [`web/`](../../web/README.md) is built around it.
//!
//! In: texts, bytes of data files. Out: documents, pages, messages of the language server. One thread, no clock; whoever
//! wants a run to end ends its worker.

mod data;
mod editor;
mod identification;
mod progress;

pub use data::Data;
pub use editor::Editor;
pub use identification::{Discovery, Model, targets};
