//! The server as an editor meets it, through a connection in memory; Neovim drives the program in tests/it/editor.rs.

mod completion;
mod corpus;
mod edits;
mod fixes;
mod functions;
mod includes;
mod session;
mod transcripts;
