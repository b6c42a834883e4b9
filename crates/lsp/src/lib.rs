//! A language server for `.sid` files.
//!
//! In: messages of an editor. Out: answers, and the compiler's diagnostics of each text as it is typed. `text` stores the texts, `analysis` interprets one,
//! `features` answers one kind of request per file, `server` implements the protocol. Opens no file: the folder of a model is accessed through [`Folder`].
//! Never waits and uses no clock.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod analysis;
mod features;
mod server;
#[cfg(test)]
mod tests;
mod text;
mod thresholds;
mod vocabulary;

pub use analysis::folder::{Folder, TableHeader};
pub use lsp_server::{Connection, Message, ProtocolError, Response};
pub use server::{Server, serve};
pub use text::positions::Encoding;
