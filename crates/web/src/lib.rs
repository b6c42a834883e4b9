//! Crate `sidc` and its language server for the workers of a page; [`web/`](../../web/README.md) is built on it.
//!
//! In: texts, bytes of data files. Out: documents, pages, messages of the language server. One thread and no clock; a run is ended by ending its worker.

mod data;
mod editor;
mod identification;
mod progress;

pub use data::Data;
pub use editor::Editor;
pub use identification::{Discovery, Model, targets};
