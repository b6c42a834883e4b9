//! A server of the language server protocol for `.sid` files.
//!
//! In: messages of an editor. Out: the answers, and what the compiler finds in each text while it is typed. `text` keeps the texts,
//! `analysis` understands one, `features` answers one kind of question each, `server` knows the protocol. Opens no file: what lies beside
//! a model comes through [`Folder`]. Waits for nothing and knows no clock.

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
