//! One file for each kind of request. In: a document. Out: the answer in the types of the protocol.

pub mod code_actions;
pub mod completion;
mod completion_context;
pub mod diagnostics;
pub mod folding;
pub mod formatting;
pub mod hover;
pub mod inlay_hints;
pub mod navigation;
pub mod outline;
pub mod rename;
pub mod semantic_tokens;
