//! The server seen from an editor, over an in-memory connection. In tests/it/editor Neovim drives the program.

mod completion;
mod corpus;
mod edits;
mod fixes;
mod functions;
mod includes;
mod session;
mod transcripts;
